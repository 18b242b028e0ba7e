import path from "node:path";

import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import type { FilmPoint } from "../src/measure/viewport";
import { expect, expectAccessible, shot, test, type App } from "./app";
import { FilmPage, cornerOf, farthest } from "./marking";

test.use({ hasDemo: true });

/** Tolerance between a landmark and its click: places are rounded to 0.001 px. */
const CLOSE_PX = 0.01;
/** Texts have one decimal. */
const ROUNDED = 0.051;

/** Patient 15 is seen from the front, and its pixels are 0.1 mm wide and 0.125 mm high. */
const FRONT = "phantom-rod-15";
const [COLUMN_MM, ROW_MM] = [0.2, 0.25];

/** A study of a patient seen from the front, with pixels that are not square. */
async function fromTheFront(app: App, page: Page): Promise<FilmPage> {
  const folder = await app.makePhantom("--subject", "15", "--noise", "0", "--pixel-size", "2");
  await app.addCases(path.join(folder, `${FRONT}.json`));
  await app.start();
  await app.openAt(page, `#/studies/${FRONT}/measure`);
  const film = new FilmPage(page);
  await film.begin();
  return film;
}

/** Screen place of the label of a patient's side. */
async function sideOf(
  film: FilmPage,
  side: "L" | "R",
): Promise<"left" | "right" | "above" | "below"> {
  const viewer = (await film.viewer.boundingBox())!;
  const label = film.page.locator("[data-side]").filter({ hasText: new RegExp(`^${side}$`) });
  const box = (await label.boundingBox())!;
  const isLeft = box.x + box.width / 2 < viewer.x + viewer.width / 2;
  const isAbove = box.y + box.height / 2 < viewer.y + viewer.height / 2;
  const isOnItsSide = (await film.view()).turn.quarters % 2 === 1;
  return isOnItsSide ? (isAbove ? "above" : "below") : isLeft ? "left" : "right";
}

test("a film that is turned and mirrored for display is marked as it is stored", async ({
  app,
  page,
}) => {
  const film = await fromTheFront(app, page);
  const truth = await film.truth();
  const turned = page.getByTestId("turned");
  await expect(turned).toBeEmpty();
  // Seen from the front, the patient's left is on the right.
  expect(truth.image.patient_left).toBe("image_right");
  expect(await sideOf(film, "L")).toBe("right");

  await choose(page, /turn or mirror/i, "Mirror");
  await expect(turned).toContainText(
    "Shown mirrored. Left, right and landmarks stay the patient’s",
  );
  expect(await sideOf(film, "L")).toBe("left");
  await film.mark(truth, "L4");
  await film.viewer.focus();
  await page.keyboard.press("q");
  await expect(turned).toContainText("Shown mirrored, then turned 90° clockwise");
  expect([await sideOf(film, "L"), await sideOf(film, "R")]).toEqual(["above", "below"]);
  await film.mark(truth, "L3");
  await film.saved();
  await shot(page, "films-turned");
  await expectAccessible(page);
  const reading = await film.reading();
  expect(farthest(reading, truth)).toBeLessThan(CLOSE_PX);
  expect(reading.faults).toEqual([]);

  // Arrows move a landmark as seen: up on the screen is along the columns here.
  await page.keyboard.press("Shift+ArrowUp");
  await film.saved();
  const before = cornerOf(truth, "L3", "inferior_left");
  const after = cornerOf(await film.reading(), "L3", "inferior_left");
  expect(Math.abs(after[0] - before[0] - 1)).toBeLessThan(CLOSE_PX);
  expect(Math.abs(after[1] - before[1])).toBeLessThan(CLOSE_PX);

  await film.lookAt(cornerOf(truth, "L4", "superior_left"), 9);
  expect(await film.worstGrey()).toBeLessThan(12);
  await choose(page, /turn or mirror/i, "As stored");
  await expect(turned).toBeEmpty();
  expect(await film.worstGrey()).toBeLessThan(12);
});

test(
  "lengths and angles are measured in the patient's millimetres and are not stored",
  { tag: "@long" },
  async ({ app, page }) => {
    const film = await fromTheFront(app, page);
    const answer = page.getByTestId("drawn");
    const before = await film.reading();
    const number = async (name: RegExp): Promise<number> => {
      await expect(answer).toContainText(name);
      return Number(/ ([\d.]+) ±/.exec((await answer.textContent())!)![1]);
    };
    const mm = (a: FilmPoint, b: FilmPoint): readonly [number, number] => [
      (b[0] - a[0]) * COLUMN_MM,
      (b[1] - a[1]) * ROW_MM,
    ];

    for (const isMirrored of [false, true]) {
      if (isMirrored) {
        await page.keyboard.press("m");
        await page.keyboard.press("q");
      }
      await page.getByRole("button", { name: "Length", exact: true }).click();
      await expect(answer).toContainText("Click one end");
      const [from, to] = [await film.click([600, 1000]), await film.click([1050, 1550])];
      const length = await number(/^Length [\d.]+ ± [\d.]+ mm/);
      expect(Math.abs(length - Math.hypot(...mm(from, to)))).toBeLessThan(ROUNDED);
      await expect(answer).toContainText("mm (patient)");
      await expect(answer).toContainText("Not stored");
      await shot(page, `films-length-${isMirrored}`);

      await page.getByRole("button", { name: "Angle", exact: true }).click();
      const ends: FilmPoint[] = [];
      for (const place of [
        [500, 600],
        [1100, 750],
        [550, 1450],
        [1150, 1250],
      ] as const)
        ends.push(await film.click(place));
      const angle = await number(/^Angle [\d.]+ ± [\d.]+°/);
      const [a, b] = [mm(ends[0]!, ends[1]!), mm(ends[2]!, ends[3]!)];
      const between = Math.atan2(
        Math.abs(a[0] * b[1] - a[1] * b[0]),
        Math.abs(a[0] * b[0] + a[1] * b[1]),
      );
      expect(Math.abs(angle - (between * 180) / Math.PI)).toBeLessThan(ROUNDED);
      await shot(page, `films-angle-${isMirrored}`);
    }
    await expectAccessible(page);

    // An end that is dragged is measured again.
    const was = await number(/^Angle/);
    const [x, y] = await film.where([1150, 1250]);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 40, y - 60, { steps: 6 });
    await page.mouse.up();
    await expect.poll(() => number(/^Angle/)).not.toBe(was);
    // Clicks with these tools do not place landmarks.
    expect(await film.reading()).toEqual(before);
    await page.keyboard.press("Escape");
    await expect(answer).toContainText("first line");
  },
);

test("a length is measured with keys alone, and in pixels where a film has no scale", async ({
  app,
  page,
}) => {
  await app.openDemo(page);
  const film = new FilmPage(page);
  await film.painted();
  const noScale: Api<"DrawnView"> = { text: "842 px", note: "this film has no scale" };
  await film.viewer.focus();
  await page.keyboard.press("d");
  await page.keyboard.press("c");
  await page.keyboard.press("Enter");
  for (let i = 0; i < 3; i += 1) await page.keyboard.press("Shift+ArrowRight");
  await page.keyboard.press("Enter");
  const { scale } = await film.view();
  const answer = page.getByTestId("drawn");
  await expect(answer).toContainText("± ");
  const length = Number(/ ([\d.]+) ±/.exec((await answer.textContent())!)![1]);
  // Three steps of 40 CSS pixels; a column of the demo is 0.2 mm.
  expect(Math.abs(length - (120 / scale) * 0.2)).toBeLessThan(ROUNDED);
  await page.route("**/drawn", (route) => route.fulfill({ json: noScale }));
  await page.keyboard.press("Escape");
  await page.keyboard.press("Enter");
  await page.keyboard.press("Shift+ArrowDown");
  await page.keyboard.press("Enter");
  await expect(answer).toContainText("842 px");
  await expect(answer).toContainText("no scale");
  // Refused by the program: too short.
  await page.unroute("**/drawn");
  await page.keyboard.press("Escape");
  await page.keyboard.press("Enter");
  await page.keyboard.press("Enter");
  await expect(answer.getByRole("alert")).toContainText("the minimum is 5.0");
});

const PRESETS = /preset of window/i;

/** Runs an action of a menu. */
async function choose(page: Page, menu: RegExp, item: string): Promise<void> {
  await page.getByRole("button", { name: menu }).click();
  await page.getByRole("menuitem", { name: item }).click();
}

test("presets of window and level change the picture", async ({ app, page }) => {
  await app.openDemo(page);
  const film = new FilmPage(page);
  await film.painted();
  await page.getByRole("button", { name: PRESETS }).click();
  await expect(page.getByRole("menuitem")).toHaveText([
    "As filmed",
    "Bone",
    "Soft tissue",
    "Darkest to brightest 1 %",
    "Full range",
  ]);
  // Arrows go through the menu and change nothing; Escape returns to its button.
  await expect(page.getByRole("menuitem", { name: "As filmed" })).toBeFocused();
  await page.keyboard.press("ArrowDown");
  await expect(page.getByRole("menuitem", { name: "Bone" })).toBeFocused();
  await page.keyboard.press("Escape");
  await expect(page.getByRole("button", { name: PRESETS })).toBeFocused();
  const mean = (): Promise<number> =>
    page.getByTestId("film").evaluate((element) => {
      const canvas = element as HTMLCanvasElement;
      const { data } = canvas.getContext("2d")!.getImageData(0, 0, canvas.width, canvas.height);
      let sum = 0;
      for (let i = 0; i < data.length; i += 4) sum += data[i]!;
      return (4 * sum) / data.length;
    });
  const filmed = await mean();
  const means: number[] = [];
  for (const preset of ["Bone", "Soft tissue", "Darkest to brightest 1 %", "Full range"]) {
    await choose(page, PRESETS, preset);
    await expect.poll(mean).not.toBe(means.at(-1) ?? filmed);
    means.push(await mean());
    await shot(page, `films-window-${preset.split(" ")[0]!.toLowerCase()}`);
  }
  expect(means[0]).toBeLessThan(means[1]!);
  // The key selects the first preset.
  await film.viewer.focus();
  await page.keyboard.press("v");
  await expect.poll(mean).toBe(filmed);
});

test("two films are shown side by side, each with its own view, or linked", async ({
  app,
  page,
}) => {
  await app.openDemo(page);
  await page.getByRole("link", { name: "Side by side" }).click();
  const [first, second] = [
    page.getByRole("region", { name: "First film" }),
    page.getByRole("region", { name: "Second film" }),
  ];
  await expect(first.getByRole("combobox", { name: "First film" })).toHaveValue(/\d/);
  await expect(second.getByTestId("spacing")).toBeVisible();
  for (const one of [first, second]) await expect(one.getByTestId("curve")).toBeVisible();
  const views = async (): Promise<string[]> =>
    Promise.all(
      [first, second].map(
        async (one) => (await one.getByTestId("viewer").getAttribute("data-view"))!,
      ),
    );
  const still = await views();
  await shot(page, "films-beside");
  await expectAccessible(page);

  await first.getByRole("button", { name: "Enlarge" }).click();
  await expect.poll(async () => (await views())[0]).not.toBe(still[0]);
  expect((await views())[1]).toBe(still[1]);

  await page.getByRole("checkbox", { name: /both films together/i }).check();
  const scales = async (): Promise<number[]> =>
    (await views()).map((view) => (JSON.parse(view) as { scale: number }).scale);
  const before = await scales();
  await second.getByTestId("viewer").hover();
  await page.mouse.wheel(0, -200);
  await expect.poll(async () => (await scales())[1]).toBeGreaterThan(before[1]!);
  const after = await scales();
  expect(after[0]! / before[0]!).toBeCloseTo(after[1]! / before[1]!, 9);
  const left = async (): Promise<number[]> =>
    (await views()).map((view) => (JSON.parse(view) as { left: number }).left);
  const was = await left();
  await first.getByTestId("viewer").focus();
  await page.keyboard.press("ArrowRight");
  await expect.poll(left).toEqual(was.map((one) => one - 60));
  // Each film is turned separately, and keys only reach the film with the focus.
  await page.keyboard.press("q");
  await expect(first.getByTestId("turned")).toContainText("turned 90° clockwise");
  await expect(second.getByTestId("turned")).toBeEmpty();
  await shot(page, "films-beside-turned");

  const number = (await first.getByRole("option", { name: /traction/i }).getAttribute("value"))!;
  await first.getByRole("combobox", { name: "First film" }).selectOption(number);
  await expect(first.getByRole("application", { name: /traction film/i })).toBeVisible();
  await expect(first.getByTestId("turned")).toBeEmpty();
});

test("a person states that a film was compared with the records", async ({ app, page }) => {
  await app.openAt(page, "#/studies/demo-rod-01/measure");
  const edit = async (): Promise<void> => {
    await page.getByRole("button", { name: "Edit this film…" }).click();
  };
  const compared = page.getByRole("checkbox", { name: /^I compared this film/ });
  await edit();
  await expect(compared).not.toBeChecked();
  await compared.check();
  await shot(page, "film-compared");
  await page.getByRole("button", { name: "Change the film" }).click();
  await page.reload();
  await edit();
  await expect(compared).toBeChecked();
  const studies = await page.request.get(
    new URL("/api/studies/demo-rod-01/case", app.address).href,
  );
  const { films } = (await studies.json()) as { films: { checked?: boolean }[] };
  expect(films.filter((film) => film.checked)).toHaveLength(1);
});
