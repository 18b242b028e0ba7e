import { expect, shot, test, usePages } from "./app";
import { FilmPage, cornerOf } from "./marking";

test.use({ hasDemo: true });

test("two windows never overwrite each other: the later change is kept separately", async ({
  app,
  page,
  context,
}) => {
  const first = await FilmPage.ofDemo(app, page);
  const truth = await first.truth();
  const place = cornerOf(truth, "L4", "superior_left");
  const other = await context.newPage();
  await usePages(other);
  // The second window gets no change events, as on a slow connection.
  await other.route("**/changes", (route) => route.abort());
  await other.goto(page.url());
  const second = new FilmPage(other);
  await second.painted();
  await expect(second.target).toContainText("L4");

  await first.click(place);
  await first.saved();
  await second.click([place[0] + 40, place[1] + 40]);
  const dialog = other.getByRole("dialog", { name: /changed elsewhere/i });
  await expect(dialog).toContainText("L4 – superior endplate");
  await shot(other, "conflict");
  // The first change is kept on both screens.
  const stands = cornerOf(await second.reading(), "L4", "superior_left");
  expect(Math.hypot(stands[0] - place[0], stands[1] - place[1])).toBeLessThan(0.01);
  expect((await second.reading()).conflicts).toHaveLength(1);

  await dialog.getByRole("button", { name: /apply my changes/i }).click();
  await second.saved();
  const applied = cornerOf(await second.reading(), "L4", "superior_left");
  expect(Math.hypot(applied[0] - place[0] - 40, applied[1] - place[1] - 40)).toBeLessThan(0.01);
  // The first window gets the change event, reports it and shows it.
  await expect(page.getByText(/changed in another window/i)).toBeVisible();
  await expect(other.getByText(/lost changes \(1\)/i)).toBeVisible();
});

test("a duplicated window does not send the other window's unsaved changes", async ({
  app,
  page,
  context,
}) => {
  const first = await FilmPage.ofDemo(app, page);
  const truth = await first.truth();
  await page.route("**/events", (route) => route.abort());
  await first.click(cornerOf(truth, "L4", "superior_left"));
  await expect(page.getByTestId("saving")).toContainText("1 not saved");
  const copied = await page.evaluate(() => ({ ...sessionStorage }));
  const other = await context.newPage();
  await usePages(other);
  await other.addInitScript((stored) => {
    for (const [key, value] of Object.entries(stored)) sessionStorage.setItem(key, value as string);
  }, copied);
  await other.goto(page.url());
  const second = new FilmPage(other);
  await expect(second.target).toContainText("L4");
  await second.saved();
  expect((await second.reading()).revision).toBe(0);
  await page.unroute("**/events");
  await first.saved();
  expect((await first.reading()).revision).toBe(1);
});
