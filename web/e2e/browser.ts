import { existsSync } from "node:fs";

const SHELL = "/usr/lib/chromium/chromium-headless-shell";

/** Debian's Chromium, or the browser that `CHROMIUM` names. */
export const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

/** The browser of the tests. Chromium's shell has the same pages without windows, and takes two thirds of the time. */
export const BROWSER = !process.env.CHROMIUM && existsSync(SHELL) ? SHELL : CHROMIUM;
