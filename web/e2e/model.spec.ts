import { chromium, type Locator, type Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import {
  expectAccessible,
  expect,
  expectReadable,
  onPhoneAndComputer,
  shot,
  test,
  type App,
} from "./app";
import { BROWSER, ENVIRONMENT } from "./browser";
import { loadAnswer, modelView } from "./model.fixture";

test.use({ hasDemo: true });

const ADDRESS = "#/studies/phantom-rod-01/model";

/** Answers with a model that has a contradiction, a bound and a line without a result. */
async function pretend(page: Page, view: Api<"ModelView">, patient_left: string): Promise<void> {
  const detail = { summary: { films: [{ posture: "erect", image: { patient_left } }] } };
  await page.route("**/api/studies/phantom-rod-01", (route) => route.fulfill({ json: detail }));
  await page.route("**/api/studies/phantom-rod-01/model", (route) => route.fulfill({ json: view }));
  await page.route("**/api/studies/phantom-rod-01/computations/replicates", (route) =>
    route.fulfill({ json: replicates(route.request().method() === "POST" ? 40 : 0) }),
  );
  await page.route("**/api/studies/phantom-rod-01/load", (route) =>
    route.fulfill({ json: loadAnswer(route.request().postDataJSON() as Api<"LoadRequest">) }),
  );
}

/** Replicates at their start, while running, or done. */
function replicates(done: number): Api<"ComputationView"> {
  const intervals =
    done === 200 ? [{ label: "Cobb angle", value: "48.2°", interval: "46.9° to 49.6°" }] : [];
  const state = done === 0 ? "none" : done === 200 ? "done" : "running";
  return { name: "replicates", state, done, asked: 200, intervals, sections: [], texts: [] };
}

/** Opens the page of a model that the program did not compute. */
async function openModel(
  app: App,
  page: Page,
  view = modelView(),
  patient_left = "image_left",
): Promise<void> {
  await pretend(page, view, patient_left);
  await app.open(page);
  await page.evaluate((address) => (window.location.hash = address), ADDRESS);
  await expect(page.getByRole("heading", { level: 1, name: /^Model/ })).toBeVisible();
}

/** The picture in 3D when it no longer changes; models without a lateral film open in flat views. */
async function picture(page: Page): Promise<Locator> {
  await page.getByRole("button", { name: "3D view" }).click();
  const view = page.getByRole("application", { name: "Spine in three dimensions" });
  await expect(view.getByText(/^Seen /)).toBeVisible();
  await steady(page, view);
  return view;
}

/** Waits until two consecutive screenshots are equal. */
async function steady(page: Page, view: Locator): Promise<Buffer> {
  let last = await view.screenshot();
  for (let tries = 0; tries < 40; tries += 1) {
    await page.waitForTimeout(150);
    const next = await view.screenshot();
    if (next.equals(last)) return next;
    last = next;
  }
  throw new Error("the picture does not stop changing");
}

/** Number of pixels near each of some colours, `#rrggbb`. */
async function pixelsNear(page: Page, png: Buffer, colours: string[]): Promise<number[]> {
  return page.evaluate(
    async ({ base64, colours }) => {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext("2d");
      if (!context) throw new Error("no canvas");
      context.drawImage(image, 0, 0);
      const { data } = context.getImageData(0, 0, image.width, image.height);
      return colours.map((colour) => {
        const [r = 0, g = 0, b = 0] = [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
        let near = 0;
        for (let i = 0; i < data.length; i += 4) {
          const away =
            Math.abs(data[i]! - r) + Math.abs(data[i + 1]! - g) + Math.abs(data[i + 2]! - b);
          if (away < 60) near += 1;
        }
        return near;
      });
    },
    { base64: png.toString("base64"), colours },
  );
}

const BACKGROUND = "#0c1116";
const INFLECTION = "#e69f00";
const ESTIMATED = "#5fd0a5";
const FORCE = "#ff8a80";
const STIFF = "#f0f921";

test("a model is drawn, with its stiffness, its line and its force", async ({ app, page }) => {
  await openModel(app, page);
  const view = await picture(page);
  const seen = await steady(page, view);
  const [empty, line, force, stiff] = await pixelsNear(page, seen, [
    BACKGROUND,
    INFLECTION,
    FORCE,
    STIFF,
  ]);
  const box = await view.boundingBox();
  expect(empty).toBeLessThan(0.97 * box!.width * box!.height);
  expect(line).toBeGreaterThan(200);
  expect(force).toBeGreaterThan(150);
  expect(stiff).toBeGreaterThan(100);

  await expect(page.getByText("Synthetic films: no patient")).toBeVisible();
  await expect(view.getByText("Seen from behind")).toBeVisible();
  await expect(view.getByText("100 mm at the spine")).toBeVisible();
  // Contradictions come before the numbers.
  const findings = page.getByRole("complementary", { name: "Findings" });
  const words = await findings.innerText();
  expect(words).toContain("1 contradiction, 1 warning");
  expect(words.indexOf("Contradiction")).toBeLessThan(words.indexOf("1.6 mm"));
  for (const verdict of ["Ratio only", "Contradicted", "At a bound"]) {
    await expect(findings.getByText(verdict, { exact: true })).toBeVisible();
  }
  expect(words.match(/only ratios are known/g)!.length).toBeGreaterThanOrEqual(3);
  await expectAccessible(page);
  await shot(page, "model-left-bending");
});

test("without a lateral film the model opens in flat views, and says what is assumed", async ({
  app,
  page,
}) => {
  await openModel(app, page);
  const assumed = page.getByText("Depth and arches are assumed: no lateral film was measured.");
  const sagittal = page.getByRole("img", { name: /^Sagittal/ });
  await expect(sagittal).toBeVisible();
  await expect(page.getByRole("application")).toHaveCount(0);
  // Both spines are dotted in the sagittal view alone.
  const outlines = sagittal.locator(".simulated polygon");
  await expect(outlines).toHaveCount(15);
  await expect(sagittal.locator(".simulated polygon.assumed")).toHaveCount(15);
  await expect(page.locator("polygon.assumed")).toHaveCount(30);
  await expect(page.getByText("assumed pitch")).toBeVisible();
  // What needs the 3D view is not offered.
  await expect(page.getByRole("button", { name: "Side by side" })).toHaveCount(0);
  await onPhoneAndComputer(page, "model-flat", () => expectReadable(assumed));
  await page.getByRole("button", { name: "Load by hand" }).click();
  await expect(
    page.getByText("Fill in the fields, or drag the ring at T7 in the 3D view."),
  ).toBeVisible();
  await page.getByRole("button", { name: /^Left bending/ }).click();

  await picture(page);
  await expectReadable(assumed);
  await expect(page.getByText("assumed pitch")).toHaveCount(0);
  await page.getByRole("button", { name: "Side by side" }).click();
  // Flat views draw both spines over each other.
  await page.getByRole("button", { name: "Flat views" }).click();
  await expect(sagittal).toBeVisible();
  await expect(page.getByRole("button", { name: "Overlaid" })).toHaveAttribute(
    "aria-pressed",
    "true",
  );
});

test("a lateral film that shows a part of the spine leaves the rest assumed", async ({
  app,
  page,
}) => {
  const view = modelView();
  const pitch_from = view.bodies.map(({ level }) =>
    /^T[2-5]$/.test(level) ? ("population" as const) : ("lateral_film" as const),
  );
  await openModel(app, page, { ...view, pitch_from });
  await expect(page.getByRole("application")).toBeVisible();
  for (const width of [390, 1280]) {
    await page.setViewportSize({ width, height: 800 });
    await expectReadable(
      page.getByText("The pitch of T2 to T5 is assumed: the lateral film does not show them."),
    );
  }
  await page.getByRole("button", { name: "Flat views" }).click();
  const assumed = page.getByRole("img", { name: /^Sagittal/ }).locator(".simulated .assumed");
  await expect(assumed).toHaveCount(4);
  await shot(page, "model-flat-partly-assumed");
});

test("the demo's model is computed and drawn, and responds to a load", async ({ app, page }) => {
  await app.openDemo(page, "model");
  const view = await picture(page);
  const seen = await steady(page, view);
  const [line] = await pixelsNear(page, seen, [INFLECTION]);
  expect(line).toBeGreaterThan(100);
  await expect(page.getByText("Synthetic films: no patient")).toBeVisible();
  await expectAccessible(page);
  await shot(page, "model-of-the-demo");
  for (const film of [/^Right bending/, /^Neutral/, /^Traction/]) {
    await page.getByRole("button", { name: film }).click();
    expect((await steady(page, view)).equals(seen)).toBe(false);
  }
  await shot(page, "model-of-the-demo-traction");

  await page.getByRole("button", { name: "Load by hand" }).click();
  const rest = await steady(page, view);
  const tip = (await page.getByRole("button", { name: /Tip of the load on T7/ }).boundingBox())!;
  const [x, y] = [tip.x + tip.width / 2, tip.y + tip.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - 45, y, { steps: 20 });
  await page.mouse.up();
  // The picture did not move during the drag: the load is horizontal.
  await expect(page.getByLabel("Up or down, in rel. units")).toHaveValue("0");
  await expect(page.getByText(/^Equilibrium, reached/)).toBeVisible();
  expect((await steady(page, view)).equals(rest)).toBe(false);
  await shot(page, "model-of-the-demo-load");
});

test("the first view of the model matches its erect film", async ({ app, page }) => {
  await openModel(app, page, modelView(), "image_right");
  const view = await picture(page);
  await expect(view.getByText("Seen from the front")).toBeVisible();
  await page.getByRole("button", { name: "Left", exact: true }).click();
  await expect(view.getByText("Seen from the patient’s left")).toBeVisible();
  await steady(page, view);
  await shot(page, "model-from-the-left");
  await page.getByRole("button", { name: "Top", exact: true }).click();
  await expect(view.getByText("Seen from above")).toBeVisible();
  // The keyboard rotates it too.
  const before = await steady(page, view);
  await view.focus();
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("ArrowRight");
  await expect(page.getByText(/Seen oblique, mainly from above/)).toBeVisible();
  expect((await steady(page, view)).equals(before)).toBe(false);
});

test("another posture and another line change picture and texts", async ({ app, page }) => {
  await openModel(app, page);
  const view = await picture(page);
  const left = await steady(page, view);

  await page.getByRole("button", { name: /^Traction/ }).click();
  await expect(page.getByText("Not used in the fit: a test of the model.")).toBeVisible();
  await expect(page.getByRole("heading", { name: "Traction, inflection line" })).toBeVisible();
  expect((await steady(page, view)).equals(left)).toBe(false);
  await shot(page, "model-traction-held-out");

  await page.getByRole("button", { name: "Estimated line" }).click();
  await expect(page.getByRole("heading", { name: "Traction, estimated line" })).toBeVisible();
  const [estimated] = await pixelsNear(page, await steady(page, view), [ESTIMATED]);
  expect(estimated).toBeGreaterThan(200);

  await page.getByRole("button", { name: "Side by side" }).click();
  await expect(view.getByText("Measured on the film")).toBeVisible();
  await steady(page, view);
  await shot(page, "model-side-by-side");
});

test("held-out and fitted films are labelled", async ({ app, page }) => {
  await openModel(app, page);
  const postures = page.getByRole("group", { name: "Posture" });
  await expect(postures.getByRole("button", { name: "Left bending fitted" })).toBeVisible();
  await expect(postures.getByRole("button", { name: "Neutral held out" })).toBeVisible();
  const table = page.getByRole("table", { name: "The lines of action compared" });
  await expect(table.getByRole("row", { name: /Inflection line/ })).toContainText("1.6 mm");
  await expect(table.getByRole("row", { name: /Inflection line/ })).toContainText("3.4 mm");
});

test("a fit that did not converge is never shown as a result", async ({ app, page }) => {
  await openModel(app, page);
  await page.getByRole("button", { name: /^Iliac line/ }).click();
  await expect(page.getByText("Not a result.").first()).toBeVisible();
  const view = await picture(page);
  // Neither force nor colours of stiffness are shown.
  const [stiff] = await pixelsNear(page, await steady(page, view), [STIFF]);
  expect(stiff).toBe(0);
  await expect(view.getByText(/pull of/)).toHaveCount(0);
  await expect(
    page.getByRole("table", { name: "The lines of action compared" }).getByText(/Not a result/),
  ).toBeVisible();
  await expectAccessible(page);
  await shot(page, "model-not-a-result");
  // The same holds during a rotation, which is drawn in outlines without a graphics card.
  const box = (await view.boundingBox())!;
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 40, box.y + box.height / 2, { steps: 4 });
  const [turned] = await pixelsNear(page, await steady(page, view), [STIFF]);
  expect(turned).toBe(0);
  await shot(page, "model-not-a-result-turned");
  await page.mouse.up();
});

test("the force increases from 0 to 100 %, in steps with reduced motion", async ({ app, page }) => {
  await page.emulateMedia({ reducedMotion: "reduce" });
  await openModel(app, page);
  const view = await picture(page);
  const full = await steady(page, view);
  const slider = page.getByRole("slider", { name: "Part of the force" });
  await slider.focus();
  await page.keyboard.press("Home");
  await expect(page.getByText("0 %, erect")).toBeVisible();
  expect((await steady(page, view)).equals(full)).toBe(false);
  await page.getByRole("button", { name: "Play" }).click();
  await expect(page.getByText("100 %, simulated")).toBeVisible();
  await expect(page.getByRole("button", { name: "Play" })).toBeVisible();
  expect((await steady(page, view)).equals(full)).toBe(true);
});

test("a press on a joint shows its values, in the list too", async ({ app, page }) => {
  await openModel(app, page);
  await picture(page);
  const joint = page.getByRole("button", { name: "T8/T7" });
  await joint.focus();
  await page.keyboard.press("Enter");
  await expect(joint).toHaveAttribute("aria-pressed", "true");
  await expect(page.locator("[aria-live=polite]").getByText("T8/T7")).toBeVisible();
  await expect(page.getByText("counter-rotating: left bending")).toBeVisible();
  await shot(page, "model-joint");
});

test("the spine follows a dragged load", async ({ app, page }) => {
  await openModel(app, page);
  await page.getByRole("button", { name: "Load by hand" }).click();
  const view = await picture(page);
  const rest = await steady(page, view);
  const tip = page.getByRole("button", { name: /Tip of the load on T7/ });
  const box = (await tip.boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - 70, y, { steps: 15 });
  await expect(page.getByText(/^Equilibrium, reached/)).toBeVisible();
  // From behind, the left of the picture is the patient's left.
  await expect(
    page.getByText(/Relative force \d+ to the patient's left on T7 · largest/),
  ).toBeVisible();
  await page.mouse.up();
  expect((await steady(page, view)).equals(rest)).toBe(false);
  // The tip stays under the pointer.
  const moved = (await tip.boundingBox())!;
  expect(Math.abs(moved.x + moved.width / 2 - (x - 70))).toBeLessThan(2);
  const measures = await page.evaluate(
    () => performance.getEntriesByName("load: pointer to result").length,
  );
  expect(measures).toBeGreaterThan(0);
  await expectAccessible(page);
  await shot(page, "model-load");

  await page.mouse.move(x - 70, y);
  await page.mouse.down();
  await page.mouse.move(x - 300, y, { steps: 8 });
  await page.mouse.up();
  await expect(
    page.locator("strong", { hasText: /Not a result: .* The shape at \d+ % of the load is shown/ }),
  ).toBeVisible();
  await steady(page, view);
  await shot(page, "model-load-without-equilibrium");

  await page.getByRole("button", { name: "Reset" }).click();
  await expect(page.getByText(/Drag the ring at T7/)).toBeVisible();
  expect((await steady(page, view)).equals(rest)).toBe(true);
});

test("a load is applied by keyboard alone and announced", async ({ app, page }) => {
  await openModel(app, page);
  await page.getByRole("button", { name: "Load by hand" }).press("Enter");
  await picture(page);
  await page.getByRole("combobox", { name: "Load on" }).selectOption("T2");
  const tip = page.getByRole("button", { name: /Tip of the load on T2/ });
  await tip.focus();
  await page.keyboard.press("Shift+ArrowLeft");
  await page.keyboard.press("Shift+ArrowLeft");
  const spoken = page.locator("[aria-live=polite]").filter({ hasText: "T2" });
  await expect(spoken).toContainText("Relative force 20 to the patient's left on T2; Equilibrium");
  await expect(page.getByLabel("Sideways, in rel. units")).toHaveValue("20");

  await page.getByLabel("Sideways: direction").selectOption("patient’s right");
  await expect(page.getByText(/Relative force 20 to the patient's right on T2 ·/)).toBeVisible();
  await page.getByLabel("Sideways, in rel. units").fill("35");
  await page.getByLabel("Sideways, in rel. units").press("Enter");
  await expect(page.getByText(/Relative force 35 to the patient's right on T2 ·/)).toBeVisible();
});

test("intervals are computed in the background, and can be cancelled", async ({ app, page }) => {
  await openModel(app, page);
  const asked: string[] = [];
  let done = 0;
  await page.route("**/api/studies/phantom-rod-01/computations/replicates", (route) => {
    const method = route.request().method();
    asked.push(method);
    if (method === "DELETE")
      return route.fulfill({ json: { ...replicates(0), state: "cancelled" } });
    return route.fulfill({ json: replicates(asked.includes("POST") ? done : 0) });
  });
  done = 80;
  await page.getByRole("button", { name: "Compute 200 replicates" }).click();
  await expect(page.getByText("80 of 200 replicates")).toBeVisible();
  await page.getByRole("button", { name: "Cancel" }).click();
  await expect(page.getByText(/^Cancelled\./)).toBeVisible();
  expect(asked).toContain("DELETE");
  done = 200;
  await page.getByRole("button", { name: "Compute 200 replicates" }).click();
  await expect(page.getByRole("cell", { name: "46.9° to 49.6°" })).toBeVisible();
  await expectAccessible(page);
});

test("the whole page is usable on a tablet", async ({ app, page }) => {
  await page.setViewportSize({ width: 1024, height: 768 });
  await openModel(app, page);
  const view = await picture(page);
  await steady(page, view);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  expect(wide).toBeLessThanOrEqual(1024);
  await shot(page, "model-tablet");
  await page.getByRole("button", { name: "Load by hand" }).click();
  await steady(page, view);
  await shot(page, "model-tablet-load");
});

test("without WebGL the model is shown in two dimensions with a message", async ({ app }) => {
  const browser = await chromium.launch({
    executablePath: BROWSER,
    env: ENVIRONMENT,
    args: ["--no-sandbox", "--disable-3d-apis", "--disable-quic"],
  });
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  const page = await context.newPage();
  await openModel(app, page);
  await page.getByRole("button", { name: "3D view" }).click();
  await expect(page.getByText(/cannot draw in 3D/)).toBeVisible();
  const frontal = page.getByRole("img", { name: /^Frontal, seen from behind/ });
  await expect(frontal).toBeVisible();
  await expect(page.getByRole("img", { name: /^Sagittal/ })).toBeVisible();
  const before = await frontal.innerHTML();
  await page.getByRole("button", { name: /^Right bending/ }).click();
  expect(await frontal.innerHTML()).not.toBe(before);
  await shot(page, "model-without-webgl");
  await page.getByRole("button", { name: "Load by hand" }).click();
  await expect(page.getByText("Fill in the fields.", { exact: true })).toBeVisible();
  await page.getByLabel("Sideways, in rel. units").fill("40");
  await page.getByLabel("Sideways, in rel. units").press("Enter");
  await expect(page.getByText(/^Equilibrium, reached/)).toBeVisible();
  await expectAccessible(page);
  await shot(page, "model-without-webgl-load");
  await browser.close();
});
