import type { Page } from "@playwright/test";

import { expect, test } from "../app";
import { print, spread } from "./table";

const MOVES = 360;
const MOVE_MS = 16;
const REACH_PX = 45;

test("a dragged load", async ({ app, page }) => {
  await app.open(page);
  const place = await openLoad(page);
  // The interception of requests takes time, and all pages are loaded.
  await page.unrouteAll();
  const { felt, answered } = await drag(page, place);
  expect(felt.length).toBeGreaterThan(20);
  print([
    spread("load: pointer move to picture", felt),
    spread("of that, the program's answer", answered),
  ]);
});

/** Opens the demo's model with a load by hand; returns the place of the handle. */
async function openLoad(page: Page): Promise<[number, number]> {
  await page.getByRole("button", { name: "Open a demo" }).first().click();
  await page.waitForURL(/#\/studies\/[^/]+\/measure/);
  const study = /#\/studies\/([^/]+)/.exec(page.url())?.[1];
  await page.evaluate((id) => (window.location.hash = `#/studies/${id}/model`), study);
  await page.getByRole("button", { name: "3D view" }).click();
  await page.getByRole("button", { name: "Load by hand" }).click();
  const handle = page.getByRole("button", { name: /^Tip of the load/ });
  await handle.waitFor();
  await page.waitForTimeout(2000);
  const box = await handle.boundingBox();
  if (!box) throw new Error("the handle is not on the screen");
  return [box.x + box.width / 2, box.y + box.height / 2];
}

/** Drags to both sides; the page measures the time to the frame with the answer. */
async function drag(
  page: Page,
  [x, y]: [number, number],
): Promise<{ felt: number[]; answered: number[] }> {
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let move = 1; move <= MOVES; move += 1) {
    const turn = (move / 60) * 2 * Math.PI;
    // No wait: a person does not wait either.
    void page.mouse.move(x - REACH_PX * Math.sin(turn), y + 0.3 * REACH_PX * Math.sin(2 * turn));
    await new Promise((resolve) => setTimeout(resolve, MOVE_MS));
  }
  await page.waitForTimeout(1000);
  const found = await page.evaluate(() => {
    const lasted = (entries: PerformanceEntryList): number[] =>
      entries.map(({ duration }) => duration);
    const asked = performance.getEntriesByType("resource");
    return {
      felt: lasted(performance.getEntriesByName("load: pointer to result")),
      answered: lasted(asked.filter(({ name }) => name.endsWith("/load"))),
    };
  });
  await page.mouse.up();
  return found;
}
