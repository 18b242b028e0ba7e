import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";

import type { Page } from "@playwright/test";

import type { Api } from "../../src/api/types";
import { expect, test, type App } from "../app";
import { FilmPage } from "../marking";
import { get, send } from "../wire";
import { print, spread } from "./table";

const CASE = "phantom-rod-01";
const STUDIES = 50;

declare global {
  interface Window {
    listPainted?: number;
  }
}

test("fifty studies of five large films", async ({ app, page }) => {
  await fill(app);
  await app.start();
  // Requests before any page has filled the program's caches.
  await page.addInitScript(() => {
    const watch = new MutationObserver(() => {
      if (!document.querySelector("article")) return;
      watch.disconnect();
      requestAnimationFrame(() => (window.listPainted = performance.now()));
    });
    watch.observe(document, { childList: true, subtree: true });
  });
  const first = page.waitForResponse((response) => response.url().endsWith("/api/studies"));
  await app.open(page);
  const answer = await first;
  await answer.finished();
  const cold = answer.request().timing().responseEnd;
  const warm = await asked(page, 10);
  const lists = await painted(page, 5);
  const frames = await scrolled(page);
  const changed = await askedAfterChange(page, 5);
  const { size, opened, again } = await films(app, page);
  print([
    spread("/api/studies, the program just started", [cold]),
    spread("/api/studies, nothing changed since", warm),
    spread("/api/studies, one film's record changed", changed),
    spread("list: from the page's start to its first paint", lists),
    spread("list: frame to frame while scrolled", frames),
    spread(`film of ${size}: click to pixels, first time`, opened),
    spread(`film of ${size}: click to pixels, seen before`, again),
  ]);
});

/** Imports one phantom under many names: its pictures are stored once, its readings each time. */
async function fill(app: App): Promise<void> {
  const folder = await app.makePhantom("--subject", "1", "--noise", "0");
  const text = await readFile(path.join(folder, `${CASE}.json`), "utf8");
  const files: string[] = [];
  for (let i = 1; i <= STUDIES; i += 1) {
    const name = `S-${String(i).padStart(3, "0")}`;
    const file = path.join(folder, `${name}.json`);
    await writeFile(file, text.replaceAll(`"${CASE}"`, `"${name}"`));
    files.push(file);
  }
  await app.addCases(...files);
}

function timed(page: Page): Promise<number> {
  return page.evaluate(async () => {
    const from = performance.now();
    await (await fetch("/api/studies")).arrayBuffer();
    return performance.now() - from;
  });
}

async function asked(page: Page, times: number): Promise<number[]> {
  const samples: number[] = [];
  for (let i = 0; i < times; i += 1) samples.push(await timed(page));
  return samples;
}

async function askedAfterChange(page: Page, times: number): Promise<number[]> {
  const samples: number[] = [];
  for (let i = 0; i < times; i += 1) {
    const { body } = await get<Api<"StudySummary">[]>(page, "/api/studies");
    const { film, revision, image } = body[i]!.films[0]!;
    const edit = { kind: "inverted", inverted: !image.inverted };
    await send(page, "POST", `/api/films/${film}/edits`, { expected_revision: revision, edit });
    samples.push(await timed(page));
  }
  return samples;
}

async function painted(page: Page, times: number): Promise<number[]> {
  const samples: number[] = [];
  for (let i = 0; i < times; i += 1) {
    await page.reload();
    await page.getByRole("article").first().waitFor();
    samples.push(await told(page, () => window.listPainted));
  }
  return samples;
}

/** Scrolls the list from end to end and returns the frame times. */
async function scrolled(page: Page): Promise<number[]> {
  return page.evaluate(async () => {
    const article = document.querySelector("article")!;
    let box: Element = article;
    while (box.parentElement && box.scrollHeight <= box.clientHeight + 1) box = box.parentElement;
    const samples: number[] = [];
    let before = await new Promise<number>(requestAnimationFrame);
    for (let i = 0; i < 180; i += 1) {
      box.scrollTop += i < 90 ? 60 : -60;
      const now = await new Promise<number>(requestAnimationFrame);
      samples.push(now - before);
      before = now;
    }
    return samples;
  });
}

/** Opens each film of a study after a start of the program, and again. */
async function films(
  app: App,
  page: Page,
): Promise<{ size: string; opened: number[]; again: number[] }> {
  await app.kill();
  await app.start();
  // A new address that differs only after its # would not load the page again; the session is still valid.
  await page.goto("about:blank");
  await page.goto(new URL("#/studies/S-050/measure", app.address).href);
  await new FilmPage(page).painted();
  const [opened, again]: [number[], number[]] = [[], []];
  const names = [/left bending/i, /right bending/i, /neutral/i, /traction/i];
  for (const samples of [opened, again]) {
    for (const name of names) samples.push(await clicked(page, name));
  }
  const { body } = await get<Api<"StudyDetail">>(page, "/api/studies/S-050");
  const { columns, rows } = body.summary.films[1]!.image;
  return { size: `${columns} × ${rows}`, opened, again };
}

/** From the click on a film to its first paint, both measured by the page. */
async function clicked(page: Page, name: RegExp): Promise<number> {
  await page.evaluate(() => {
    performance.clearMarks();
    addEventListener("click", () => performance.mark("clicked"), { capture: true, once: true });
  });
  await page.getByRole("navigation", { name: "Films" }).getByRole("link", { name }).click();
  return told(page, () => {
    const [from] = performance.getEntriesByName("clicked");
    const [to] = performance.getEntriesByName("film-painted");
    return from && to ? to.startTime - from.startTime : undefined;
  });
}

/** A value that the page reports when it is known; the content policy prevents waiting inside the page. */
async function told(page: Page, ask: () => number | undefined): Promise<number> {
  let answer: number | undefined;
  await expect.poll(async () => (answer = await page.evaluate(ask))).toBeDefined();
  return answer!;
}
