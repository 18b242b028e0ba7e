import { spawn, type ChildProcess } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";

import { test as base, expect, type Page } from "@playwright/test";

/** The program under test. */
const PROGRAM = process.env.SPINELINE_PROGRAM ?? path.resolve("../target/debug/spineline");

/** A server with a store in a folder of its own. */
export class App {
  private process: ChildProcess | null = null;
  /** Address with the token, as `serve` prints it. */
  address = "";

  constructor(readonly folder: string) {}

  get store(): string {
    return path.join(this.folder, "studies.spineline");
  }

  /** Starts the program; on the same port again after it was killed. */
  async start(...more: string[]): Promise<void> {
    const port = this.address === "" ? "0" : new URL(this.address).port;
    const child = spawn(PROGRAM, ["serve", this.store, "--port", port, ...more], {
      stdio: ["ignore", "pipe", "inherit"],
    });
    this.process = child;
    this.address = await new Promise<string>((resolve, reject) => {
      let text = "";
      child.stdout.on("data", (part: Buffer) => {
        text += part.toString();
        const found = /http:\/\/\S+/.exec(text);
        if (found) resolve(found[0]);
      });
      child.once("exit", (code) => reject(new Error(`serve ended with ${code}: ${text}`)));
    });
  }

  /** Ends the program as a power cut would. */
  async kill(): Promise<void> {
    const child = this.process;
    if (!child || child.exitCode !== null || child.signalCode !== null) return;
    const ended = new Promise((resolve) => child.once("exit", resolve));
    child.kill("SIGKILL");
    await ended;
  }

  /** Opens the app and signs in as an observer. */
  async open(page: Page, observer = "tester"): Promise<void> {
    await page.goto(this.address);
    await page.getByLabel(/who reads/i).fill(observer);
    await page.getByRole("button", { name: /^open/i }).click();
    await expect(page.getByRole("heading", { name: "Studies", level: 1 })).toBeVisible();
  }
}

export const test = base.extend<{ app: App }>({
  app: async ({}, use) => {
    const folder = await mkdtemp(path.join(tmpdir(), "spineline-e2e-"));
    const app = new App(folder);
    await app.start();
    await use(app);
    await app.kill();
    await rm(folder, { recursive: true, force: true });
  },
});

/** Keeps a picture of the page, to be looked at. */
export async function shot(page: Page, name: string): Promise<void> {
  await page.screenshot({ path: `e2e/shots/${name}.png` });
}

export { expect };
