import { defineConfig } from "@playwright/test";

import { CHROMIUM } from "./e2e/browser";
import base from "./playwright.config";

// The release build, as users have it.
process.env.SPINELINE_PROGRAM ??= "../target/release/spineline";

/** Speeds are reported, not tested: a slow machine must not fail the run. */
export default defineConfig(base, {
  testDir: "e2e/bench",
  testMatch: "*.bench.ts",
  outputDir: "test-results/bench",
  workers: 1,
  timeout: 600_000,
  // A trace records the page, which costs more time than the measured actions.
  use: {
    ...base.use,
    trace: "off",
    actionTimeout: 30_000,
    // The browser that users have.
    launchOptions: { ...base.use?.launchOptions, executablePath: CHROMIUM },
  },
});
