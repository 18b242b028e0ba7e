import { existsSync } from "node:fs";

const SHELL = "/usr/lib/chromium/chromium-headless-shell";

/** Debian's Chromium, or the browser that `CHROMIUM` names. */
export const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

/** The browser of the tests. Chromium's shell renders the same pages without windows, in two thirds of the time. */
export const BROWSER = !process.env.CHROMIUM && existsSync(SHELL) ? SHELL : CHROMIUM;

/** The environment of the browser: the Chromium of npm brings libraries, and `xtask` names their folder. */
export const ENVIRONMENT = process.env.CHROMIUM_LIBRARIES
  ? { ...process.env, LD_LIBRARY_PATH: process.env.CHROMIUM_LIBRARIES }
  : undefined;
