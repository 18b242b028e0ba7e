import { UPRIGHT, axesOf, isOnItsSide, type Turn } from "./turn";

/** A place on a film in its pixels: column and row, sub-pixel, the centre of the first pixel at zero. */
export type FilmPoint = readonly [column: number, row: number];
/** A place in the viewer in CSS pixels. */
export type CssPoint = readonly [x: number, y: number];

export interface Size {
  readonly width: number;
  readonly height: number;
}

/**
 * The visible part of a film: `css = (film + 0.5) × scale` along the directions of its columns and rows on the screen, from
 * its first corner, with rows stretched by the pixel's aspect.
 */
export interface Viewport {
  /** CSS pixels per film column. */
  readonly scale: number;
  /** Height of a film pixel over its width. */
  readonly aspect: number;
  /** Place of the film's first corner: its left edge, where it is not turned. */
  readonly left: number;
  /** The same from above. */
  readonly top: number;
  readonly turn: Turn;
}

export interface FilmSize {
  readonly columns: number;
  readonly rows: number;
  readonly aspect: number;
}

/** A box on the screen. */
export interface Box extends Size {
  readonly left: number;
  readonly top: number;
}

/** Margin around a fitted film. */
const MARGIN_CSS = 12;
/** Maximum width of a film pixel. */
const MAX_SCALE = 48;
/** Minimum part of the film in view. */
const KEPT_CSS = 48;

export function cssOf(view: Viewport, [column, row]: FilmPoint): CssPoint {
  const { columns, rows } = axesOf(view.turn);
  const [across, down] = [(column + 0.5) * view.scale, (row + 0.5) * view.scale * view.aspect];
  return [
    columns[0] * across + rows[0] * down + view.left,
    columns[1] * across + rows[1] * down + view.top,
  ];
}

export function filmOf(view: Viewport, [x, y]: CssPoint): FilmPoint {
  const [across, down] = alongFilm(view.turn, [x - view.left, y - view.top]);
  return [across / view.scale - 0.5, down / (view.scale * view.aspect) - 0.5];
}

/** A step on the screen as a step along the film's columns and rows, of the same length. */
export function alongFilm(turn: Turn, [x, y]: CssPoint): CssPoint {
  const { columns, rows } = axesOf(turn);
  return [columns[0] * x + columns[1] * y, rows[0] * x + rows[1] * y];
}

/** The whole film, in the middle. */
export function fit(film: FilmSize, size: Size, turn: Turn = UPRIGHT): Viewport {
  const width = Math.max(1, size.width - 2 * MARGIN_CSS);
  const height = Math.max(1, size.height - 2 * MARGIN_CSS);
  const [wide, high] = isOnItsSide(turn)
    ? [film.rows * film.aspect, film.columns]
    : [film.columns, film.rows * film.aspect];
  const scale = Math.min(width / wide, height / high);
  const view = { scale, aspect: film.aspect, left: 0, top: 0, turn };
  return placed(view, middleOf(film), [size.width / 2, size.height / 2]);
}

/** Enlarges by a factor; the film's place under `at` stays where it is. */
export function zoom(
  view: Viewport,
  factor: number,
  at: CssPoint,
  film: FilmSize,
  size: Size,
): Viewport {
  const smallest = fit(film, size, view.turn).scale / 2;
  const scale = Math.min(MAX_SCALE, Math.max(smallest, view.scale * factor));
  const ratio = scale / view.scale;
  const moved = {
    ...view,
    scale,
    left: at[0] - (at[0] - view.left) * ratio,
    top: at[1] - (at[1] - view.top) * ratio,
  };
  return kept(moved, film, size);
}

export function pan(view: Viewport, by: CssPoint, film: FilmSize, size: Size): Viewport {
  return kept({ ...view, left: view.left + by[0], top: view.top + by[1] }, film, size);
}

/** Turns or mirrors about the middle of the view. */
export function turned(view: Viewport, turn: Turn, film: FilmSize, size: Size): Viewport {
  const middle = [size.width / 2, size.height / 2] as const;
  return kept(placed({ ...view, turn }, filmOf(view, middle), middle), film, size);
}

/** Moves a place of the film to a place on the screen. */
export function placed(view: Viewport, point: FilmPoint, [x, y]: CssPoint): Viewport {
  const [nowX, nowY] = cssOf(view, point);
  return { ...view, left: view.left + x - nowX, top: view.top + y - nowY };
}

/** Moves the view by the smallest amount that shows a place at least `margin` inside. */
export function reveal(
  view: Viewport,
  point: FilmPoint,
  margin: number,
  film: FilmSize,
  size: Size,
): Viewport {
  const [x, y] = cssOf(view, point);
  const by = [short(x, margin, size.width), short(y, margin, size.height)] as const;
  return by[0] === 0 && by[1] === 0 ? view : pan(view, by, film, size);
}

function short(at: number, margin: number, length: number): number {
  const room = Math.min(margin, length / 2);
  return Math.max(0, room - at) + Math.min(0, length - room - at);
}

/** The film on the screen. */
export function boxOf(view: Viewport, film: FilmSize): Box {
  const [ax, ay] = cssOf(view, [-0.5, -0.5]);
  const [bx, by] = cssOf(view, [film.columns - 0.5, film.rows - 0.5]);
  return {
    left: Math.min(ax, bx),
    top: Math.min(ay, by),
    width: Math.abs(bx - ax),
    height: Math.abs(by - ay),
  };
}

/** Keeps part of the film in view. */
function kept(view: Viewport, film: FilmSize, size: Size): Viewport {
  const { left, top, width, height } = boxOf(view, film);
  const within = (at: number, length: number, room: number): number =>
    Math.min(room - KEPT_CSS, Math.max(KEPT_CSS - length, at)) - at;
  return {
    ...view,
    left: view.left + within(left, width, size.width),
    top: view.top + within(top, height, size.height),
  };
}

const middleOf = ({ columns, rows }: FilmSize): FilmPoint => [columns / 2 - 0.5, rows / 2 - 0.5];

/** The thing nearest to a place on the screen, if it is within reach. */
export function nearest<Thing>(
  things: readonly Thing[],
  placed: (thing: Thing) => CssPoint | null,
  at: CssPoint,
  reach: number,
): Thing | null {
  let best: Thing | null = null;
  let closest = reach;
  for (const thing of things) {
    const place = placed(thing);
    if (!place) continue;
    const distance = Math.hypot(place[0] - at[0], place[1] - at[1]);
    if (distance <= closest) [best, closest] = [thing, distance];
  }
  return best;
}

/** The interface sends points as lists of two numbers. */
export function filmPoint(px: readonly number[]): FilmPoint {
  return [px[0] ?? Number.NaN, px[1] ?? Number.NaN];
}
