import { defineConfig } from "@playwright/test";

import base from "./playwright.config";

// What people use: the program as it is shipped.
process.env.SPINELINE_PROGRAM ??= "../target/release/spineline";

/** Speeds are told, not tested: a slow machine makes no fault of them. */
export default defineConfig(base, {
  testDir: "e2e/bench",
  testMatch: "*.bench.ts",
  outputDir: "test-results/bench",
  workers: 1,
  timeout: 600_000,
  // A trace films the page, which costs more than what is measured.
  use: { ...base.use, trace: "off", actionTimeout: 30_000 },
});
