import { expect, shot, test } from "./app";
import { answerWith, cohort, largeCohort } from "./made";

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

test("a cohort of forty studies with six readings is a page, and a study is shown on request", async ({
  app,
  page,
}) => {
  await answerWith(page, "/api/cohort", largeCohort());
  await app.open(page);
  await page.getByRole("link", { name: "Cohort" }).click();
  const agreement = page.getByRole("region", { name: "Table of agreement" });
  await expect(agreement.getByRole("rowheader")).toHaveCount(24);
  const plot = page.getByRole("img", { name: /Bland–Altman plot of 3000 pairs/ });
  await expect(plot).toHaveCount(1);
  await expect(page.getByText("Finding 3 of the cohort.")).toBeVisible();
  await expect(page.getByText("Finding 4 of the cohort.")).toBeHidden();
  const { nodes, height, resized_ms } = await page.evaluate(async () => {
    const start = performance.now();
    document.querySelector<HTMLElement>("main")!.style.width = "900px";
    for (let i = 0; i < 2; i += 1) await new Promise(requestAnimationFrame);
    const main = document.querySelector("main > .page")!;
    return {
      nodes: document.querySelectorAll("*").length,
      height: main.scrollHeight,
      resized_ms: performance.now() - start,
    };
  });
  expect(nodes).toBeLessThan(3_000);
  expect(height).toBeLessThan(6_000);
  expect(resized_ms).toBeLessThan(1_000);
  await page.getByRole("combobox", { name: "Readings of" }).selectOption("S-007");
  await expect(page.getByRole("img", { name: /Bland–Altman plot of 75 pairs/ })).toHaveCount(1);
  await agreement.getByRole("button", { name: "Plot of quantity 9" }).click();
  await expect(page.getByRole("heading", { name: "quantity 9" })).toBeVisible();
  await page.getByRole("heading", { name: "quantity 9" }).scrollIntoViewIfNeeded();
  await shot(page, "cohort-large");
});

test("an empty cohort says which studies are needed", async ({ app, page }) => {
  await app.open(page);
  await page.getByRole("link", { name: "Cohort" }).click();
  await expect(page.getByRole("heading", { name: "No studies to compare yet" })).toBeVisible();
  await shot(page, "cohort-empty");
});

test("synthetic and real studies are pooled only on request", async ({ app, page }) => {
  await answerWith(page, "/api/cohort", { ...cohort(), verdict: ["5 patients."] });
  await answerWith(page, "/api/cohort/pooled", { ...cohort(), verdict: ["9 patients."] });
  await app.open(page);
  await page.getByRole("link", { name: "Cohort" }).click();
  await expect(page.getByText("5 patients.")).toBeVisible();
  const pools = page.getByRole("checkbox", { name: "Pool synthetic and real studies" });
  await expect(pools).not.toBeChecked();
  await pools.check();
  await expect(page.getByText("9 patients.")).toBeVisible();
  await shot(page, "cohort-pooled");
});
