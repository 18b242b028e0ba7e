import { test } from "../app";
import { FilmPage, LEVELS, wallOf } from "../marking";

test.use({ hasDemo: true });

/** Time that a person takes to aim at a landmark and to click: 40 clicks a minute. */
const AIM_MS = 1_500;

test("a film of 15 vertebrae by two clicks each, at a person's pace", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  await page.keyboard.press("t");
  let actions = 1;
  const start = Date.now();
  for (const level of LEVELS) {
    for (const side of ["left", "right"] as const) {
      await page.waitForTimeout(AIM_MS);
      await film.click(wallOf(truth, level, side));
      actions += 1;
    }
  }
  await page.waitForTimeout(AIM_MS);
  await page.keyboard.press("Enter");
  actions += 1;
  await film.saved();
  const seconds = (Date.now() - start) / 1_000;
  const complete = (await film.reading()).vertebrae.filter((vertebra) => vertebra.complete).length;
  console.log(`${complete} vertebrae in ${actions} actions and ${seconds.toFixed(1)} s`);
});
