import type { Api } from "../src/api/types";
import { cssOf, filmOf, type FilmPoint } from "../src/measure/viewport";
import { expect } from "./app";
import { CORNERS, FilmPage, LEVELS, cornerOf } from "./marking";

type ReadingView = Api<"ReadingView">;

/** Tolerance between a landmark and its click: places are rounded to 0.001 px. */
const CLOSE_PX = 0.01;
/** CSS pixels per film pixel at which corners are distinct. */
const SCALE = 0.6;

/** The click at which the program is killed, and the one at which it is started again. */
export const KILLED = { click: 26, back: 38 };

/** The reading of the film by another observer, with the true corners. */
export async function truthOf(film: FilmPage): Promise<ReadingView> {
  const { summary } = await film.detail();
  const number = Number(/measure\/(\d+)/.exec(film.page.url())?.[1]);
  const shown = summary.films.find((one) => one.film === number) ?? summary.films[0];
  const readings = shown?.readings ?? [];
  const other = readings.find((one) => !one.mine && one.complete_levels >= LEVELS.length);
  if (!other) throw new Error(`no other observer has marked all of L4 to T2 of ${summary.id}`);
  return film.get(`/api/readings/${other.reading}`);
}

/** Moves the film like a reader if the next corner is not in view. */
async function bringIntoView(film: FilmPage, place: FilmPoint): Promise<void> {
  const [x, y] = await film.where(place);
  const box = (await film.viewer.boundingBox())!;
  const isIn = (at: number, from: number, length: number): boolean =>
    at > from + 30 && at < from + length - 30;
  if (isIn(x, box.x, box.width) && isIn(y, box.y, box.height)) return;
  await film.lookAt(place, SCALE);
}

/**
 * Marks a film corner by corner, with a reader's time for aiming before each click; returns the place of each click on
 * the film.
 */
export async function markFilm(
  film: FilmPage,
  truth: ReadingView,
  aimMs: number,
  before: (click: number) => Promise<void>,
): Promise<Map<string, FilmPoint>> {
  const clicks = new Map<string, FilmPoint>();
  await film.lookAt(cornerOf(truth, "L4", "superior_left"), SCALE);
  // A bend begins with two clicks per vertebra.
  const twoClicks = film.page.getByRole("button", { name: /two clicks/i });
  if ((await twoClicks.getAttribute("aria-pressed")) === "true") await twoClicks.click();
  const { order } = await film.reading();
  for (const level of order.filter((name) => LEVELS.some((one) => one === name))) {
    await expect(film.target).toContainText(level);
    for (const corner of CORNERS) {
      await before(clicks.size);
      const place = cornerOf(truth, level, corner);
      await bringIntoView(film, place);
      await film.page.waitForTimeout(aimMs);
      // After the last corner of a vertebra the view moves on: the click was made on the earlier view.
      const [view, box] = [await film.view(), (await film.viewer.boundingBox())!];
      const [x, y] = cssOf(view, place);
      await film.page.mouse.click(box.x + x, box.y + y);
      clicks.set(`${level} ${corner}`, filmOf(view, [x, y]));
    }
  }
  return clicks;
}

/** The result of the clicks on a film. */
export interface Kept {
  /** Corners that are missing. */
  lost: string[];
  /** Corners that are away from their clicks. */
  misplaced: string[];
  /** The largest distance between a click and its corner. */
  largestPx: number;
}

/** Compares a reading, as the program has it, with the clicks. */
export function kept(reading: ReadingView, clicks: Map<string, FilmPoint>): Kept {
  const found: Kept = { lost: [], misplaced: [], largestPx: 0 };
  for (const [name, [column, row]] of clicks) {
    const [level, corner] = name.split(" ");
    const vertebra = reading.vertebrae.find((one) => one.level === level);
    const px = vertebra?.corners.find((one) => one.corner === corner)?.px;
    if (!px) {
      found.lost.push(name);
      continue;
    }
    const apartPx = Math.hypot(px[0]! - column, px[1]! - row);
    found.largestPx = Math.max(found.largestPx, apartPx);
    if (apartPx >= CLOSE_PX) found.misplaced.push(`${name}: ${apartPx.toFixed(3)} px`);
  }
  return found;
}
