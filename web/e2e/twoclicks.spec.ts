import type { Api } from "../src/api/types";
import { expect, shot, test } from "./app";
import { truthOf } from "./byclicks";
import { CORNERS, FilmPage, LEVELS, cornerOf, farthest } from "./marking";

test.use({ hasDemo: true });

type ReadingView = Api<"ReadingView">;

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
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  await page.getByRole("button", { name: /two clicks/i }).click();
  await expect(film.target).toContainText("middle of the wall, patient’s left");
  let clicks = 0;
  for (const level of LEVELS) {
    await film.markWalls(truth, level);
    clicks += 2;
  }
  await film.saved();
  await expect(page.locator("[data-proposal]")).toHaveCount(LEVELS.length);
  await shot(page, "measure-two-clicks");
  await page.keyboard.press("Enter");
  await film.saved();
  await expect(page.locator("[data-proposal]")).toHaveCount(0);
  const accepted = await film.reading();
  const origins = accepted.vertebrae.flatMap(({ corners }) => corners.map(({ origin }) => origin));
  expect(origins).toEqual(LEVELS.flatMap(() => CORNERS.map(() => "accepted")));
  // The worst corner lies within half a vertebral height of another reader's.
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

test("vertebrae are proposed on request and accepted one by one", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  // Two vertebrae show where the next ones lie.
  for (const level of LEVELS.slice(0, 2)) {
    for (const corner of CORNERS) await film.click(cornerOf(truth, level, corner));
  }
  await film.saved();
  await page.keyboard.press("p");
  const drawn = page.locator("[data-proposal]");
  await expect(drawn.first()).toBeVisible();
  const before = await drawn.count();
  expect(before).toBeGreaterThan(1);
  await shot(page, "measure-proposals");
  await page.keyboard.press("a");
  await film.saved();
  const third = LEVELS[2]!;
  await expect(page.locator(`[data-proposal="${third}"]`)).toHaveCount(0);
  const accepted = (await film.reading()).vertebrae.filter(({ corners }) =>
    corners.some(({ origin }) => origin === "accepted"),
  );
  expect(accepted.map(({ level }) => level)).toEqual([third]);
  await expect(page.getByRole("button", { name: /accepted as proposed/ })).toHaveCount(1);
  await page.keyboard.press("p");
  await expect(page.getByRole("button", { name: /^Propose/ })).toHaveAttribute(
    "aria-pressed",
    "false",
  );
});

test("ten clicks on a bend and one key complete it from the erect film", async ({ app, page }) => {
  await app.openDemo(page);
  const link = page
    .getByRole("navigation", { name: "Films" })
    .getByRole("link", { name: /left bending/i });
  await link.click();
  const film = new FilmPage(page);
  await film.begin();
  const truth = await truthOf(film);
  for (const level of ["L4", "L1", "T9", "T5", "T2"]) await film.markWalls(truth, level);
  await film.saved();
  const erect = page.getByRole("region", { name: "Erect film" });
  await expect(erect.locator("[data-level]")).toHaveCount(LEVELS.length);
  await shot(page, "measure-bend-ten-clicks");
  const accept = page.getByRole("button", { name: /^Accept 15 vertebrae/ });
  await expect(accept).toBeVisible();
  await page.keyboard.press("Enter");
  await expect(accept).toHaveCount(0);
  await film.saved();
  const accepted = await film.reading();
  expect(accepted.vertebrae.filter(({ complete }) => complete)).toHaveLength(LEVELS.length);
  expect(farthest(accepted, truth)).toBeLessThan(0.4 * height(truth));
  await expect(page.getByTitle("Width against the erect film")).toHaveCount(LEVELS.length);

  // The same vertebra on both films, at one scale: all demo films have one spacing.
  await page.getByRole("button", { name: /^T8/ }).click();
  await expect(erect.locator(".current")).toHaveAttribute("data-level", "T8");
  const scaleOf = async (index: number): Promise<number> =>
    (
      JSON.parse((await page.getByTestId("viewer").nth(index).getAttribute("data-view"))!) as {
        scale: number;
      }
    ).scale;
  expect(await scaleOf(1)).toBeCloseTo(await scaleOf(0), 6);
  await shot(page, "measure-bend-accepted");
  await page.keyboard.press("8");
  await expect(erect).toHaveCount(0);
});
