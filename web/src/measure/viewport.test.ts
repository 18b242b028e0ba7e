import { describe, expect, it } from "vitest";

import { UPRIGHT, clockwise, flipped, turnText, type Turn } from "./turn";
import {
  alongFilm,
  boxOf,
  cssOf,
  filmOf,
  fit,
  pan,
  reveal,
  turned,
  zoom,
  type FilmPoint,
} from "./viewport";

const SIZE = { width: 701.5, height: 613.25 };
const ROUNDING_PX = 1e-9;

function close(a: readonly number[], b: readonly number[], limit = ROUNDING_PX): void {
  expect(Math.hypot(a[0]! - b[0]!, a[1]! - b[1]!)).toBeLessThan(limit);
}

describe.each([0.5, 1, 2])("pixels %s times as high as wide", (aspect) => {
  const film = { columns: 3000, rows: 4000, aspect };
  const places: FilmPoint[] = [
    [0, 0],
    [1203.437, 877.019],
    [-0.5, 3999.5],
  ];

  it("converts places to the screen and back", () => {
    let view = fit(film, SIZE);
    for (const factor of [1, 3.7, 2.9, 0.2]) {
      view = zoom(view, factor, [311.2, 205.9], film, SIZE);
      for (const place of places) close(filmOf(view, cssOf(view, place)), place);
    }
  });

  it("fits the whole film into the view", () => {
    const view = fit(film, SIZE);
    const [left, top] = cssOf(view, [-0.5, -0.5]);
    const [right, bottom] = cssOf(view, [film.columns - 0.5, film.rows - 0.5]);
    close([left + right, top + bottom], [SIZE.width, SIZE.height]);
    expect(Math.min(left, top)).toBeGreaterThanOrEqual(12 - ROUNDING_PX);
    expect((bottom - top) / (right - left)).toBeCloseTo((film.rows * aspect) / film.columns, 12);
  });

  it("keeps the place under the pointer while it zooms", () => {
    const at = [402.75, 133.5] as const;
    const view = fit(film, SIZE);
    const before = filmOf(view, at);
    close(filmOf(zoom(view, 6.5, at, film, SIZE), at), before);
  });
});

const film = { columns: 3000, rows: 4000, aspect: 1 };

it("has the centre of the first pixel at zero", () => {
  const view = { scale: 4, aspect: 2, left: 100, top: 50, turn: UPRIGHT };
  expect(cssOf(view, [0, 0])).toEqual([102, 54]);
  expect(filmOf(view, [102, 54])).toEqual([0, 0]);
});

it("keeps part of the film in view", () => {
  const view = pan(fit(film, SIZE), [1e6, -1e6], film, SIZE);
  expect(cssOf(view, [-0.5, 0])[0]).toBeLessThan(SIZE.width);
  expect(cssOf(view, [0, film.rows])[1]).toBeGreaterThan(0);
});

it("zooms within limits", () => {
  const view = fit(film, SIZE);
  expect(zoom(view, 1e9, [0, 0], film, SIZE).scale).toBe(48);
  expect(zoom(view, 1e-9, [0, 0], film, SIZE).scale).toBeCloseTo(view.scale / 2, 12);
});

it("moves a hidden place just into view", () => {
  const view = zoom(fit(film, SIZE), 20, [0, 0], film, SIZE);
  const shown = filmOf(view, [300, 300]);
  expect(reveal(view, shown, 80, film, SIZE)).toBe(view);
  const hidden = filmOf(view, [300, SIZE.height + 500]);
  const [x, y] = cssOf(reveal(view, hidden, 80, film, SIZE), hidden);
  close([x, y], [300, SIZE.height - 80]);
});

const MIRRORED: Turn = { mirrored: true, quarters: 0 };

/** All eight ways to show a film. */
const TURNS: Turn[] = [UPRIGHT, MIRRORED].flatMap((first) => {
  const turns = [first];
  while (turns.length < 4) turns.push(clockwise(turns.at(-1)!));
  return turns;
});

describe.each(TURNS)("shown %o", (turn) => {
  const film = { columns: 300, rows: 400, aspect: 2 };
  const view = zoom(fit(film, SIZE, turn), 3.1, [311.2, 205.9], film, SIZE);

  it("converts places and steps to the screen and back", () => {
    const place: FilmPoint = [120.437, 277.019];
    const at = cssOf(view, place);
    close(filmOf(view, at), place);
    const [across, down] = alongFilm(turn, [30, -12]);
    const moved = filmOf(view, [at[0] + 30, at[1] - 12]);
    close(
      [moved[0] - place[0], moved[1] - place[1]],
      [across / view.scale, down / (view.scale * film.aspect)],
    );
  });

  it("fits the whole film into the view", () => {
    const { left, top, width, height } = boxOf(fit(film, SIZE, turn), film);
    close([2 * left + width, 2 * top + height], [SIZE.width, SIZE.height]);
    expect(Math.min(left, top)).toBeCloseTo(12, 9);
  });

  it("keeps the middle of the view while it is turned on", () => {
    const middle = [SIZE.width / 2, SIZE.height / 2] as const;
    const before = filmOf(view, middle);
    for (const next of [clockwise(turn), flipped(turn)])
      close(filmOf(turned(view, next, film, SIZE), middle), before);
  });

  it("is turned on the screen, whatever it was before", () => {
    const direction = (one: Turn, by: FilmPoint): readonly number[] => {
      const at = { scale: 1, aspect: 1, left: 0, top: 0, turn: one };
      const [x, y] = cssOf(at, [0, 0]);
      const to = cssOf(at, by);
      return [to[0] - x, to[1] - y];
    };
    for (const by of [
      [1, 0],
      [0, 1],
    ] as const) {
      const [x, y] = direction(turn, by);
      close(direction(clockwise(turn), by), [-y!, x!]);
      close(direction(flipped(turn), by), [-x!, y!]);
    }
  });
});

it("describes a turned film, and is empty for others", () => {
  expect(turnText(UPRIGHT)).toBeNull();
  expect(turnText(flipped(clockwise(UPRIGHT)))).toMatch(/^Shown mirrored, then turned 90° anti/);
  expect(turnText(clockwise(clockwise(flipped(flipped(UPRIGHT)))))).toMatch(/^Shown turned 180°\./);
});
