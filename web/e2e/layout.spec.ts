import { expect, expectReadable, shot, test } from "./app";
import { FilmPage, LEVELS, cornerOf } from "./marking";

test.use({ hasDemo: true });

/** Keys of a Russian keyboard: character and place. */
const RUSSIAN = { t: ["е", "KeyT"], z: ["я", "KeyZ"], y: ["н", "KeyY"], f: ["а", "KeyF"] } as const;

test("letters and undo act on a Russian keyboard, until they are switched off", async ({
  app,
  page,
}) => {
  const film = await FilmPage.ofDemo(app, page);
  const press = (letter: keyof typeof RUSSIAN, ctrlKey = false) =>
    film.viewer.evaluate(
      (viewer, [key, code, ctrlKey]) => {
        const held = { bubbles: true, cancelable: true, ctrlKey };
        viewer.dispatchEvent(new KeyboardEvent("keydown", { key, code, ...held }));
      },
      [...RUSSIAN[letter], ctrlKey] as const,
    );
  const truth = await film.truth();
  await film.lookAt(cornerOf(truth, "L4", "superior_left"), 0.6);
  const enlarged = await film.view();
  await film.click(cornerOf(truth, "L4", "superior_left"));
  await expect(film.target).toContainText(/superior endplate, patient.s right/);
  await press("z", true);
  await expect(film.target).toContainText(/superior endplate, patient.s left/);
  await press("y", true);
  await expect(film.target).toContainText(/superior endplate, patient.s right/);
  await press("t");
  await expect(film.target).toContainText("middle of the wall");
  await press("t");
  await press("f");
  await expect.poll(() => film.view()).not.toEqual(enlarged);

  await page.keyboard.press("?");
  const help = page.getByRole("dialog", { name: "Keys" });
  await expect(help).toContainText("two clicks per vertebra");
  await shot(page, "layout-keys");
  await help.getByRole("checkbox", { name: /act without Ctrl/ }).uncheck();
  await help.getByRole("button", { name: "Close" }).click();
  await film.viewer.focus();
  await press("t");
  await page.keyboard.press("t");
  await press("z", true);
  await expect(film.target).toContainText(/superior endplate, patient.s left/);
  await expect(film.target).not.toContainText("wall");
});

test("the film is the first stop after the link that skips the rest, and tools are one stop", async ({
  app,
  page,
}) => {
  const film = await FilmPage.ofDemo(app, page);
  await page.evaluate(() => (document.activeElement as HTMLElement).blur());
  await page.getByRole("link", { name: "Skip to the film" }).focus();
  await page.keyboard.press("Enter");
  await expect(film.viewer).toBeFocused();
  // Back over the levels and the tools.
  await page.keyboard.press("Shift+Tab");
  await expect(page.getByRole("navigation", { name: "Vertebrae" }).locator(":focus")).toHaveText(
    /^L4/,
  );
  await page.keyboard.press("ArrowDown");
  await expect(page.getByRole("button", { name: /^L5/ })).toBeFocused();
  await page.keyboard.press("Shift+Tab");
  await expect(page.getByRole("button", { name: "Mark", exact: true })).toBeFocused();
  await page.keyboard.press("End");
  await expect(page.getByRole("button", { name: "Full screen" })).toBeFocused();
  await page.keyboard.press("ArrowDown");
  await expect(page.getByRole("button", { name: "Mark", exact: true })).toBeFocused();
});

test("the film takes what the screen has, and the next landmark stays readable", async ({
  app,
  page,
}) => {
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  const widthOf = async () => {
    const { scale } = await film.view();
    return scale * truth.image.columns;
  };
  for (const [width, height] of [
    [1280, 720],
    [1280, 800],
    [1920, 1080],
  ] as const) {
    await page.setViewportSize({ width, height });
    await expectReadable(page.getByText("superior endplate, patient’s left"));
    await expectReadable(film.target.getByText("L4"));
    await expect(page.getByRole("button", { name: "Full screen" })).toBeInViewport({ ratio: 1 });
    await expect(page.getByRole("button", { name: /^Crests/ })).toBeInViewport({ ratio: 1 });
  }
  await page.setViewportSize({ width: 1280, height: 800 });
  await expect.poll(widthOf).toBeGreaterThan(400);
  const before = (await film.viewer.boundingBox())!.width;
  await page.getByRole("button", { name: "Hide the results" }).click();
  await page.getByRole("button", { name: "Hide the study" }).click();
  await expect.poll(async () => (await film.viewer.boundingBox())!.width).toBe(before + 440);
  await page.reload();
  await expect(page.getByRole("button", { name: "Show the results" })).toBeVisible();
  await film.painted();
  const fitted = await widthOf();
  await page.keyboard.press("b");
  await expect.poll(widthOf).toBeGreaterThan(fitted);
  await page.keyboard.press("b");
  await expect.poll(widthOf).toBe(fitted);
});

test("two keys finish a reading and begin the next film", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  const first = LEVELS[0]!;
  await film.lookAt(cornerOf(truth, first, "superior_left"), 0.6);
  await film.mark(truth, first);
  await film.click(cornerOf(truth, LEVELS[1]!, "superior_left"));
  await film.saved();
  await page.keyboard.press("Control+Enter");
  const dialog = page.getByRole("dialog", { name: /finish this reading/i });
  await expect(dialog).toContainText("Half placed: L3");
  await expect(dialog.getByRole("button", { name: /^Finish/ }).first()).toBeDisabled();
  await page.keyboard.press("Enter");
  await expect(dialog).toBeHidden();
  await page.keyboard.press("Control+z");
  await expect(film.target).toContainText(/L3\s*superior endplate, patient.s left/);
  await film.saved();
  await page.keyboard.press("Control+Enter");
  await expect(dialog).toContainText("1 vertebra has four corners");
  await page.keyboard.press("Enter");
  await expect(page.getByRole("link", { name: /^Left bending/ })).toHaveAttribute(
    "aria-current",
    "page",
  );
  await expect(page.getByRole("link", { name: /^Left bending/ })).toContainText("0 of 15");
  await expect(page.getByRole("link", { name: /^Erect/ })).toContainText("finished");
  await expect(film.target).toContainText("L4");
  await film.painted();
  // One key without finishing, and back.
  await page.keyboard.press(".");
  await expect(page.getByRole("link", { name: /^Right bending/ })).toContainText("0 of 15");
  await expect(film.target).toContainText("L4");
  await film.painted();
  await page.keyboard.press(",");
  await expect(page.getByRole("link", { name: /^Left bending/ })).toHaveAttribute(
    "aria-current",
    "page",
  );
});

test("a reading is not finished before its last change is saved", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  await film.mark(await film.truth(), LEVELS[0]!);
  await film.saved();
  await page.route("**/events", (route) => route.abort());
  await page.getByText("Notes (0)").click();
  await page.getByLabel("New note").fill("blurred");
  await page.getByRole("button", { name: "Add note" }).click();
  await film.viewer.focus();
  await page.keyboard.press("Control+Enter");
  const dialog = page.getByRole("dialog", { name: /finish this reading/i });
  const finish = dialog.getByRole("button", { name: "Finish", exact: true });
  await expect(dialog).toContainText("still being saved");
  await expect(finish).toBeDisabled();
  await page.unroute("**/events");
  await expect(finish).toBeEnabled();
});
