import type { Page } from "@playwright/test";

import { DEMO, expect, expectAccessible, runProgram, shot, test, type App } from "./app";

test.use({ hasDemo: true });

async function demo(app: App, page: Page): Promise<void> {
  await app.openDemo(page);
  await expect(page.getByRole("link", { name: "Model →" })).toBeVisible();
}

async function openModel(page: Page): Promise<void> {
  await page.evaluate((study) => (window.location.hash = `#/studies/${study}/model`), DEMO);
  await expect(page.getByRole("heading", { level: 1, name: /^Model/ })).toBeVisible();
  await expect(page.getByRole("button", { name: "Options…" })).toBeVisible();
}

for (const [scheme, width, tag] of [
  ["dark", 1280, []],
  ["light", 390, ["@long"]],
] as const) {
  test.describe(`${scheme}, ${width} px`, { tag: [...tag] }, () => {
    test.use({ colorScheme: scheme, viewport: { width, height: 844 } });

    test("model options are changed, shown beside the results, and reset", async ({
      app,
      page,
    }) => {
      await demo(app, page);
      await openModel(page);
      const banner = page.getByText(/^Model options are not the defaults/);
      await expect(banner).toBeHidden();
      await page.getByRole("button", { name: "Options…" }).click();
      const dialog = page.getByRole("dialog", { name: "Model options" });
      await expect(dialog.getByRole("button", { name: "Apply" })).toBeDisabled();
      await expectAccessible(page);
      await shot(page, `options-${scheme}-${width}`);

      await dialog.getByLabel("Order of the curves").fill("3");
      await dialog.getByRole("button", { name: "Apply" }).click();
      await expect(dialog.getByRole("alert")).toContainText("an order from 4 to 12");
      await dialog.getByLabel("Order of the curves").fill("6");
      await dialog.getByLabel("Support").selectOption("free");
      await dialog.getByRole("button", { name: "Apply" }).click();
      await expect(dialog).toBeHidden();
      await expect(page.getByText("Order of the curves: 6; Support: free")).toBeVisible();
      await expectAccessible(page);
      await shot(page, `options-changed-${scheme}-${width}`);

      await page.evaluate(() => (window.location.hash = "#/cohort"));
      await expect(page.getByText("Model options: Order of the curves: 6")).toBeVisible();
      await openModel(page);
      await page.getByRole("button", { name: "Options…" }).click();
      await expect(dialog.getByText("changed", { exact: true })).toHaveCount(2);
      await dialog.getByRole("button", { name: "Reset all to defaults" }).click();
      await expect(dialog).toBeHidden();
      await expect(banner).toBeHidden();
    });
  });
}

test("a known force sets the level of stiffness, and an impossible one is refused", async ({
  app,
  page,
}) => {
  await demo(app, page);
  await openModel(page);
  await page.getByRole("button", { name: "Options…" }).click();
  const dialog = page.getByRole("dialog", { name: "Model options" });
  await dialog.getByLabel("Scale constraint (gauge)").fill("known-force:left_bending=0");
  await dialog.getByRole("button", { name: "Apply" }).click();
  await expect(dialog.getByRole("alert")).toContainText("from 1 to 2000 N");
  await dialog.getByLabel("Scale constraint (gauge)").fill("known-force:left_bending=80");
  await dialog.getByRole("button", { name: "Apply" }).click();
  await expect(page.getByText("scaled to the known force").first()).toBeVisible();
});

test("a stiffness table and lines of one's own are kept with the study and named", async ({
  app,
  page,
}) => {
  await demo(app, page);
  await openModel(page);
  const options = page.getByRole("button", { name: "Options…" });
  await options.click();
  const dialog = page.getByRole("dialog", { name: "Model options" });
  const file = dialog.getByLabel("Open a file for “Stiffness table”");
  const apply = dialog.getByRole("button", { name: "Apply" });
  const own = (text: string) => ({
    name: "own.json",
    mimeType: "application/json",
    buffer: Buffer.from(text),
  });
  await file.setInputFiles(own("{}"));
  await apply.click();
  await expect(dialog.getByRole("alert")).toContainText("spineline-stiffness");
  await file.setInputFiles(own(await runProgram("stiffness", "in-vitro")));
  await dialog
    .getByLabel("Given line of action")
    .fill("left_bending=20,150,-5; right_bending=-20,150,5");
  await apply.click();
  await expect(dialog).toBeHidden();
  await expect(
    page.getByText(/Stiffness table: own\.json \(SHA-256 [0-9a-f]{12}…\)/),
  ).toBeVisible();
  await expect(page.getByRole("button", { name: /^Given line/ })).toBeVisible();
  await options.click();
  await expect(dialog.getByLabel(/^Stiffness table/)).toHaveValue(/^own\.json/);
  await shot(page, "options-file");
});

test("inflections are picked on the film, undone and reset", async ({ app, page }) => {
  await demo(app, page);
  await page.evaluate((study) => (window.location.hash = `#/studies/${study}`), DEMO);
  const section = page.getByRole("region", { name: "Inflections" });
  await expect(section.getByText("Found on the erect film")).toBeVisible();
  await section.getByRole("button", { name: "Pick on the film" }).click();
  const site = (name: string) => page.locator(`[data-site='${name}']`);
  await expect(site("L1/T12")).toBeVisible();
  await shot(page, "inflections-picking");
  const click = async (name: string): Promise<void> => {
    const box = (await site(name).boundingBox())!;
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  };
  await click("L1/T12");
  await expect(section.getByRole("status")).toContainText("Lower: L1/T12");
  await click("T6");
  await expect(section.getByText("Picked by hand: L1/T12 and T6")).toBeVisible();
  await expect(page.getByText("Inflections: L1/T12,T6")).toBeVisible();
  await expectAccessible(page);
  await shot(page, "inflections-picked");

  // The upper one first: the program refuses it with a reason.
  await section.getByRole("button", { name: "Pick on the film" }).click();
  await click("T6");
  await click("L2");
  await expect(section.getByRole("alert")).toContainText("the caudal site comes first");
  await section.getByRole("button", { name: "Cancel" }).click();

  await section.getByRole("button", { name: "Undo" }).click();
  await expect(section.getByText("Found on the erect film")).toBeVisible();
  await section.getByText("Choose from lists").click();
  await section.getByLabel("Upper").selectOption("T5");
  await section.getByLabel("Lower").selectOption("L2");
  await section.getByRole("button", { name: "Set", exact: true }).click();
  await expect(section.getByText("Picked by hand: L2 and T5")).toBeVisible();
  await section.getByRole("button", { name: "Reset" }).click();
  await expect(section.getByText("Found on the erect film")).toBeVisible();
});
