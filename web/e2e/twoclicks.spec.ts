import type { Api } from "../src/api/types";
import type { FilmPoint } from "../src/measure/viewport";
import { expect, shot, test } from "./app";
import { FilmPage, LEVELS, cornerOf, farthest } from "./marking";

type ReadingView = Api<"ReadingView">;

/** The middle of a wall of another reading. */
function wallOf(truth: ReadingView, level: string, side: "left" | "right"): FilmPoint {
  const above = cornerOf(truth, level, `superior_${side}`);
  const below = cornerOf(truth, level, `inferior_${side}`);
  return [(above[0] + below[0]) / 2, (above[1] + below[1]) / 2];
}

/** Mean height of the vertebrae. */
function height(truth: ReadingView): number {
  const heights = LEVELS.map((level) => {
    const [above, below] = [
      cornerOf(truth, level, "superior_left"),
      cornerOf(truth, level, "inferior_left"),
    ];
    return Math.hypot(above[0] - below[0], above[1] - below[1]);
  });
  return heights.reduce((sum, one) => sum + one, 0) / heights.length;
}

test("a film is marked by two clicks per vertebra, accepted at once and undone at once", async ({
  app,
  page,
}) => {
  await app.open(page);
  const film = await FilmPage.ofDemo(page);
  const truth = await film.truth();
  await page.getByRole("button", { name: /two clicks/i }).click();
  await expect(film.target).toContainText("middle of the wall, patient’s left");
  let clicks = 0;
  for (const level of LEVELS) {
    for (const side of ["left", "right"] as const) {
      await expect(film.target).toContainText(level);
      await expect(film.target).toContainText(`patient’s ${side}`);
      await film.click(wallOf(truth, level, side));
      clicks += 1;
    }
  }
  await film.saved();
  await expect(page.locator("[data-proposal]")).toHaveCount(LEVELS.length);
  await shot(page, "measure-two-clicks");
  await page.keyboard.press("Enter");
  await film.saved();
  await expect(page.locator("[data-proposal]")).toHaveCount(0);
  const accepted = await film.reading();
  expect(accepted.vertebrae.map(({ origin }) => origin)).toEqual(LEVELS.map(() => "accepted"));
  // The worst corner of all lies within half a vertebral height of another reader's.
  expect(farthest(accepted, truth)).toBeLessThan(0.5 * height(truth));
  expect(clicks + 2).toBeLessThanOrEqual(34);
  await shot(page, "measure-two-clicks-accepted");

  await page.keyboard.press("Control+z");
  await film.saved();
  await expect(page.locator("[data-proposal]")).toHaveCount(LEVELS.length);
  expect((await film.reading()).vertebrae.every(({ corners }) => corners.length === 0)).toBe(true);
  // Corner by corner stays one key away.
  await page.keyboard.press("t");
  await expect(film.target).toContainText("superior endplate, patient’s left");
});
