import type { Page } from "@playwright/test";

import { DEMO, expect, expectAccessible, expectReadable, shot, test } from "./app";
import { answerWith, cohort, manyStudies } from "./made";

test.use({ hasDemo: true });

/** A phone, a tablet, a small and a large screen. */
const SIZES = [
  [390, 844],
  [820, 1180],
  [1280, 720],
  [1920, 1080],
] as const;
const THEMES = ["light", "dark"] as const;

/** Every page, with a text that shows that it is loaded. */
const PAGES = [
  ["studies", "#/studies", "S-014"],
  ["new", "#/new", "New study"],
  ["import", "#/import", "Import a case file"],
  ["cohort", "#/cohort", "MDC95"],
  ["access", "#/access", "spineline account add"],
  ["measure", `#/studies/${DEMO}/measure`, "Rotation of segments from erect"],
  ["films", `#/studies/${DEMO}/films`, "mm (patient)"],
  ["model", `#/studies/${DEMO}/model`, "Which line explains the films?"],
  ["plan", `#/studies/${DEMO}/plan`, "The base is fixed"],
  ["evidence", `#/studies/${DEMO}/evidence`, "Mean location errors"],
] as const;

/** Elements that are wider than their place and scroll sideways, other than tables in their frames. */
async function tooWide(page: Page): Promise<string[]> {
  return page.evaluate(() => {
    const scrolls = (element: Element) =>
      element.scrollWidth > element.clientWidth + 1 &&
      ["auto", "scroll"].includes(getComputedStyle(element).overflowX) &&
      !element.matches(".table-box, .scroll");
    const found = [...document.querySelectorAll("body *")].filter(scrolls);
    const words = found.map((element) => element.outerHTML.slice(0, 90));
    return document.scrollingElement!.scrollWidth > innerWidth ? ["the window", ...words] : words;
  });
}

/** Elements that are too wide on any screen. axe checks the light theme here; the other tests check the dark one. */
async function lookAt(page: Page, name: string): Promise<string[]> {
  const wide: string[] = [];
  for (const [width, height] of SIZES) {
    await page.setViewportSize({ width, height });
    for (const part of await tooWide(page)) wide.push(`${name} at ${width}: ${part}`);
    for (const colorScheme of THEMES) {
      const isChecked = width === 390 && colorScheme === "light";
      if (!isChecked && !process.env.SPINELINE_SHOTS) continue;
      await page.emulateMedia({ colorScheme });
      if (isChecked) await expectAccessible(page);
      await shot(page, `look-${name}-${width}-${colorScheme}`);
    }
  }
  return wide;
}

test(
  "every page fits phones and large screens, in light and dark",
  { tag: "@long" },
  async ({ app, page }) => {
    await app.open(page);
    await answerWith(page, "/api/studies", manyStudies(14));
    await answerWith(page, "/api/cohort", cohort());
    const wide: string[] = [];
    for (const [name, address, sign] of PAGES) {
      await page.goto(new URL(address, app.address).href);
      await expect(page.getByText(sign).first()).toBeVisible({ timeout: 60_000 });
      await expect(page.getByText("Loading the film…")).toHaveCount(0);
      wide.push(...(await lookAt(page, name)));
    }
    await page.goto(new URL(`#/studies/${DEMO}/measure`, app.address).href);
    await page.setViewportSize({ width: 1280, height: 720 });
    await page.getByRole("button", { name: /^start marking/i }).click();
    await expect(page.getByTestId("target")).toContainText("L4", { timeout: 60_000 });
    // All tools and all levels are in view, and the next landmark is readable.
    await expectReadable(page.getByText("superior endplate, patient’s left"));
    await expect(page.getByRole("button", { name: "Full screen" })).toBeInViewport({ ratio: 1 });
    await expect(page.getByRole("button", { name: /^Crests/ })).toBeInViewport();
    wide.push(...(await lookAt(page, "marking")));
    await page.setViewportSize({ width: 390, height: 844 });
    await expect(page.getByText(/placed on a larger screen/)).toBeVisible();
    expect(wide).toEqual([]);
  },
);
