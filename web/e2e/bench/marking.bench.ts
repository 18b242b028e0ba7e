import type { Page } from "@playwright/test";

test.use({ hasDemo: true });

import { test, type App } from "../app";
import { FilmPage, LEVELS, cornerOf } from "../marking";
import { print, spread } from "./table";

const MOVES = 150;

test("a dragged corner, and a killed program", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  await markAll(page, film);
  const drags = await dragged(page, film);
  const returns = await killed(app, page, film);
  print([
    spread("pointer move to findings, 15 vertebrae marked", drags.felt),
    spread("of that, the program's answer to a preview", drags.answered),
    spread("program started again to its address", returns.ready),
    spread("program started again to a click saved", returns.saved),
  ]);
});

/** Records all levels through the interface from another reading. */
async function markAll(page: Page, film: FilmPage): Promise<void> {
  const truth = await film.truth();
  const { revision } = await film.reading();
  await film.record(LEVELS, (level, corner) => cornerOf(truth, level, corner), revision);
  await page.reload();
  await film.painted();
  await page.getByTestId("curve").waitFor();
}

/** Drags a corner back and forth, one move per 30 ms; the page measures the time to the frame with the results. */
async function dragged(
  page: Page,
  film: FilmPage,
): Promise<{ felt: number[]; answered: number[] }> {
  await page.evaluate(() => performance.setResourceTimingBufferSize(2000));
  const [column, row] = cornerOf(await film.reading(), "T8", "superior_left");
  await page.mouse.move(...(await film.where([column, row])));
  await page.mouse.down();
  for (let i = 0; i < MOVES; i += 1) {
    await page.mouse.move(...(await film.where([column + 12 * Math.sin(i / 5), row + (i % 7)])));
    await page.waitForTimeout(30);
  }
  await page.mouse.up();
  await film.saved();
  return page.evaluate(() => {
    const lasted = (entries: PerformanceEntryList): number[] =>
      entries.map(({ duration }) => duration);
    const asked = performance.getEntriesByType("resource");
    return {
      felt: lasted(performance.getEntriesByName("drag-to-result")),
      answered: lasted(asked.filter(({ name }) => name.endsWith("/preview"))),
    };
  });
}

/** Kills the program under a click, starts it again, and waits for the click to be recorded. */
async function killed(
  app: App,
  page: Page,
  film: FilmPage,
): Promise<{ ready: number[]; saved: number[] }> {
  const ready: number[] = [];
  const saved: number[] = [];
  for (let i = 0; i < 5; i += 1) {
    await app.kill();
    await film.viewer.focus();
    await page.keyboard.press("Shift+ArrowDown");
    await page.locator("[data-testid='saving']:not([data-state='saved'])").waitFor();
    const from = performance.now();
    await app.start();
    ready.push(performance.now() - from);
    await page.locator("[data-testid='saving'][data-state='saved']").waitFor({ timeout: 60_000 });
    saved.push(performance.now() - from);
  }
  return { ready, saved };
}
