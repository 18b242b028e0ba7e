import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";

import type { Page } from "@playwright/test";

import { enterSide, expect, expectAccessible, runProgram, shot, test, usePages } from "./app";
import { startArchive } from "./archive";
import { EVIL, expectHarmless } from "./hostile";
import { answerWith, manyStudies, study } from "./made";
import { POSTURES } from "./postures";
import { requestsElsewhere } from "./wire";

const CASE = "phantom-rod-01";

let phantom = "";

test.describe("with films of one phantom", () => {
  test.describe.configure({ mode: "serial", timeout: 240_000 });

  test.beforeAll(async () => {
    phantom = await mkdtemp(path.join(tmpdir(), "spineline-phantom-"));
    const options = ["--scenario", "rod", "--subject", "1", "--films", "--pixel-size", "2"];
    await runProgram("phantom", ...options, "--out", phantom);
    await writeFile(path.join(phantom, "garbage.dcm"), "this is not a picture\n".repeat(400));
  });

  test.afterAll(() => rm(phantom, { recursive: true, force: true }));

  const films = (): string[] =>
    POSTURES.map((posture) => path.join(phantom, `${CASE}-${posture}.dcm`));

  test("five DICOM files and one invalid file give a study of five films", async ({
    app,
    page,
  }) => {
    await app.open(page);
    await page.getByRole("link", { name: "New study" }).first().click();
    await shot(page, "new-study");
    const files = [...films(), path.join(phantom, "garbage.dcm")];
    await page.locator("input[type=file]").setInputFiles(files);
    await expect(page.getByRole("article")).toHaveCount(6);
    await expect(page.getByText("Synthetic", { exact: true })).toHaveCount(5, { timeout: 120_000 });
    const refused = page.getByRole("article").filter({ hasText: "garbage.dcm" });
    await expect(refused.getByRole("alert")).toBeVisible();
    await shot(page, "new-study-garbage");
    await refused.getByRole("button", { name: /remove/i }).click();

    // Values of the files are filled in; a missing side is not assumed.
    for (const posture of POSTURES) {
      const film = page.getByRole("article", { name: `${CASE}-${posture}.dcm` });
      await expect(film.getByLabel("Posture")).toHaveValue(posture);
      await enterSide(film);
    }
    await page.getByRole("textbox", { name: "Identifier" }).fill("first-study");
    await page.getByRole("textbox", { name: /label/i }).fill("five films of a phantom");
    await shot(page, "new-study-confirm");
    await page.getByRole("button", { name: "Create the study" }).click();
    await expect(page).toHaveURL(/#\/studies\/first-study\/measure/, { timeout: 60_000 });

    await page.getByRole("link", { name: "Studies", exact: true }).click();
    const row = page.getByRole("article").filter({ hasText: "first-study" });
    await expect(row.getByText("five films of a phantom")).toBeVisible();
    await expect(row.getByText("Synthetic", { exact: true })).toBeVisible();
    await expectThumbnails(page, 5);
    await shot(page, "studies");
  });

  test("a film of a leg is added only when confirmed", async ({ app, page }) => {
    const [erect = ""] = films();
    const bytes = await readFile(erect);
    bytes.write("LEG   ", bytes.indexOf("SPINE "), "latin1");
    const leg = path.join(phantom, "leg.dcm");
    await writeFile(leg, bytes);
    await app.open(page);
    await page.getByRole("link", { name: "New study" }).first().click();
    await page.locator("input[type=file]").setInputFiles([leg]);
    const film = page.getByRole("article", { name: "leg.dcm" });
    await expect(film.getByText("another part of the body")).toBeVisible({ timeout: 60_000 });
    await film.getByLabel("Posture").selectOption("erect");
    await film.getByRole("radio", { name: "right of the picture" }).check();
    await page.getByRole("textbox", { name: "Identifier" }).fill("a-leg");
    await page.getByRole("button", { name: "Create the study" }).click();
    const refused = page.getByRole("alert").filter({ hasText: "The study was not created" });
    await expect(refused).toContainText("another part of the body (LEG)");
    await shot(page, "new-study-doubtful");
    await refused.getByRole("button", { name: "Add anyway" }).click();
    await expect(page).toHaveURL(/#\/studies\/a-leg\/measure/, { timeout: 60_000 });
  });

  test("films are added to a study, each posture and each picture once", async ({ app, page }) => {
    const [erect = "", left = ""] = films();
    const confirm = async (file: string, posture: string): Promise<void> => {
      await page.locator("input[type=file]").setInputFiles([file]);
      const film = page.getByRole("article", { name: path.basename(file) });
      await film.getByLabel("Posture").selectOption(posture, { timeout: 60_000 });
      await enterSide(film);
    };
    await app.open(page);
    await page.getByRole("link", { name: "New study" }).first().click();
    await confirm(erect, "erect");
    await page.getByRole("textbox", { name: "Identifier" }).fill("growing");
    await page.getByRole("button", { name: "Create the study" }).click();
    // Nobody has read the film: its side and its scale can be corrected in one dialog.
    await page.getByRole("button", { name: "Edit this film…" }).click({ timeout: 60_000 });
    const edit = page.getByRole("dialog", { name: "Edit this film" });
    await edit.getByRole("radio", { name: "left of the picture" }).check();
    await edit.getByRole("checkbox", { name: "Enter another scale" }).check();
    await expect(edit.getByRole("button", { name: "Change the film" })).toBeDisabled();
    for (const name of ["between columns, mm", "between rows, mm"])
      await edit.getByLabel(name).fill("0.25");
    await edit.getByRole("combobox", { name: /^plane/ }).selectOption("patient");
    await expectAccessible(page);
    await shot(page, "edit-film");
    await edit.getByRole("button", { name: "Change the film" }).click();
    await expect(edit).toBeHidden();
    await expect(page.getByTestId("spacing")).toContainText("0.250 × 0.250 mm");
    await page.getByRole("link", { name: "Add films…" }).click();
    await expect(page.getByRole("heading", { name: "Add films to growing" })).toBeVisible();
    await expectAccessible(page);
    await confirm(erect, "erect");
    await expect(page.getByText("Erect is chosen for another film too")).toBeVisible();
    const film = page.getByRole("article", { name: path.basename(erect) });
    await film.getByLabel("Posture").selectOption("neutral");
    await page.getByRole("button", { name: "Add the films" }).click();
    const refused = page.getByRole("alert").filter({ hasText: "The films were not added" });
    await expect(refused).toContainText("are the same picture", { timeout: 60_000 });
    await film.getByRole("button", { name: /^Remove/ }).click();
    await confirm(left, "left_bending");
    await shot(page, "more-films");
    await page.getByRole("button", { name: "Add the films" }).click();
    await expect(page).toHaveURL(/#\/studies\/growing\/measure/, { timeout: 60_000 });
    await expect(page.getByRole("link", { name: /left bending/i })).toBeVisible();
  });

  test("a film of an archive is found by keyboard and becomes a study", async ({ app, page }) => {
    const { address, server, owner } = await startArchive(await readFile(films()[0] ?? ""));
    await app.kill();
    await app.start("--dicomweb", `clinic=${address}`);
    await app.openAt(page, "#/new");
    const section = page.getByRole("region", { name: "From an archive" });
    await section.getByLabel("Patient ID", { exact: true }).fill("locked");
    await page.keyboard.press("Enter");
    await expect(section.getByRole("alert")).toContainText("refuses the login of this program");
    await section.getByLabel("Patient ID", { exact: true }).fill("P-08");
    await page.keyboard.press("Enter");
    await expect(section.getByRole("status")).toContainText("no film for this Patient ID");
    await section.getByLabel("Patient ID", { exact: true }).fill(owner);
    await page.keyboard.press("Enter");
    await expect(section.getByRole("status")).toContainText("1 series is found");
    await section.getByRole("button", { name: "Show films" }).press("Enter");
    await section.getByRole("button", { name: /^Open\s+Film 2/ }).press("Enter");
    await expect(page.getByText("does not have this film")).toBeVisible();
    await section.getByRole("button", { name: /^Open\s+Film 1/ }).press("Enter");
    await expect(page.getByText("Synthetic", { exact: true })).toBeVisible({ timeout: 60_000 });
    for (const colorScheme of ["dark", "light"] as const) {
      await page.emulateMedia({ colorScheme });
      await expectAccessible(page);
      await shot(page, `archive-${colorScheme}`);
    }
    await page.setViewportSize({ width: 390, height: 844 });
    await section.scrollIntoViewIfNeeded();
    await expectAccessible(page);
    await shot(page, "archive-phone");
    expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(390);
    await page.setViewportSize({ width: 1280, height: 800 });
    await page
      .getByRole("button", { name: /^Remove/ })
      .first()
      .click();
    await page.getByLabel("Posture").selectOption("erect");
    await page.getByRole("radio", { name: "left of the picture" }).check();
    await page.getByRole("textbox", { name: "Identifier" }).fill("of-the-archive");
    await page.getByRole("button", { name: "Create the study" }).click();
    await expect(page).toHaveURL(/#\/studies\/of-the-archive\/measure/, { timeout: 60_000 });
    server.close();
  });

  test("a case file is imported with its films", async ({ app, page }) => {
    await app.open(page);
    await page.getByRole("link", { name: "Import a case file" }).first().click();
    await page.locator("input[type=file]").setInputFiles([path.join(phantom, `${CASE}.json`)]);
    await expect(page.getByText("missing: drop it here")).toHaveCount(5);
    await shot(page, "import-missing");
    await page.locator("input[type=file]").setInputFiles(films());
    await expect(page.getByText("All films are uploaded.")).toBeVisible({ timeout: 120_000 });
    await shot(page, "import-ready");
    await page.getByRole("button", { name: "Import", exact: true }).click();
    await expect(page).toHaveURL(new RegExp(`#/studies/${CASE}/measure`), { timeout: 60_000 });
    await page.getByRole("link", { name: "Studies", exact: true }).click();
    const exported = page.waitForEvent("download");
    await page.getByRole("link", { name: /Export case/ }).click();
    expect((await exported).suggestedFilename()).toMatch(/\.json$/);
  });
});

async function expectThumbnails(page: Page, count: number): Promise<void> {
  // The first display of a film decodes the whole file.
  const loaded = (): Promise<number> =>
    page
      .locator("article img")
      .evaluateAll((images) => images.filter((i) => (i as HTMLImageElement).naturalWidth).length);
  await expect.poll(loaded, { timeout: 60_000 }).toBe(count);
}

test("an empty store offers a demo with one click", async ({ app, page }) => {
  await app.open(page);
  await expect(page.getByRole("heading", { name: "No study yet" })).toBeVisible();
  await shot(page, "studies-empty");
  await page.getByRole("button", { name: "Open a demo" }).click();
  await expect(page.getByRole("dialog", { name: "A demo study" })).toBeVisible();
  await shot(page, "demo-drawing");
  await expect(page).toHaveURL(/#\/studies\/[^/]+\/measure/, { timeout: 110_000 });
  await page.getByRole("link", { name: "Studies", exact: true }).click();
  await expect(page.getByRole("article")).toHaveCount(1);
  await expect(page.getByRole("article").getByText("Synthetic", { exact: true })).toBeVisible();
  await expectThumbnails(page, 5);
  await shot(page, "studies-demo");
});

test("fifty studies are searched, sorted and opened by keyboard", async ({ app, page }) => {
  await answerWith(page, "/api/studies", manyStudies(50));
  await app.open(page);
  const rows = page.getByRole("article");
  await expect(rows).toHaveCount(50);
  await page.keyboard.press("/");
  await page.keyboard.type("thoracic convex");
  await expect(page.getByRole("status").filter({ hasText: "of 50 studies" })).toBeVisible();
  for (const text of await rows.allTextContents()) expect(text).toContain("main thoracic");
  await shot(page, "studies-search");

  // From the search to the first row, one down, one up, and open it.
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("ArrowUp");
  await expect(rows.first().locator(".open")).toBeFocused();
  const id = await rows.first().locator(".open").innerText();
  await page.keyboard.press("Enter");
  await expect(page).toHaveURL(new RegExp(`#/studies/${id}/measure`));
  // The address changes before the page does: going back earlier would find the old search.
  await expect(rows).toHaveCount(0);

  await page.goBack();
  await page.getByRole("combobox", { name: "Status" }).selectOption("Contradicted");
  await expect(rows).toHaveCount(6);
  await page.getByRole("combobox", { name: "Status" }).selectOption("All");
  await page.getByRole("combobox", { name: "Sort by" }).selectOption("Identifier");
  await expect(rows.first()).toContainText("S-001");
  await page.getByRole("searchbox").fill("missing study");
  await expect(page.getByRole("heading", { name: "No study matches" })).toBeVisible();
  await page.getByRole("button", { name: "Show all studies" }).click();
  await expect(rows).toHaveCount(50);
});

test("the list fits on a tablet", async ({ browser, app }) => {
  const context = await browser.newContext({
    viewport: { width: 1024, height: 768 },
    hasTouch: true,
  });
  const page = await context.newPage();
  await answerWith(page, "/api/studies", manyStudies(12));
  await app.open(page);
  await expect(page.getByRole("article")).toHaveCount(12);
  const overflow = () =>
    page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
  expect(await overflow()).toBe(0);
  await shot(page, "studies-tablet");
  await page.getByRole("link", { name: "New study" }).tap();
  await expect(page.getByRole("heading", { name: "New study" })).toBeVisible();
  expect(await overflow()).toBe(0);
  await context.close();
});

test("a list that cannot be loaded gives the reason and can be tried again", async ({
  app,
  page,
}) => {
  const problem = {
    code: "store",
    message: "the store studies.spineline is damaged at page 12",
    help: "put a backup in its place",
  };
  await answerWith(page, "/api/studies", problem, 500);
  await app.open(page);
  await expect(page.getByRole("alert")).toContainText("damaged at page 12");
  await expect(page.getByRole("alert")).toContainText(/put a backup/i);
  await shot(page, "studies-error");
  await page.unrouteAll();
  await usePages(page);
  await answerWith(page, "/api/studies", []);
  await page.getByRole("button", { name: "Try again" }).click();
  await expect(page.getByRole("heading", { name: "No study yet" })).toBeVisible();
});

test("hostile texts are shown as text and do not run", async ({ app, page }) => {
  const evil = study("S-1", {
    label: EVIL[0] ?? "",
    status_text: EVIL[1] ?? "",
    status: "measured",
    curve: {
      lenke: "1",
      size_deg: 40,
      is_cobb: true,
      region: "x",
      convex: "right",
      text: EVIL[2] ?? "",
    },
  });
  for (const film of evil.films)
    for (const reading of film.readings) reading.observer = EVIL[3] ?? "";
  await answerWith(page, "/api/studies", [evil]);
  await answerWith(page, "/api/cohort", {
    synthetic: false,
    rows: [
      {
        study: "S-1",
        synthetic: false,
        status: "measured",
        excluded: EVIL[0],
        cells: [{ heading: EVIL[1], text: EVIL[2], value: 1 }],
      },
    ],
    charts: [
      {
        title: EVIL[0],
        axis: EVIL[1],
        whiskers_text: EVIL[2],
        boxes: [{ label: EVIL[0], count: 1, five: [0, 1, 2, 3, 4], outliers: [9] }],
      },
    ],
    comparisons: [{ label: EVIL[0], pooled_text: EVIL[1], by_patient_text: EVIL[2] }],
    reliability: [],
    verdict: [EVIL[0]],
    notices: [{ severity: "warning", code: "x", posture: null, level: EVIL[1], text: EVIL[0] }],
  });
  await app.open(page);
  const row = page.getByRole("article");
  for (const text of EVIL) await expect(row).toContainText(text);
  await shot(page, "studies-escaped");
  await page.getByRole("link", { name: "Cohort" }).click();
  await expect(page.locator("svg.chart")).toBeVisible();
  await expect(page.locator("svg.chart")).toContainText(EVIL[1] ?? "");
  await expectHarmless(page);
});

test("no request leaves the machine", async ({ app, page }) => {
  const elsewhere = requestsElsewhere(page, app.address);
  await app.open(page);
  for (const place of ["#/new", "#/import", "#/cohort", "#/access", "#/studies"]) {
    await page.goto(new URL(place, app.address).href);
    await page.waitForLoadState("networkidle");
  }
  expect(elsewhere).toEqual([]);
});
