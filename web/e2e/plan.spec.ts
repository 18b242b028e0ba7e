import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";

import type { Download, Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import { DEMO, expect, expectAccessible, runProgram, shot, test, type App } from "./app";

test.use({ hasDemo: true });

/** Opens the page of loads of the demo. */
async function openPlan(app: App, page: Page): Promise<void> {
  await app.openDemo(page, "model");
  await page.getByRole("link", { name: "Plan of loads" }).click();
  await expect(page.getByRole("heading", { level: 1, name: /^Loads on/ })).toBeVisible();
  await expect(page.getByText(/^Research only: /)).toBeVisible();
}

async function saved(download: Promise<Download>, folder: string): Promise<string> {
  const file = await download;
  const place = path.join(folder, file.suggestedFilename());
  await file.saveAs(place);
  return place;
}

/** The files that the page saves of a plan, with their paths. */
async function savedFiles(app: App, page: Page) {
  const take = async (name: string) => {
    const download = page.waitForEvent("download");
    await page.getByRole("button", { name }).click();
    return saved(download, app.folder);
  };
  return {
    loads: await take("Save loads"),
    simulation: await take("Save simulation"),
    model: await take("Save model"),
  };
}

const table = (page: Page, name: string) => page.getByRole("group", { name, exact: true });

test("loads are added, edited by keyboard and in the picture, undone, and kept over a reload", async ({
  app,
  page,
}) => {
  await openPlan(app, page);
  await expectAccessible(page);
  await page.getByRole("button", { name: "Pad", exact: true }).press("Enter");
  const angles = table(page, "Angles and place");
  await expect(angles.getByRole("row", { name: /^Cobb, main thoracic/i })).toBeVisible();
  await expect(angles.getByText("research only")).toBeVisible();
  await expect(page.getByText(/^CONVERGED · /)).toBeVisible();

  const fields = page.getByRole("group", { name: "Fields of load 1" });
  const before = await angles.innerText();
  await fields.getByLabel("Displacement").fill("35");
  await expect.poll(() => angles.innerText()).not.toBe(before);
  await expect(page.getByText(/pad on T\d+: 35/i)).toBeVisible();

  // By a press in the picture.
  await page.getByRole("button", { name: "Load 1 on T6" }).click();
  await expect(fields.getByRole("combobox", { name: "Vertebra", exact: true })).toHaveValue("T6");
  await page.getByRole("button", { name: "Towards the patient’s right" }).click();
  await expect(fields.getByLabel("Pushes to the")).toHaveValue("right");
  await expect(page.getByText(/pad on T6: 35\.0 mm to the right/i)).toBeVisible();
  await shot(page, "plan-pad");
  await expectAccessible(page);

  await page.getByRole("button", { name: "Undo" }).click();
  await expect(fields.getByLabel("Pushes to the")).not.toHaveValue("right");
  await page.getByRole("button", { name: "Redo" }).click();
  await expect(fields.getByLabel("Pushes to the")).toHaveValue("right");

  await page.getByRole("button", { name: "Weight" }).click();
  await expect(
    page.getByText(/weight of trunk, head and arms of a body with the weight 20/i),
  ).toBeVisible();
  await page.reload();
  await expect(page.getByText(/pad on T6: 35\.0 mm to the right/i)).toBeVisible();
  await expect(
    page.getByText(/weight of trunk, head and arms of a body with the weight 20/i),
  ).toBeVisible();
  await page.getByRole("button", { name: "Remove load 1" }).click();
  await expect(page.getByText(/pad on T6/i)).toHaveCount(0);
});

test("a fault stands beside its load, and loads that snap the spine end by name", async ({
  app,
  page,
}) => {
  await openPlan(app, page);
  await page.getByRole("button", { name: "Rod", exact: true }).click();
  const fields = page.getByRole("group", { name: "Fields of load 1" });
  await expect(page.getByText(/^CONVERGED · /)).toBeVisible();
  await fields.getByLabel("Lower vertebra").selectOption("T2");
  const load = page.getByRole("listitem").filter({ has: fields });
  await expect(load.getByText(/a rod needs a lower and an upper vertebra/)).toBeVisible();
  await expect(page.getByText("1 load cannot be applied: see the list of loads.")).toBeVisible();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Remove all" }).click();

  await page.getByRole("button", { name: "Traction", exact: true }).first().click();
  await page.getByLabel("Force, up or down: direction").selectOption("down");
  await page.getByLabel(/^Force, up or down, in/).fill("9000");
  await expect(page.getByText(/NO RESULT/).first()).toBeVisible();
  await expect(page.getByText("on the way: not the result")).toBeVisible();
  await expect(table(page, "Angles and place")).toHaveCount(0);
  await shot(page, "plan-no-result");
  await expectAccessible(page);
});

test("the saved files give the command line the same simulation", async ({ app, page }) => {
  await openPlan(app, page);
  await page.getByRole("button", { name: "Pad", exact: true }).click();
  await page.getByRole("button", { name: "Strap", exact: true }).click();
  await page.getByRole("button", { name: "Traction", exact: true }).first().click();
  await expect(page.getByText(/^CONVERGED · /)).toBeVisible();
  const { loads, simulation, model } = await savedFiles(app, page);
  const own = path.join(app.folder, "own.json");
  await runProgram("simulate", model, "--load", loads, "--json", own);
  const parsed = async (file: string) => {
    const { provenance, ...rest } = JSON.parse(await readFile(file, "utf8")) as {
      provenance: unknown;
    };
    expect(provenance).toBeTruthy();
    return JSON.stringify(rest);
  };
  expect(await parsed(simulation)).toBe(await parsed(own));

  // The file is opened again, and a file of another kind changes nothing.
  await page.getByRole("button", { name: "Remove all" }).click();
  await expect(page.getByText("No loads yet.")).toBeVisible();
  const bad = path.join(app.folder, "bad.json");
  await writeFile(
    bad,
    '{ "format": "spineline-load", "version": 1, "loads": [{ "kind": "padd" }] }',
  );
  await page.getByLabel("Load file").setInputFiles(bad);
  await expect(page.getByText(/unknown name `padd`/)).toBeVisible();
  await page.getByLabel("Load file").setInputFiles(loads);
  await expect(page.getByRole("button", { name: /^Remove load/ })).toHaveCount(3);
  await expect(page.getByText(/strap on T\d+: shortened by 10 mm/i)).toBeVisible();
});

test("the path is a slider, and the traction film is compared with its prediction", async ({
  app,
  page,
}) => {
  await openPlan(app, page);
  const films = page.getByRole("group", { name: "Add a load" });
  await films
    .getByRole("button", { name: /^Traction/ })
    .last()
    .click();
  await expect(page.getByText("measured: traction")).toBeVisible();
  await expect(page.getByLabel("Beside the film")).toHaveValue("traction");
  await expect(page.getByText(/Mean distance of the midpoints/)).toBeVisible();
  const slider = page.getByRole("slider", { name: "Load path" });
  await expect(page.getByText("All loads: the result")).toBeVisible();
  await slider.focus();
  await page.keyboard.press("Home");
  await expect(page.getByText("0 % of the proportional loads")).toBeVisible();
  await expect(page.getByText("on the way: not the result")).toBeVisible();
  await page.keyboard.press("End");
  await expect(page.getByText("under the loads", { exact: true })).toBeVisible();
  await shot(page, "plan-traction");
  await expectAccessible(page);
  await page.getByRole("button", { name: "3D", exact: true }).click();
  const space = page.getByRole("application", { name: "Spine in three dimensions" });
  await expect(space.getByText("Seen from behind")).toBeVisible();
  await expect(page.getByText(/^Depth and arches are assumed/)).toBeVisible();
  await expect(
    page.getByText(/^Spine before and under the loads, seen from behind/),
  ).toBeAttached();
  await expectAccessible(page);
  // Drawn in full after a rest.
  await page.waitForTimeout(1500);
  await shot(page, "plan-3d");
});

test("one pad is tried everywhere, and a press on a cell adds it", async ({ app, page }) => {
  await openPlan(app, page);
  await page.getByRole("button", { name: "Try one pad everywhere" }).click();
  const map = page.getByRole("group", { name: "Map of pads" });
  await expect(map).toBeVisible();
  const cell = map.getByRole("button", { name: /^20 to the patient's right on T8/ });
  const title = (await cell.getAttribute("title")) ?? "";
  await cell.click();
  await expect(page.getByText(/pad on T8:/i)).toBeVisible();
  const after = / ([\d.]+)° instead of/.exec(title)?.[1] ?? "no number";
  await expect(table(page, "Angles and place").getByText(`${after}°`).first()).toBeVisible();
  await map.scrollIntoViewIfNeeded();
  await shot(page, "plan-map");

  // A second pad beside the first one.
  await expect(page.getByLabel("Beside the loads of the plan")).toBeChecked();
  await page.getByRole("button", { name: "Try one pad everywhere" }).click();
  await expect(page.getByText(/beside the one load that the plan had/)).toBeVisible();
  const second = map.getByRole("button", { name: /^10 to the patient's left on T4/ });
  const both = / ([\d.]+)° instead of/.exec((await second.getAttribute("title")) ?? "")?.[1];
  expect(both).not.toBe(after);
  await second.click();
  await expect(table(page, "Angles and place").getByText(`${both}°`).first()).toBeVisible();
  await map.scrollIntoViewIfNeeded();
  await shot(page, "plan-map-beside");
  await expectAccessible(page);
});

/** A map with a correction, a growth and a pad without a result. */
function padMap(state: Api<"ComputationState">): Api<"PadMapView"> {
  const [done, asked] = [state === "done" ? 2 : 1, 2];
  const empty = { state, done, asked, largest_force: 40, columns: [], rows: [], texts: [] };
  if (state !== "done") return empty;
  const why = "40 to the patient's left on T9: no result; the path has a limit point";
  const cell = { text: "−1.5°", title: "40 to the patient's right on T9", part: -1, load: null };
  return {
    ...empty,
    columns: [
      { towards: "right", force: "40" },
      { towards: "left", force: "40" },
    ],
    rows: [
      { level: "T9", cells: [cell, { ...cell, text: "limit point", title: why, part: null }] },
    ],
    texts: ["1 of 2 pads have no result; their cells name the ending."],
  };
}

test("the trials show their progress, can be cancelled, and name their failures", async ({
  app,
  page,
}) => {
  await openPlan(app, page);
  let state: Api<"ComputationState"> = "running";
  await page.route("**/pad-map", (route) => {
    if (route.request().method() === "DELETE") state = "cancelled";
    return route.fulfill({ json: padMap(state) });
  });
  await page.getByRole("button", { name: "Try one pad everywhere" }).click();
  await expect(page.getByText("1 of 2 pads")).toBeVisible();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Cancel" }).click();
  await expect(page.getByText("Cancelled.")).toBeVisible();
  await expect(page.getByRole("group", { name: "Map of pads" })).toHaveCount(0);
  state = "done";
  await page.getByRole("button", { name: "Try one pad everywhere" }).click();
  await expect(page.getByRole("cell", { name: "limit point" })).toBeVisible();
  await expect(page.getByText("1 of 2 pads have no result")).toBeVisible();
});

test(
  "intervals belong to their loads, and equal the command line's",
  { tag: "@long" },
  async ({ app, page }) => {
    await openPlan(app, page);
    await page.getByRole("button", { name: "Pad", exact: true }).press("Enter");
    await expect(page.getByText(/^CONVERGED · /)).toBeVisible();
    const angles = table(page, "Angles and place");
    const cobb = angles.getByRole("row", { name: /^Cobb, main thoracic/i });
    await expect(cobb.getByText(", 95 % interval")).toHaveCount(0);
    const begin = page.getByRole("button", { name: "Compute 200 replicates" });
    await begin.press("Enter");
    await expect(page.getByText(/of 200 replicates$/)).toBeVisible();
    await expect(cobb.getByText(", 95 % interval")).toHaveCount(3, { timeout: 120_000 });
    await expect(page.getByText(/do not cover the errors of the model/)).toBeVisible();
    await expect(page.getByText(/with a result, \d+ of 200 \(seed 1\)/)).toBeVisible();
    await angles.scrollIntoViewIfNeeded();
    await shot(page, "plan-intervals");
    await expectAccessible(page);

    // The command line gives the same numbers from the saved files.
    const { loads, simulation, model } = await savedFiles(app, page);
    const { origin } = new URL(page.url());
    const made = await page.request.get(`${origin}/api/studies/${DEMO}/exports/analysis`);
    const analysis = path.join(app.folder, "analysis.json");
    await writeFile(analysis, await made.body());
    const own = path.join(app.folder, "own.json");
    const replicates = ["--case", analysis, "--replicates", "200", "--json", own];
    await runProgram("simulate", model, "--load", loads, ...replicates);
    const found = async (file: string) =>
      (JSON.parse(await readFile(file, "utf8")) as { uncertainty: unknown }).uncertainty;
    expect(await found(simulation)).toEqual(await found(own));

    // With other loads, intervals are hidden, until an undo restores these.
    await page
      .getByRole("group", { name: "Fields of load 1" })
      .getByLabel("Displacement")
      .fill("12");
    await expect(page.getByText(/^The loads have changed: the computed intervals/)).toBeVisible();
    await expect(angles.getByText(", 95 % interval")).toHaveCount(0);
    await expect(page.getByText(/do not cover the errors of the model/)).toHaveCount(0);
    await expect(page.getByText(/: 12\.0 mm to the left/)).toBeVisible();
    await expect(angles.getByText(", 95 % interval")).toHaveCount(0);
    await shot(page, "plan-intervals-outdated");
    await expectAccessible(page);
    await page.getByRole("button", { name: "Undo" }).click();
    await expect(cobb.getByText(", 95 % interval")).toHaveCount(3);
    await page.reload();
    await expect(cobb.getByText(", 95 % interval")).toHaveCount(3);

    await page.emulateMedia({ colorScheme: "light" });
    await page.setViewportSize({ width: 390, height: 844 });
    await angles.scrollIntoViewIfNeeded();
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    expect(wide).toBeLessThanOrEqual(390);
    await shot(page, "plan-intervals-phone");
    await expectAccessible(page);
  },
);

test("replicates under loads show their progress, can be cancelled, and count failures", async ({
  app,
  page,
}) => {
  await openPlan(app, page);
  let view: Api<"LoadIntervalsView"> = {
    state: "none",
    done: 0,
    asked: 0,
    file: "",
    rows: [],
    texts: [],
  };
  await page.route("**/intervals", async (route) => {
    const method = route.request().method();
    if (method === "POST") {
      const { file } = route.request().postDataJSON() as Api<"LoadIntervalRequest">;
      const isDone = view.state === "cancelled";
      view = { ...view, file, state: isDone ? "done" : "running", done: 3, asked: 200 };
      if (isDone) view.texts = ["Without a result, and in no interval: `branch_point` in 3 of 200"];
    }
    if (method === "DELETE") view = { ...view, state: "cancelled" };
    await route.fulfill({ json: view });
  });
  await page.getByRole("button", { name: "Pad", exact: true }).click();
  const begin = page.getByRole("button", { name: "Compute 200 replicates" });
  await begin.click();
  await expect(page.getByText("3 of 200 replicates")).toBeVisible();
  await expectAccessible(page);
  await page.getByRole("group", { name: "Fields of load 1" }).getByLabel("Displacement").fill("12");
  await expect(page.getByText("3 of 200 replicates, for the loads as they were")).toBeVisible();
  await page.getByRole("button", { name: "Cancel" }).click();
  await expect(page.getByText(/^Cancelled\. Every replicate/)).toBeVisible();
  await begin.click();
  await expect(page.getByText("`branch_point` in 3 of 200")).toBeVisible();
});

test(
  "the whole page is usable on a phone and in the light theme",
  { tag: "@long" },
  async ({ app, page }) => {
    await page.emulateMedia({ colorScheme: "light" });
    await page.setViewportSize({ width: 390, height: 844 });
    await openPlan(app, page);
    await page.getByRole("button", { name: "Pad", exact: true }).click();
    await expect(page.getByText(/^CONVERGED · /)).toBeVisible();
    await page.getByRole("button", { name: "Try one pad everywhere" }).click();
    await expect(page.getByRole("group", { name: "Map of pads" })).toBeVisible();
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    expect(wide).toBeLessThanOrEqual(390);
    await expectAccessible(page);
    await page.locator("main").evaluate((main) => main.scrollTo(0, 0));
    await shot(page, "plan-phone-light");
    await page.setViewportSize({ width: 1280, height: 800 });
    await shot(page, "plan-light");
    await expectAccessible(page);
  },
);
