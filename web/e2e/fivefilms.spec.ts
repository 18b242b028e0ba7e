import type { Api } from "../src/api/types";
import { cssOf, filmOf, type FilmPoint } from "../src/measure/viewport";
import { expect, test, type App } from "./app";
import { CORNERS, FilmPage, LEVELS, cornerOf } from "./marking";

test.use({ hasDemo: true });

type ReadingView = Api<"ReadingView">;

/** Time before a click: a practised reader takes a second, with which the test lasts six minutes. */
const AIM_MS = Number(process.env.SPINELINE_AIM_MS ?? 200);
/** Tolerance between a landmark and its click: places are rounded to 0.001 px. */
const CLOSE_PX = 0.01;
/** CSS pixels per film pixel at which corners are told apart. */
const SCALE = 0.6;
const FILMS = [/^erect/i, /left bending/i, /right bending/i, /neutral/i, /traction/i];
/** The film and the click at which the program is killed, and the click at which it is started again. */
const KILLED = { film: 2, click: 26, back: 38 };

/** The reading of a film by one of the demo's virtual readers. */
async function truthOf(film: FilmPage): Promise<ReadingView> {
  const number = Number(/measure\/(\d+)/.exec(film.page.url())?.[1]);
  const { summary } = await film.detail();
  const readings = summary.films.find((one) => one.film === number)?.readings ?? [];
  const other = readings.find((one) => !one.mine && one.complete_levels === LEVELS.length)!;
  return film.get(`/api/readings/${other.reading}`);
}

/** Moves the film as a reader does, where the next corner is not in view. */
async function bringIntoView(film: FilmPage, place: FilmPoint): Promise<void> {
  const [x, y] = await film.where(place);
  const box = (await film.viewer.boundingBox())!;
  const isIn = (at: number, from: number, length: number): boolean =>
    at > from + 30 && at < from + length - 30;
  if (isIn(x, box.x, box.width) && isIn(y, box.y, box.height)) return;
  await film.lookAt(place, SCALE);
}

/** Marks a film corner by corner; gives where each click was on the film. */
async function markFilm(
  film: FilmPage,
  truth: ReadingView,
  before: (click: number) => Promise<void>,
): Promise<Map<string, FilmPoint>> {
  const clicks = new Map<string, FilmPoint>();
  await film.lookAt(cornerOf(truth, "L4", "superior_left"), SCALE);
  for (const level of LEVELS) {
    await expect(film.target).toContainText(level);
    for (const corner of CORNERS) {
      await before(clicks.size);
      const place = cornerOf(truth, level, corner);
      await bringIntoView(film, place);
      await film.page.waitForTimeout(AIM_MS);
      // After the last corner of a vertebra the view moves on: the click is where the film was before it.
      const [view, box] = [await film.view(), (await film.viewer.boundingBox())!];
      const [x, y] = cssOf(view, place);
      await film.page.mouse.click(box.x + x, box.y + y);
      clicks.set(`${level} ${corner}`, filmOf(view, [x, y]));
    }
  }
  return clicks;
}

/** Corners that are missing or are not where they were clicked. */
function misplaced(reading: ReadingView, clicks: Map<string, FilmPoint>): string[] {
  return [...clicks].flatMap(([name, [column, row]]) => {
    const [level, corner] = name.split(" ") as [string, Api<"Corner">];
    const placed = cornerOf(reading, level, corner);
    const apart = Math.hypot(placed[0] - column, placed[1] - row);
    return apart < CLOSE_PX ? [] : [`${name}: ${apart.toFixed(3)} px`];
  });
}

/** Kills the program at one click and starts it again at another one, without a wait for anything on the page. */
async function killAndStart(app: App, click: number): Promise<void> {
  if (click === KILLED.click) await app.kill();
  if (click === KILLED.back) await app.start();
}

test(
  "five films are marked click by click while the program is killed and started again",
  { tag: "@long" },
  async ({ app, page }) => {
    test.setTimeout(1_200_000);
    await app.openDemo(page);
    const film = new FilmPage(page);
    const wrong: string[] = [];
    for (const [index, name] of FILMS.entries()) {
      const link = page.getByRole("navigation", { name: "Films" }).getByRole("link", { name });
      await link.click();
      await expect(link).toHaveAttribute("aria-current", "page");
      await film.begin();
      const truth = await truthOf(film);
      const clicks = await markFilm(film, truth, async (click) => {
        if (index === KILLED.film) await killAndStart(app, click);
      });
      await film.saved();
      const reading = await film.reading();
      expect(reading.vertebrae.filter(({ complete }) => complete)).toHaveLength(LEVELS.length);
      expect(reading.conflicts).toEqual([]);
      wrong.push(...misplaced(reading, clicks).map((what) => `${String(name)} ${what}`));
    }
    expect(wrong).toEqual([]);
  },
);
