import { expect, test } from "../app";
import { FilmPage, LEVELS, wallOf } from "../marking";

test.use({ hasDemo: true });

/** Time that a person takes to aim at a landmark and to click: 40 clicks a minute. */
const AIM_MS = 1_500;
/** Time of a look at the outline of a vertebra. */
const LOOK_MS = 300;

test("a film of 15 vertebrae by two clicks each, at a person's pace", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  const mark = await marker(film);
  const start = Date.now();
  await page.keyboard.press("t");
  const actions = 1 + (await mark(LEVELS));
  await tell(film, actions, start);
});

test("the same film from proposals, accepted together after a look", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  const mark = await marker(film);
  const start = Date.now();
  await page.keyboard.press("p");
  await expect(film.target).toContainText("were found clearly");
  await page.waitForTimeout(AIM_MS + LOOK_MS * (await page.locator("[data-proposal]").count()));
  await page.keyboard.press("Enter");
  await film.saved();
  const placed = (await film.reading()).vertebrae.map(({ level }) => level);
  const actions = 2 + (await mark(LEVELS.filter((level) => !placed.includes(level))));
  await tell(film, actions, start);
});

/** Marks vertebrae by two clicks each and accepts them; returns the number of actions. */
async function marker(film: FilmPage): Promise<(levels: readonly string[]) => Promise<number>> {
  const truth = await film.truth();
  return async (levels) => {
    if (levels.length === 0) return 0;
    for (const level of levels) {
      for (const side of ["left", "right"] as const) {
        await film.page.waitForTimeout(AIM_MS);
        await film.click(wallOf(truth, level, side));
      }
    }
    await film.page.waitForTimeout(AIM_MS);
    await film.page.keyboard.press("Enter");
    return 2 * levels.length + 1;
  };
}

/** Prints the time of a film. */
async function tell(film: FilmPage, actions: number, start: number): Promise<void> {
  await film.saved();
  const seconds = (Date.now() - start) / 1_000;
  const complete = (await film.reading()).vertebrae.filter((vertebra) => vertebra.complete).length;
  console.log(`${complete} vertebrae in ${actions} actions and ${seconds.toFixed(1)} s`);
}
