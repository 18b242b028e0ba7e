import { expect, expectAccessible, shot, test } from "./app";

test.use({ hasDemo: true });

for (const [scheme, width] of [
  ["dark", 1280],
  ["light", 390],
] as const) {
  test.describe(`${scheme}, ${width} px`, { tag: "@long" }, () => {
    test.use({ colorScheme: scheme, viewport: { width, height: 844 } });

    test("lines, multipliers and other models have the tables and pictures of the report", async ({
      app,
      page,
    }) => {
      test.slow();
      await app.openDemo(page);
      await page.getByRole("link", { name: "Model →" }).click();
      await page.getByRole("link", { name: "Evidence" }).click();
      await expect(page.getByRole("heading", { level: 1, name: /^Evidence/ })).toBeVisible();
      await expect(page.getByText("Synthetic films: no patient")).toBeVisible();
      const errors = page.getByRole("table", { name: "Mean location errors" });
      await expect(errors.getByText("* other bend, mirrored")).toBeVisible();
      await expect(page.getByText(/^Of the lines that take fewest numbers/)).toBeVisible();
      await expect(page.getByRole("img")).toHaveCount(2);
      for (const image of await page.getByRole("img").all())
        expect(await image.evaluate((it: HTMLImageElement) => it.naturalWidth)).toBeGreaterThan(
          100,
        );
      await shot(page, `evidence-${scheme}-${width}`);

      await page.getByRole("button", { name: "Compare all models" }).click();
      await expect(page.getByText(/^\d+ of \d+ models$/)).toBeVisible();
      await page.getByRole("button", { name: "Cancel" }).click();
      await expect(page.getByText(/^Cancelled\./)).toBeVisible();

      await page.getByRole("button", { name: "Compute the profiles" }).click();
      const profiles = page.getByRole("table", { name: "Identifiability of the multipliers" });
      await expect(profiles).toBeVisible({ timeout: 120_000 });
      await expect(page.getByRole("img", { name: /^Rise of the sum of squares/ })).toBeVisible();
      await page.getByRole("button", { name: "Compare all models" }).click();
      const models = page.getByRole("table", { name: /^Errors by load and base/ });
      await expect(models).toBeVisible({ timeout: 120_000 });
      await expectAccessible(page);
      await page.setViewportSize({ width, height: 3600 });
      await shot(page, `evidence-all-${scheme}-${width}`);
      const wide = await page.evaluate(
        () => document.documentElement.scrollWidth > document.documentElement.clientWidth,
      );
      expect(wide).toBe(false);

      // What is computed stays with the results.
      await page.getByRole("link", { name: "Model", exact: true }).click();
      await page.getByRole("link", { name: "Evidence" }).click();
      await expect(profiles).toBeVisible();
    });
  });
}
