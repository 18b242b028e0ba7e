import { access } from "node:fs/promises";

import { launch, type Page } from "puppeteer-core";

import type { Api } from "../src/api/types";
import { cssOf, filmOf, type FilmPoint, type Viewport } from "../src/measure/viewport";
import { expect, shot, test } from "./app";
import { CORNERS, cornerOf } from "./marking";

type ReadingView = Api<"ReadingView">;

/**
 * Debian's Firefox. Playwright only drives its own build, which cannot be downloaded everywhere, and sends commands
 * that Firefox ESR does not have; Puppeteer drives it by WebDriver BiDi.
 */
const FIREFOX = process.env.FIREFOX ?? "/usr/bin/firefox-esr";
/** Tolerance between a landmark and its click: places are rounded to 0.001 px. */
const CLOSE_PX = 0.01;
/** For busy machines. */
const WAIT_MS = 60_000;

/** The measuring page in Firefox. */
class FirefoxFilm {
  constructor(readonly page: Page) {}

  async get<T>(address: string): Promise<T> {
    const text = await this.page.evaluate(async (path) => (await fetch(path)).text(), address);
    return JSON.parse(text) as T;
  }

  async press(role: string, name: string): Promise<void> {
    await this.page.locator(`::-p-aria([name="${name}"][role="${role}"])`).click();
  }

  /** Waits for a text in a part of the page. */
  async reads(selector: string, text: RegExp): Promise<void> {
    const read = (): Promise<string> =>
      this.page.$eval(selector, (part) => part.textContent ?? "").catch(() => "");
    await expect.poll(read, { timeout: WAIT_MS }).toMatch(text);
  }

  saved(): Promise<void> {
    return this.reads("[data-testid='saving'][data-state='saved']", /saved/i);
  }

  /**
   * Clicks on the screen pixel nearest to a place of the film; returns the film's place under it. WebDriver clicks on
   * whole pixels.
   */
  async click(place: FilmPoint): Promise<FilmPoint> {
    const viewer = (await this.page.waitForSelector("[data-testid='viewer']"))!;
    const box = (await viewer.boundingBox())!;
    const text = await viewer.evaluate((part) => part.getAttribute("data-view"));
    const view = JSON.parse(text!) as Viewport;
    const [x, y] = cssOf(view, place);
    const at = [Math.round(box.x + x), Math.round(box.y + y)] as const;
    await this.page.mouse.click(...at);
    return filmOf(view, [at[0] - box.x, at[1] - box.y]);
  }

  /** The readings of the erect film: this person's, or one by the demo's virtual readers. */
  async reading(mine: boolean): Promise<ReadingView> {
    const study = /studies\/([^/]+)/.exec(this.page.url())![1]!;
    const { summary } = await this.get<Api<"StudyDetail">>(`/api/studies/${study}`);
    const erect = summary.films.find(({ posture }) => posture === "erect")!;
    const one = erect.readings.find((reading) => reading.mine === mine)!;
    return this.get(`/api/readings/${one.reading}`);
  }
}

test("Firefox: a study, its landmarks and its model", { tag: "@long" }, async ({ app }) => {
  const isInstalled = await access(FIREFOX).then(
    () => true,
    () => false,
  );
  test.skip(!isInstalled, `${FIREFOX} is missing: install firefox-esr`);
  const browser = await launch({ browser: "firefox", executablePath: FIREFOX });
  try {
    const page = await browser.newPage();
    page.setDefaultTimeout(WAIT_MS);
    const thrown: string[] = [];
    page.on("pageerror", (error) => thrown.push(String(error)));
    await page.setViewport({ width: 1280, height: 800 });
    await page.goto(app.address);
    const film = new FirefoxFilm(page);
    await page.locator("input").fill("tester");
    await page.locator("::-p-aria([role='button'])::-p-text(Open)").click();
    await page.locator("button::-p-text(demo)").click();
    await page.locator("button::-p-text(Start marking)").click();
    await film.reads("[data-testid='target']", /L4/);
    await page.waitForFunction(() => performance.getEntriesByName("film-painted").length > 0);

    const truth = await film.reading(false);
    const clicks: [string, Api<"CornerName">, FilmPoint][] = [];
    for (const level of ["L4", "L3"])
      for (const corner of CORNERS) {
        await film.reads("[data-testid='target']", new RegExp(level));
        clicks.push([level, corner, await film.click(cornerOf(truth, level, corner))]);
      }
    await film.reads("[data-testid='target']", /L2/);
    await film.saved();
    const marked = await film.reading(true);
    for (const [level, corner, [column, row]] of clicks) {
      const [x, y] = cornerOf(marked, level, corner);
      expect(Math.hypot(x - column, y - row), `${level} ${corner}`).toBeLessThan(CLOSE_PX);
    }

    // Undo, and the landmarks after a reload.
    await page.keyboard.down("Control");
    await page.keyboard.press("z");
    await page.keyboard.up("Control");
    await film.reads("[data-testid='target']", /L3/);
    await film.saved();
    await page.reload();
    await film.reads("[data-testid='target']", /L3/);
    await film.saved();
    const kept = (await film.reading(true)).vertebrae.flatMap(({ corners }) => corners);
    expect(kept).toHaveLength(2 * CORNERS.length - 1);
    await shot(page, "firefox-marking");

    await page.locator("a::-p-text(Model)").click();
    await film.reads("main", /Which line explains the films\?/);
    await shot(page, "firefox-model");
    expect(thrown).toEqual([]);
  } finally {
    await browser.close();
  }
});
