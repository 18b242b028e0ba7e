// How long the model needs to follow a load that is dragged: from the pointer's event to the frame with its answer.
// Run by `npm run bench`, with the program and the pages that the end-to-end tests would take.
import { spawn } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";

import { chromium } from "@playwright/test";

const PROGRAM = process.env.SPINELINE_PROGRAM ?? path.resolve("../target/release/spineline");
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
const MOVES = 360;
const MOVE_MS = 16;
const REACH_PX = 45;
const MEASURE = "load: pointer to result";

const KINDS = { html: "text/html", js: "text/javascript", css: "text/css", svg: "image/svg+xml" };

/** Starts the program, and gives its address. */
function serve(folder) {
  const child = spawn(PROGRAM, ["serve", path.join(folder, "studies.spineline"), "--port", "0"], {
    stdio: ["ignore", "pipe", "inherit"],
  });
  const address = new Promise((resolve, reject) => {
    child.stdout.on("data", (part) => {
      const found = /(http:\/\/\S+)/.exec(part.toString());
      if (found) resolve(found[1]);
    });
    child.once("error", reject);
    child.once("exit", (code) => reject(new Error(`${PROGRAM} ended with ${code}`)));
  });
  return { child, address };
}

/** Puts the pages of `SPINELINE_PAGES` in the place of the program's. */
async function usePages(page) {
  const pages = process.env.SPINELINE_PAGES;
  if (!pages) return;
  await page.route(
    (url) => !url.pathname.startsWith("/api/"),
    async (route) => {
      const { pathname } = new URL(route.request().url());
      const file = path.join(pages, pathname === "/" ? "index.html" : pathname);
      const contentType = KINDS[path.extname(file).slice(1)] ?? "";
      await route.fulfill({ path: file, contentType });
    },
  );
}

/** Opens the demo's model with a load by hand; gives the handle's place. */
async function openLoad(page, address) {
  await page.goto(address);
  await page.getByLabel(/who reads/i).fill("bench");
  await page.getByRole("button", { name: /^open/i }).click();
  await page.getByRole("button", { name: "Open a demo" }).first().click();
  await page.waitForURL(/#\/studies\/[^/]+\/measure/);
  const study = /#\/studies\/([^/]+)/.exec(page.url())[1];
  await page.evaluate((id) => (window.location.hash = `#/studies/${id}/model`), study);
  await page.getByRole("button", { name: "Load by hand" }).click();
  const handle = page.getByRole("button", { name: /^Tip of the load/ });
  await handle.waitFor();
  await page.waitForTimeout(2000);
  const box = await handle.boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
}

/** Drags to one side and the other, and gives every measure that the page took. */
async function drag(page, [x, y]) {
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let move = 1; move <= MOVES; move += 1) {
    const turn = (move / 60) * 2 * Math.PI;
    // Not waited for: a hand does not wait either.
    void page.mouse.move(x - REACH_PX * Math.sin(turn), y + 0.3 * REACH_PX * Math.sin(2 * turn));
    await new Promise((resolve) => setTimeout(resolve, MOVE_MS));
  }
  await page.waitForTimeout(1000);
  const measures = await page.evaluate(
    (name) => performance.getEntriesByName(name).map(({ duration }) => duration),
    MEASURE,
  );
  const answers = await page.evaluate(() =>
    performance
      .getEntriesByType("resource")
      .filter(({ name }) => name.endsWith("/load"))
      .map(({ duration }) => duration),
  );
  await page.mouse.up();
  return { measures, answers };
}

/** The duration that a part of all durations does not exceed. */
function quantile(durations, part) {
  const sorted = durations.toSorted((a, b) => a - b);
  return sorted[Math.max(Math.ceil(part * sorted.length) - 1, 0)];
}

function row(what, durations) {
  const [p50, p95, worst] = [0.5, 0.95, 1].map((part) => quantile(durations, part).toFixed(0));
  return { what, count: durations.length, "p50, ms": p50, "p95, ms": p95, "max, ms": worst };
}

const folder = await mkdtemp(path.join(tmpdir(), "spineline-bench-"));
const { child, address } = serve(folder);
const browser = await chromium.launch({
  executablePath: CHROMIUM,
  args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--disable-quic"],
});
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  await usePages(page);
  const place = await openLoad(page, await address);
  // All that is to be loaded is; what is looked through on its way takes longer.
  await page.unrouteAll();
  const { measures, answers } = await drag(page, place);
  console.log(`${MOVES} moves at 1280 x 800`);
  console.table([row("pointer to picture", measures), row("of these, request to answer", answers)]);
} finally {
  await browser.close();
  child.kill();
  await rm(folder, { recursive: true, force: true });
}
