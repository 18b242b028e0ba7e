import { expect, shot, test } from "./app";
import { answerWith, cohort } from "./made";

test("the cohort shows a sortable table, charts, comparisons and agreement", async ({
  app,
  page,
}) => {
  await answerWith(page, "/api/cohort", cohort());
  await app.open(page);
  await page.getByRole("link", { name: "Cohort" }).click();
  await expect(page.getByText("Synthetic films: no patient")).toBeVisible();
  const table = page.getByRole("region", { name: "Table of studies" });
  const studies = table.getByRole("rowheader");
  await expect(studies).toHaveCount(9);
  await table.getByRole("button", { name: "main Cobb (°)" }).click();
  await table.getByRole("button", { name: "main Cobb (°)" }).click();
  await expect(table.getByRole("columnheader", { name: "main Cobb" })).toHaveAttribute(
    "aria-sort",
    "descending",
  );
  await expect(table.getByRole("row").nth(1)).toContainText("50.0");
  // A study without a value is last in both directions.
  await expect(table.getByRole("row").last()).toContainText("–");
  await expect(table.getByText("the erect film lacks T4, T3 and T2").first()).toBeVisible();
  await expect(page.getByText(/joints turn against the force/)).toBeVisible();

  await expect(page.locator("svg.chart")).toHaveCount(3);
  await expect(page.getByText(/Whiskers reach to/).first()).toBeVisible();
  const numbers = page.getByRole("figure").first();
  await numbers.getByText("Numbers").click();
  await expect(numbers.getByRole("table")).toContainText("8.2");
  await expect(
    page.getByRole("img", { name: /Bland–Altman.*mean difference 0.31°/ }),
  ).toBeVisible();
  await shot(page, "cohort");
  await page.getByRole("heading", { name: "Comparisons" }).scrollIntoViewIfNeeded();
  await shot(page, "cohort-below");
  await page.setViewportSize({ width: 1024, height: 768 });
  await expect
    .poll(() => page.evaluate(() => document.documentElement.scrollWidth))
    .toBeLessThanOrEqual(1024);
  await shot(page, "cohort-tablet");
});

test("an empty cohort says which studies are needed", async ({ app, page }) => {
  await app.open(page);
  await page.getByRole("link", { name: "Cohort" }).click();
  await expect(page.getByRole("heading", { name: "No studies to compare yet" })).toBeVisible();
  await shot(page, "cohort-empty");
});
