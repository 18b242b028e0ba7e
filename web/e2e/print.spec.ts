import { readFile } from "node:fs/promises";

import type { Page } from "@playwright/test";

import { DEMO, expect, expectAccessible, shot, test } from "./app";
import { answerWith, cohort } from "./made";
import { get } from "./wire";

test.use({ hasDemo: true });

const NO_DICOM = { code: "refused", message: "erect film: it is not a DICOM file", help: "…" };

/** Fails if a page on paper is dark, cut, or shows tools of the screen. */
async function expectPlainPaper(page: Page): Promise<void> {
  await page.emulateMedia({ media: "print" });
  const look = await page.evaluate(() => {
    const colours = ["html", "body", "main"].map(
      (name) => getComputedStyle(document.querySelector(name)!).backgroundColor,
    );
    const tools = [
      ...document.querySelectorAll("button, select, canvas, nav, [role=toolbar]"),
    ].filter((element) => !element.closest("th"));
    const isSeen = (element: Element) => element.getClientRects().length > 0;
    const main = document.querySelector("main")!;
    return {
      colours,
      ink: getComputedStyle(document.body).color,
      tools: tools.filter(isSeen).map((element) => element.outerHTML.slice(0, 80)),
      note: getComputedStyle(main, "::before").content,
      isCut: main.scrollHeight > main.clientHeight + 1,
    };
  });
  for (const colour of look.colours) {
    expect(["rgb(255, 255, 255)", "rgba(0, 0, 0, 0)"]).toContain(colour);
  }
  expect(look.ink).toBe("rgb(0, 0, 0)");
  expect(look.tools).toEqual([]);
  expect(look.note).toContain("in the report");
  expect(look.isCut).toBe(false);
}

/** Saves files from the menu of the model page, and gets an error for one that cannot be written. */
async function exportFiles(page: Page): Promise<void> {
  await page.getByRole("button", { name: "Export…" }).click();
  const dialog = page.getByRole("dialog", { name: "Export" });
  for (const [button, name, start] of [
    ["Landmarks for 3D Slicer", "demo-rod-01-slicer.zip", "PK"],
    ["OSIM", "demo-rod-01-inflection_line.osim", "<?xml"],
  ] as const) {
    const saved = page.waitForEvent("download");
    await dialog.getByRole("button", { name: button }).click();
    const file = await saved;
    expect(file.suggestedFilename()).toBe(name);
    const bytes = await readFile(await file.path());
    expect(bytes.subarray(0, start.length).toString()).toBe(start);
    await expect(dialog.getByRole("status")).toHaveText(`${button} is saved.`);
  }
  await answerWith(page, `/api/studies/${DEMO}/exports/dicom_sr`, NO_DICOM, 422);
  await dialog.getByRole("button", { name: "Landmarks as DICOM SR" }).click();
  await expect(dialog.getByText(NO_DICOM.message)).toBeVisible();
  await expectAccessible(page);
  await page.keyboard.press("Escape");
}

test(
  "Measure, Model and Cohort print plainly and lead to the report and other files",
  { tag: "@long" },
  async ({ app, page }) => {
    await app.openDemo(page);
    const link = page.getByRole("link", { name: "Report", exact: true });
    await expect(link).toBeVisible({ timeout: 120_000 });
    const saved = page.waitForEvent("download");
    await link.click();
    const file = await saved;
    expect(file.suggestedFilename()).toBe(`${DEMO}.html`);
    const text = await readFile(await file.path(), "utf8");
    expect(text).toMatch(/^<!DOCTYPE html>/);
    expect(text).toContain("Patient report");

    for (const place of ["measure", "model"]) {
      await page.emulateMedia({ media: "screen" });
      await page.goto(new URL(`#/studies/${DEMO}/${place}`, app.address).href);
      await expect(link).toBeVisible({ timeout: 60_000 });
      await expectPlainPaper(page);
      await shot(page, `print-${place}`);
      await page.emulateMedia({ media: "screen" });
    }
    await exportFiles(page);
    expect((await get(page, `/api/studies/${DEMO}/exports/report`)).status).toBe(200);
    await answerWith(page, "/api/cohort", cohort());
    await page.goto(new URL("#/cohort", app.address).href);
    await expect(page.getByRole("link", { name: /^Report of S-/ }).first()).toBeVisible();
    await expectPlainPaper(page);
    await expect(page.getByRole("columnheader", { name: "main Cobb (°)" })).toContainText("Cobb");
    await shot(page, "print-cohort");
  },
);
