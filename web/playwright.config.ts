import { defineConfig } from "@playwright/test";

import { BROWSER, ENVIRONMENT } from "./e2e/browser";

export default defineConfig({
  testDir: "e2e",
  outputDir: "test-results",
  // Every test starts its own server and store; two at a time leave one core for each.
  workers: 2,
  fullyParallel: true,
  // Long timeouts for busy machines.
  timeout: 240_000,
  expect: { timeout: 30_000 },
  // A second try records a trace, which slows a test by half; a test that passes then is reported as flaky.
  retries: 1,
  reporter: [["list"]],
  use: {
    viewport: { width: 1280, height: 800 },
    // A press or a screenshot that waits longer hangs: say which one, and try again.
    actionTimeout: 60_000,
    // `look.spec.ts` has the light theme too.
    colorScheme: "dark",
    // Debian's browser, because Playwright's browsers cannot be downloaded everywhere.
    channel: undefined,
    launchOptions: {
      executablePath: BROWSER,
      env: ENVIRONMENT,
      args: [
        "--no-sandbox",
        "--enable-unsafe-swiftshader",
        "--disable-quic",
        "--disable-background-networking",
        "--disable-component-update",
      ],
    },
    trace: "on-first-retry",
  },
});
