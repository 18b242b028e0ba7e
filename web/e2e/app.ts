import { execFile, spawn, type ChildProcess } from "node:child_process";
import { cp, mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { promisify } from "node:util";

import AxeBuilder from "@axe-core/playwright";
import { test as base, expect, request, type Locator, type Page } from "@playwright/test";

import type { Api } from "../src/api/types";

/** Study of the demonstration. */
export const DEMO = "demo-rod-01";

/** Password of all accounts. */
export const PASSWORD = "a password that is long enough";

/** The program under test. */
const PROGRAM = process.env.SPINELINE_PROGRAM ?? path.resolve("../target/debug/spineline");

/** Folder of separately built pages; without it the program's embedded pages are tested. */
const PAGES = process.env.SPINELINE_PAGES;

const KINDS: Record<string, string> = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".css": "text/css",
  ".svg": "image/svg+xml",
};

/** A server with its own store in its own folder. */
export class App {
  private process: ChildProcess | null = null;
  /** Address with the token, as `serve` prints it. */
  address = "";

  constructor(readonly folder: string) {}

  get store(): string {
    return path.join(this.folder, "studies.spineline");
  }

  /** Starts the program; after a kill on the same port. */
  async start(...more: string[]): Promise<void> {
    const port = this.address === "" ? "0" : new URL(this.address).port;
    const child = spawn(PROGRAM, ["serve", this.store, "--port", port, ...more], {
      stdio: ["ignore", "pipe", "inherit"],
    });
    this.process = child;
    await new Promise<void>((resolve, reject) => {
      let text = "";
      const late = () => reject(new Error(`serve printed no address in 60 s: ${text}`));
      setTimeout(late, 60_000).unref();
      child.stdout.on("data", (part: Buffer) => {
        text += part.toString();
        // An address is valid once; then the program prints another one.
        const last = [...text.matchAll(/(http:\/\/\S+)\n/g)].at(-1)?.[1];
        if (!last) return;
        this.address = last;
        resolve();
      });
      child.once("exit", (code) => reject(new Error(`serve ended with ${code}: ${text}`)));
    });
  }

  /** Kills the program, as a power failure would. */
  async kill(): Promise<void> {
    const child = this.process;
    if (!child || child.exitCode !== null || child.signalCode !== null) return;
    const ended = new Promise((resolve) => child.once("exit", resolve));
    child.kill("SIGKILL");
    await ended;
  }

  /** Adds the demo study, as the page of studies does. */
  async addDemo(): Promise<void> {
    const { origin, hash } = new URL(this.address);
    const token = hash.replace("#token=", "");
    const api = await request.newContext({ baseURL: origin, extraHTTPHeaders: { origin } });
    const signIn: Api<"SignIn"> = { kind: "token", token, observer: "tester" };
    const session = await api.post("/api/session", { data: signIn });
    const { csrf } = (await session.json()) as Api<"SessionView">;
    const headers = { "x-spineline-csrf": csrf };
    const made = await api.post("/api/studies/demo", { data: {}, headers });
    expect(made.status()).toBe(200);
    await api.dispose();
  }

  /** Makes a phantom with films; returns the folder with its case file and its pictures. */
  async makePhantom(...options: string[]): Promise<string> {
    const folder = await mkdtemp(path.join(this.folder, "phantom-"));
    await runProgram("phantom", ...options, "--films", "--out", folder);
    return folder;
  }

  /** Stops the program and adds case files to its store. */
  async addCases(...files: string[]): Promise<void> {
    await this.kill();
    await runProgram("study", "add", this.store, ...files);
  }

  /** Adds an account to the store. */
  async addAccount(name: string, role: string): Promise<void> {
    const words = ["account", "add", name, "--role", role, "--password-stdin", this.store];
    await runWith(`${PASSWORD}\n`, words);
  }

  /** Opens the app and signs in as an observer. */
  async open(page: Page, observer = "tester"): Promise<void> {
    await usePages(page);
    await page.goto(this.address);
    await page.getByLabel(/your reader name/i).fill(observer);
    await page.getByRole("button", { name: /^open/i }).click();
    await expect(page.getByRole("heading", { name: "Studies", level: 1 })).toBeVisible();
  }

  /** Opens the app and one of its pages. */
  async openAt(page: Page, place: string): Promise<void> {
    await this.open(page);
    await page.goto(new URL(place, this.address).href);
  }

  /** Opens the app and a page of the demo, which the store has by `test.use({ hasDemo: true })`. */
  async openDemo(page: Page, place: "measure" | "model" = "measure"): Promise<void> {
    await this.open(page);
    await page.evaluate((hash) => (window.location.hash = hash), `#/studies/${DEMO}/${place}`);
  }
}

/** Runs a command of the program to its end, such as to make phantoms; returns its output. */
export const runProgram = (...args: string[]): Promise<string> => runWith("", args);

/** Runs a command of the program on an input to its end; returns its output. */
async function runWith(input: string, args: readonly string[]): Promise<string> {
  const run = promisify(execFile)(PROGRAM, args);
  run.child.stdin?.end(input);
  return (await run).stdout;
}

async function newApp(): Promise<App> {
  return new App(await mkdtemp(path.join(tmpdir(), "spineline-e2e-")));
}

interface Fixtures {
  /** Whether the store has the demo from the start: drawing its films takes seconds. */
  hasDemo: boolean;
  /** A running program with its own store. */
  app: App;
}

interface Shared {
  /** A store with the demo, to be copied. */
  demoStore: () => Promise<App>;
}

export const test = base.extend<Fixtures, Shared>({
  demoStore: [
    async ({}, use) => {
      let made: App | null = null;
      await use(async () => {
        if (made) return made;
        const app = await newApp();
        await app.start();
        await app.addDemo();
        await app.kill();
        return (made = app);
      });
      if (made) await rm((made as App).folder, { recursive: true, force: true });
    },
    { scope: "worker", timeout: 120_000 },
  ],
  hasDemo: [false, { option: true }],
  app: async ({ hasDemo, demoStore }, use) => {
    const app = await newApp();
    // The whole folder: the last changes of the killed program are in a file beside the store.
    if (hasDemo) await cp((await demoStore()).folder, app.folder, { recursive: true });
    await app.start();
    await use(app);
    await app.kill();
    await rm(app.folder, { recursive: true, force: true });
  },
});

/** Replaces the program's pages with the pages of `SPINELINE_PAGES`, if set, with the same headers. */
export async function usePages(page: Page): Promise<void> {
  if (!PAGES) return;
  await page.route(
    (url) => !url.pathname.startsWith("/api/"),
    async (route) => {
      const { pathname } = new URL(route.request().url());
      const file = path.join(PAGES, pathname === "/" ? "index.html" : pathname);
      const home = await route
        .fetch({ url: new URL("/", route.request().url()).href })
        .catch(() => null);
      if (!home) return route.abort();
      const { "content-length": _, ...kept } = home.headers();
      const headers = { ...kept, "content-type": KINDS[path.extname(file)] ?? "" };
      await route.fulfill({ status: 200, path: file, headers });
    },
  );
}

/** Signs in with an account. */
export async function signIn(page: Page, name: string): Promise<void> {
  await page.getByRole("textbox", { name: "Account" }).fill(name);
  await page.getByLabel("Password", { exact: true }).fill(PASSWORD);
  await page.getByRole("button", { name: "Sign in" }).click();
}

/** Enters the patient's side of a new film if its file does not state it. */
export async function enterSide(film: Locator): Promise<void> {
  const sides = film.getByRole("group", { name: "The patient's left is on the" });
  if (!(await sides.getByText("from the file").isVisible()))
    await sides.getByRole("radio", { name: "right of the picture" }).check();
}

/** Fails on every violation that axe finds on the page. */
export async function expectAccessible(page: Page): Promise<void> {
  const { violations } = await new AxeBuilder({ page })
    .withTags(["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"])
    .analyze();
  const found = violations.map(({ id, help, nodes }) => ({
    id,
    help,
    where: nodes.map((node) => `${node.target.join(" ")}: ${node.failureSummary}`),
  }));
  expect(found).toEqual([]);
}

/** Fails if any part of a text is outside of the window, cut by a box around it, or covered. */
export async function expectReadable(text: Locator): Promise<void> {
  await expect(text).toBeInViewport({ ratio: 1 });
  const why = await text.evaluate((element) => {
    const range = document.createRange();
    range.selectNodeContents(element);
    const words = range.getBoundingClientRect();
    for (let box = element as Element | null; box; box = box.parentElement) {
      if (getComputedStyle(box).overflow === "visible") continue;
      const { left, right, top, bottom } = box.getBoundingClientRect();
      const isInside =
        words.left >= left - 1 &&
        words.right <= right + 1 &&
        words.top >= top - 1 &&
        words.bottom <= bottom + 1;
      if (!isInside) return `cut by <${box.localName} class="${box.className}">`;
    }
    const middle = [words.x + words.width / 2, words.y + words.height / 2] as const;
    const seen = document.elementFromPoint(...middle);
    return seen && (seen.contains(element) || element.contains(seen)) ? "" : "covered";
  });
  expect(why).toBe("");
}

/** A page of Playwright or of Puppeteer. */
type Pictured = { screenshot(options: { path: `${string}.png` }): Promise<unknown> };

/** Stores a screenshot of the page, if requested with `SPINELINE_SHOTS`. */
export async function shot(page: Pictured, name: string): Promise<void> {
  if (process.env.SPINELINE_SHOTS) await page.screenshot({ path: `e2e/shots/${name}.png` });
}

/** Shows a page on a light phone and on a dark computer: checks it there, also by axe, and draws it. */
export async function onPhoneAndComputer(
  page: Page,
  name: string,
  check: (width: number) => Promise<void>,
): Promise<void> {
  for (const [width, colorScheme] of [
    [390, "light"],
    [1280, "dark"],
  ] as const) {
    await page.setViewportSize({ width, height: 800 });
    await page.emulateMedia({ colorScheme });
    await check(width);
    await expectAccessible(page);
    await shot(page, `${name}-${width}-${colorScheme}`);
  }
}

export { expect };
