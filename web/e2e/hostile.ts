import type { Page } from "@playwright/test";

import { expect } from "./app";

/** Texts that would run as code if a page did not escape them. */
export const EVIL = [
  `<img src=x onerror="window.ran=1">`,
  `<svg onload="window.ran=1">`,
  `"><script>window.ran=1</script>`,
  `javascript:window.ran=1`,
];

/** Fields with text written by people, or derived from it. */
const WORDS =
  /^(label|title|observer|who|region|axis|notes|texts|verdict|observers|message|help|(.*_)?(text|unit))$/;

/** An answer with all texts replaced by different hostile ones. */
function poisoned(value: unknown, field: string, count: { of: number }): unknown {
  if (Array.isArray(value)) return value.map((one) => poisoned(one, field, count));
  if (value !== null && typeof value === "object") {
    const entries = Object.entries(value);
    return Object.fromEntries(entries.map(([key, one]) => [key, poisoned(one, key, count)]));
  }
  if (typeof value !== "string" || !WORDS.test(field)) return value;
  count.of += 1;
  return `${EVIL[count.of % EVIL.length]} ${count.of}`;
}

/** Puts hostile texts into all answers about studies and readings. */
export async function poisonAnswers(page: Page): Promise<void> {
  const count = { of: 0 };
  await page.route(/\/api\/(studies|readings|films)\b/, async (route) => {
    if (route.request().url().endsWith("/changes")) return route.continue();
    const answer = await route.fetch();
    if (!/json/.test(answer.headers()["content-type"] ?? "")) {
      return route.fulfill({ response: answer });
    }
    const json = poisoned(await answer.json(), "", count);
    return route.fulfill({ status: answer.status(), json });
  });
}

/** Checks that no hostile text became an element of the page or ran. */
export async function expectHarmless(page: Page): Promise<void> {
  expect(await page.evaluate(() => "ran" in window)).toBe(false);
  const parts = "img[src=x], script:not([src]), [onload], [onerror], a[href^='javascript:' i]";
  expect(await page.locator(parts).count()).toBe(0);
}
