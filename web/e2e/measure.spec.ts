import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import { filmOf, type FilmPoint } from "../src/measure/viewport";
import { expect, expectAccessible, shot, test, usePages, type App } from "./app";
import { CORNERS, FilmPage, LEVELS, cornerOf, farthest } from "./marking";

test.use({ hasDemo: true });

/** Tolerance between a landmark and its click: places are rounded to 0.001 px. */
const CLOSE_PX = 0.01;

/** A new reading of the demo's erect film with L4 in the middle, and another reading as reference. */
async function atL4(app: App, page: Page): Promise<{ film: FilmPage; truth: Api<"ReadingView"> }> {
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  await film.lookAt(cornerOf(truth, "L4", "superior_left"), 0.6);
  return { film, truth };
}

test("landmarks of a whole film are placed, and results appear", async ({ app, page }) => {
  test.slow();
  const film = await FilmPage.ofDemo(app, page);
  await shot(page, "measure-begun");
  await expect(page.locator("[data-side='image-left']")).toBeVisible();
  const truth = await film.truth();
  for (const level of LEVELS) {
    await film.lookAt(cornerOf(truth, level, "superior_left"), 0.6);
    await film.mark(truth, level);
    if (level === "L2") await shot(page, "measure-enlarged");
  }
  await film.saved();
  expect(farthest(await film.reading(), truth)).toBeLessThan(CLOSE_PX);
  await expect(page.getByRole("link", { name: /erect/i })).toContainText("15 of 15");
  // The optional levels are skipped, and the crests are placed.
  await page.keyboard.press("f");
  await page.keyboard.press("n");
  const { left_px, right_px } = truth.crests;
  for (const px of [left_px!, right_px!]) {
    await expect(film.target).toContainText(/iliac crest/i);
    await film.click([px[0]!, px[1]!]);
  }
  await expect(film.target).toContainText("All landmarks placed");
  await expect(page.getByTestId("curve")).toBeVisible();
  await expect(page.getByTestId("live-status")).not.toContainText("missing");
  await expect(page.getByRole("table").first()).toContainText("°");
  await expectAccessible(page);
  await shot(page, "measure-all-marked");
});

for (const [deviceScaleFactor, tag] of [
  [1, []],
  [1.25, ["@long"]],
  [2, []],
] as const) {
  test.describe(`at ${deviceScaleFactor} device pixels per CSS pixel`, { tag: [...tag] }, () => {
    test.use({ deviceScaleFactor });

    test("painted pixels and clicks agree with film coordinates", async ({ app, page }) => {
      const { film, truth } = await atL4(app, page);
      await film.mark(truth, "L4");
      await film.saved();
      expect(farthest(await film.reading(), truth)).toBeLessThan(CLOSE_PX);

      // When zoomed in, the middle of a film pixel has the grey of its brightness.
      await film.lookAt(cornerOf(truth, "L4", "superior_left"), 9);
      expect(await film.worstGrey()).toBeLessThan(12);
      await shot(page, `measure-pixels-${deviceScaleFactor}`);
    });
  });
}

test("the view of the film does not change while its study is loaded again", async ({
  app,
  page,
}) => {
  const film = await FilmPage.ofDemo(app, page);
  const place = cornerOf(await film.truth(), "L4", "superior_left");
  await film.lookAt(place, 0.6);
  const view = await film.view();
  const pixels: string[] = [];
  page.on("request", (request) => {
    if (request.url().endsWith("/pixels")) pixels.push(request.url());
  });
  // The list of films gets every change and loads the status of the study.
  const again = page.waitForResponse((response) => /studies\/[^/]+$/.test(response.url()));
  await film.click(place);
  await film.saved();
  await again;
  await expect(page.getByRole("link", { name: /erect/i })).toContainText("0 of 15");
  expect(await film.view()).toEqual(view);
  expect(pixels).toEqual([]);
});

test("a reload keeps all landmarks, and undo still works", async ({ app, page }) => {
  const { film, truth } = await atL4(app, page);
  await film.mark(truth, "L4");
  await film.click(cornerOf(truth, "L3", "superior_left"));
  // At once, while the last clicks may still be on their way.
  await page.reload();
  await expect(film.target).toContainText(/superior endplate, patient.s right/);
  await film.saved();
  const kept = await film.reading();
  expect(kept.revision).toBe(5);
  expect(farthest(kept, truth)).toBeLessThan(CLOSE_PX);

  await page.getByRole("button", { name: "Undo" }).click();
  await expect(film.target).toContainText(/superior endplate, patient.s left/);
  await film.viewer.focus();
  await page.keyboard.press("Control+z");
  await expect(film.target).toContainText(/L4\s*inferior endplate, patient.s left/);
  await page.reload();
  await film.painted();
  await film.viewer.focus();
  await page.keyboard.press("Control+y");
  await page.keyboard.press("Control+y");
  await expect(film.target).toContainText(/L3\s*superior endplate, patient.s right/);
  await film.saved();
  expect(farthest(await film.reading(), truth)).toBeLessThan(CLOSE_PX);
});

test("swapped corners are reported at once and can be undone", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  const left = cornerOf(truth, "L4", "superior_left");
  const right = cornerOf(truth, "L4", "superior_right");
  await film.lookAt(left, 0.6);
  await film.mark(truth, "L4");
  await film.saved();
  await expect(page.getByTestId("faults")).toBeEmpty();

  const beyond: [number, number] = [right[0] + (right[0] - left[0]) / 4, right[1]];
  await page.mouse.move(...(await film.where(left)));
  await page.mouse.down();
  await page.mouse.move(...(await film.where(beyond)), { steps: 12 });
  await expect(page.getByTestId("faults")).toContainText("L4");
  await expect(page.locator("[data-level='L4'].faulty")).toBeVisible();
  await page.mouse.up();
  await film.saved();
  await expect(page.getByRole("button", { name: /^L4.*has an error/ })).toBeVisible();
  await shot(page, "measure-fault");
  await page.keyboard.press("Control+z");
  await expect(page.getByTestId("faults")).toBeEmpty();
  await expect(page.getByRole("button", { name: /^L4.*four corners/ })).toBeVisible();
});

test("a vertebra is placed and corrected with keys alone", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  await film.viewer.focus();
  await page.keyboard.press("c");
  const crosshair = page.getByTestId("crosshair");
  await expect(crosshair).toBeVisible();
  await expect(page.getByTestId("loupe")).toBeVisible();
  await shot(page, "measure-keys");
  // A square of forty steps: left, right, right, left.
  const isLeftOnLeft = (await film.reading()).image.patient_left === "image_left";
  const across = (to: "left" | "right") =>
    (to === "left") === isLeftOnLeft ? "ArrowLeft" : "ArrowRight";
  await page.keyboard.press("Enter");
  await press(across("right"), 2, "Shift+");
  await page.keyboard.press("Enter");
  await press("ArrowDown", 1, "Shift+");
  await page.keyboard.press("Enter");
  await press(across("left"), 2, "Shift+");
  await page.keyboard.press("Space");
  await expect(film.target).toContainText("L3");
  await film.saved();
  const placed = await film.reading();
  expect(placed.vertebrae[0]!.complete).toBe(true);
  expect(placed.faults).toEqual([]);

  await page.keyboard.press("[");
  await page.keyboard.press("[");
  await press("ArrowRight", 3);
  await page.keyboard.press("Shift+ArrowDown");
  await film.saved();
  const before = cornerOf(placed, "L4", "inferior_left");
  const after = cornerOf(await film.reading(), "L4", "inferior_left");
  expect(after[0] - before[0]).toBeCloseTo(0.3, 6);
  expect(after[1] - before[1]).toBeCloseTo(1, 6);
  // Nudges without a rest are one event.
  expect((await film.reading()).revision).toBe(placed.revision + 1);

  await page.keyboard.press("]");
  await press("ArrowRight", 2);
  await film.saved();
  const turned = (await film.reading()).vertebrae[0]!.axis!;
  expect(turned.by_hand).toBe(true);
  const was = Math.round(placed.vertebrae[0]!.axis!.axis_deg * 10);
  expect(Math.abs(Math.round(turned.axis_deg * 10) - was)).toBeLessThanOrEqual(8);
  await page.keyboard.press("r");
  await film.saved();
  expect((await film.reading()).vertebrae[0]!.axis!.by_hand).toBe(false);
  await page.keyboard.press("Delete");
  await film.saved();
  expect((await film.reading()).vertebrae).toEqual([]);

  async function press(key: string, times: number, with_ = ""): Promise<void> {
    for (let i = 0; i < times; i += 1) await page.keyboard.press(`${with_}${key}`);
  }
});

test("a proposal is recorded only after a person has accepted or moved it", async ({
  app,
  page,
}) => {
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  for (const level of ["L4", "L3"]) {
    await film.lookAt(cornerOf(truth, level, "superior_left"), 0.6);
    await film.mark(truth, level);
  }
  await expect(page.locator("[data-proposal='L2']")).toBeVisible();
  await film.saved();
  expect((await film.reading()).vertebrae.map(({ level }) => level)).toEqual(["L4", "L3"]);
  await shot(page, "measure-proposal");
  await page.keyboard.press("a");
  await expect(page.locator("[data-proposal='L1']")).toBeVisible();
  await film.saved();
  const accepted = await film.reading();
  expect(accepted.vertebrae.map(({ level, complete }) => [level, complete])).toContainEqual([
    "L2",
    true,
  ]);

  // The next one is dragged by a corner; its other corners are accepted too.
  const proposal = accepted.proposals.find(({ level }) => level === "L1")!;
  const proposed = proposal.corners.find(({ corner }) => corner === "superior_left")!;
  const place: FilmPoint = [proposed.px[0]! + 60, proposed.px[1]! - 40];
  await page.keyboard.press("f");
  await film.drag([proposed.px[0]!, proposed.px[1]!], place);
  await film.saved();
  const dragged = await film.reading();
  const [column, row] = cornerOf(dragged, "L1", "superior_left");
  expect(Math.hypot(column - place[0], row - place[1])).toBeLessThan(CLOSE_PX);
  for (const corner of CORNERS.slice(1)) {
    const px = proposal.corners.find((one) => one.corner === corner)!.px;
    expect(cornerOf(dragged, "L1", corner)).toEqual(px);
  }
});

test("a lost connection moves nothing: clicks on the same pixels are saved afterwards", async ({
  app,
  page,
}) => {
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  await page.getByRole("button", { name: "Fit" }).click();
  const corners = [
    ...CORNERS.map((corner) => ["L4", corner] as const),
    ...CORNERS.slice(0, 2).map((corner) => ["L3", corner] as const),
  ];
  // Measured once: the steps below click without asking the page for the film's place.
  const [view, box] = [await film.view(), (await film.viewer.boundingBox())!];
  const pixels = await Promise.all(
    corners.map(([level, corner]) => film.where(cornerOf(truth, level, corner))),
  );
  const expectUnmoved = async (): Promise<void> => {
    expect(await film.view()).toEqual(view);
    expect(await film.viewer.boundingBox()).toEqual(box);
  };

  await page.mouse.click(...pixels[0]!);
  await film.saved();
  await app.kill();
  await page.mouse.click(...pixels[1]!);
  await expect(page.getByText("The program does not answer.")).toBeVisible();
  for (const pixel of pixels.slice(2)) {
    await page.mouse.click(...pixel);
    await expectUnmoved();
  }
  await expect(page.getByTestId("saving")).toContainText(`${corners.length - 1} not saved`);
  await expect(film.target).toContainText(/L3\s*inferior endplate/);
  await expectAccessible(page);
  await shot(page, "measure-program-away");
  await app.start();
  await expect(page.getByTestId("saving")).toHaveAttribute("data-state", /saved|signed_out/, {
    timeout: 30_000,
  });
  await film.saved();
  await expectUnmoved();
  const reading = await film.reading();
  expect(reading.revision).toBe(corners.length);
  for (const [index, [level, corner]] of corners.entries()) {
    const [x, y] = pixels[index]!;
    const [column, row] = filmOf(view, [x - box.x, y - box.y]);
    const placed = cornerOf(reading, level, corner);
    expect(Math.hypot(placed[0] - column, placed[1] - row)).toBeLessThan(CLOSE_PX);
  }
});

test("unsaved clicks of a crashed window are not lost", async ({ app, page, context }) => {
  const { film, truth } = await atL4(app, page);
  await page.route("**/events", (route) => route.abort());
  await film.click(cornerOf(truth, "L4", "superior_left"));
  await expect(page.getByTestId("saving")).toContainText("1 not saved");
  const address = page.url();
  await page.close();
  const again = await context.newPage();
  await usePages(again);
  await again.goto(address);
  const dialog = again.getByRole("dialog", { name: /earlier window/i });
  await expect(dialog).toContainText("L4 – superior endplate");
  await dialog.getByRole("button", { name: /apply my changes/i }).click();
  const back = new FilmPage(again);
  await back.saved();
  expect(farthest(await back.reading(), truth)).toBeLessThan(CLOSE_PX);
});

test("the scale is set by two clicks and holds for the film", async ({ app, page }) => {
  await FilmPage.ofDemo(app, page);
  await page.getByRole("button", { name: "Scale" }).click();
  const box = (await page.getByTestId("viewer").boundingBox())!;
  await page.mouse.click(box.x + box.width / 2, box.y + 200);
  await page.mouse.click(box.x + box.width / 2, box.y + 300);
  const dialog = page.getByRole("dialog", { name: /scale of this film/i });
  // A ball cannot have this size; the form is not sent.
  await dialog.getByLabel(/true diameter/i).fill("254");
  await expect(dialog).toContainText("254 mm: expected 1 to 200 mm");
  await dialog.getByRole("button", { name: /set the scale/i }).click();
  await expect(dialog).toBeVisible();
  // A decimal comma is a decimal point, and the value is read back.
  await dialog.getByLabel(/true diameter/i).fill("25,4");
  await expect(dialog).toContainText("read as 25.4 mm");
  await dialog.getByLabel(/standard deviation/i).fill("0.1");
  await shot(page, "measure-scale");
  await dialog.getByRole("button", { name: /set the scale/i }).click();
  await expect(dialog).toBeHidden();
  await expect(page.getByTestId("spacing")).toContainText("ball");
  // The strip beside the film states once what moved.
  const moved = page.getByText(/^Scale: 0\.2000 → 0\.\d{4} mm per row; film \d+ → \d+ mm high$/);
  await expect(moved).toBeVisible();
  await shot(page, "measure-scale-moved");
  await page.getByRole("button", { name: "Dismiss" }).click();
  await expect(moved).toHaveCount(0);
  // The program refuses a scale that makes the film larger than any film of a spine.
  await page.getByRole("button", { name: "Scale" }).click();
  await page.mouse.click(box.x + box.width / 2, box.y + 200);
  await page.mouse.click(box.x + box.width / 2, box.y + 220);
  await dialog.getByLabel(/true diameter/i).fill("150");
  await dialog.getByRole("button", { name: /set the scale/i }).click();
  await expect(dialog.getByRole("alert")).toContainText("no film of a spine is more than 2500 mm");
});

test("a finished reading cannot be changed", async ({ app, page }) => {
  const { film, truth } = await atL4(app, page);
  await film.mark(truth, "L4");
  await film.saved();
  await film.finish();
  await expect(film.target).toContainText("Finished");
  await film.click(cornerOf(truth, "L3", "superior_left"));
  await expect(page.getByRole("button", { name: "Undo" })).toHaveCount(0);
  expect((await film.reading()).vertebrae).toHaveLength(1);
  await page.getByRole("button", { name: "Read again" }).click();
  await expect(film.target).toContainText("L4");
  await shot(page, "measure-second-reading");
  expect((await film.reading()).repeat).toBe(2);
});

test("a scale bar shows lengths at every zoom", async ({ app, page }) => {
  const row_mm = 0.2;
  await page.route("**/api/studies/*", async (route) => {
    const response = await route.fetch();
    const detail = (await response.json()) as Api<"StudyDetail">;
    for (const film of detail.summary?.films ?? [])
      Object.assign(film, { row_mm, image: { ...film.image, plane: "detector" } });
    await route.fulfill({ response, json: detail });
  });
  await app.openDemo(page);
  const film = new FilmPage(page);
  await film.painted();
  const bar = page.getByTestId("scale-bar");
  for (const scale of [0, 0.6, 3]) {
    await film.lookAt([900, 1800], scale);
    const [, length, where] = /^(\d+) mm(.*)$/.exec((await bar.textContent())!.trim())!;
    expect(where).toBe(" at the detector");
    const drawn = await bar
      .locator("path")
      .last()
      .evaluate((path) => {
        const { width } = (path as SVGPathElement).getBBox();
        return width;
      });
    const { scale: css, aspect } = await film.view();
    expect(drawn).toBeCloseTo((Number(length) * css * aspect) / row_mm, 1);
    expect(drawn).toBeLessThanOrEqual(160);
    await shot(page, `measure-scale-bar-${scale}`);
  }
});

test(
  "landmarks are recorded without browser storage, with one message",
  { tag: "@long" },
  async ({ app, page }) => {
    await page.addInitScript(() => {
      Storage.prototype.setItem = () => {
        throw new DOMException("full", "QuotaExceededError");
      };
    });
    const { film, truth } = await atL4(app, page);
    await film.mark(truth, "L4");
    await film.saved();
    expect(farthest(await film.reading(), truth)).toBeLessThan(CLOSE_PX);
    const told = page.getByText("This browser cannot store data for this page");
    await expect(told).toBeVisible();
    await expectAccessible(page);
    await page.getByRole("button", { name: "Dismiss" }).click();
    await expect(told).toHaveCount(0);
  },
);
