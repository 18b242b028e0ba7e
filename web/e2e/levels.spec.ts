import { expect, expectAccessible, shot, test } from "./app";
import { FilmPage, LEVELS, cornerOf } from "./marking";

test.use({ hasDemo: true });

/** Records the corners of some levels of another reading. */
async function marked(film: FilmPage, levels: readonly string[]): Promise<void> {
  const truth = await film.truth();
  await film.record(levels, (level, corner) => cornerOf(truth, level, corner));
}

test("one key names all vertebrae one level up, and undo names them as before", async ({
  app,
  page,
}) => {
  const film = await FilmPage.ofDemo(app, page);
  await marked(film, ["L4", "L3"]);
  await expect(film.target).toContainText("L2");
  const names = async (): Promise<string[]> => {
    await film.saved();
    return (await film.reading()).vertebrae.map(({ level }) => level);
  };
  await film.viewer.focus();
  await page.keyboard.press("u");
  await expect(film.target).toContainText("L4");
  expect(await names()).toEqual(["L3", "L2"]);
  await shot(page, "levels-up");
  await page.keyboard.press("Control+z");
  await expect(film.target).toContainText("L2");
  expect(await names()).toEqual(["L4", "L3"]);
  await page.getByRole("button", { name: "Name all vertebrae one level up or down" }).click();
  await page.getByRole("menuitem", { name: "All one level down" }).click();
  expect(await names()).toEqual(["L5", "L4"]);
  // L5 has no known level below: the program refuses the change and says why.
  await page.keyboard.press("j");
  await expect(page.getByTestId("faults")).toContainText("a vertebra would have no level");
  expect(await names()).toEqual(["L5", "L4"]);
  await expectAccessible(page);
});

test("a click far from the spine is asked about and undone by one press", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  await marked(film, LEVELS);
  await expect(film.target).toContainText("T1");
  const [column, row] = cornerOf(await film.truth(), "T2", "superior_left");
  const far: [number, number] = [column > 750 ? column - 700 : column + 700, row];
  await film.click(far);
  const asked = page.getByRole("dialog", { name: "Far from the spine" });
  await expect(asked).toContainText("does this landmark belong to T1?");
  await expectAccessible(page);
  await shot(page, "far-click");
  await page.keyboard.press("Enter");
  await expect(asked).toBeHidden();
  await film.saved();
  expect((await film.reading()).vertebrae).toHaveLength(LEVELS.length);
  // A confirmed place is not asked about again, and stays a warning.
  await film.click(far);
  await asked.getByRole("button", { name: "Keep it" }).click();
  await film.click([far[0] + 100, far[1]]);
  await film.saved();
  await expect(asked).toBeHidden();
  await expect(page.getByTestId("faults")).toContainText("does this landmark belong to T1?");
});

test("a film that ends at T6 shows angles, a curve and Cobb lines before the end of the reading", async ({
  app,
  page,
}) => {
  const film = await FilmPage.ofDemo(app, page);
  await marked(film, LEVELS.slice(0, LEVELS.indexOf("T6") + 1));
  await expect(film.target).toContainText("T5");
  await expect(page.getByTestId("live-status")).toContainText("11 of 15 vertebrae");
  await expect(page.getByTestId("curve")).toBeVisible();
  const angle = page.getByTestId("findings").locator(".cobb text").first();
  await expect(angle).toHaveText(/\d+\.\d°/);
  await expect(page.getByRole("complementary", { name: "Results" })).toContainText(
    (await angle.textContent())!,
  );
  await shot(page, "ends-at-t6");
});
