import { test } from "@playwright/test";
import { loadAnswer, modelView } from "./model.fixture";
test("look", async ({ page }) => {
  page.on("console", (m) => console.log(m.type(), m.text()));
  page.on("pageerror", (e) => console.log("ERR", e.message));
  await page.route("**/api/**", (route) => {
    const url = new URL(route.request().url());
    if (!url.pathname.startsWith("/api/")) return route.continue();
    const json = (b: unknown) => route.fulfill({ json: b });
    if (url.pathname === "/api/sign-in") return json({ access: "token", version: "0" });
    if (url.pathname === "/api/session")
      return json({ name: "tester", role: "editor", access: "token", csrf: "x", version: "0" });
    if (url.pathname.endsWith("/model")) return json(modelView());
    if (url.pathname.endsWith("/load")) return json(loadAnswer(route.request().postDataJSON()));
    return route.fulfill({ status: 404, json: { code: "not_found", message: "no" } });
  });
  const s = (n: string) => page.screenshot({ path: `/tmp/m3d/${n}.png` });
  await page.goto("http://localhost:5176/#/studies/phantom-rod-01/model");
  await page.getByRole("application").waitFor();
  await page.waitForTimeout(2500);
  await s("1-start");
  const b = (name: RegExp) => page.getByRole("button", { name });
  await b(/^Left$/).click();
  await page.waitForTimeout(500);
  await s("2-left");
  await b(/^Top$/).click();
  await page.waitForTimeout(500);
  await s("3-top");
  await b(/^Front$/).click();
  await page.getByRole("application").focus();
  for (let i = 0; i < 7; i++) await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("ArrowUp");
  await page.waitForTimeout(500);
  await s("4-turned");
  await b(/Side by side/).click();
  await b(/^Back$/).click();
  await page.waitForTimeout(500);
  await s("5-beside");
  await b(/Overlaid/).click();
  await b(/Traction/).click();
  await page.waitForTimeout(500);
  await s("6-traction");
  await b(/Iliac line/).click();
  await b(/Left bending/).click();
  await page.waitForTimeout(500);
  await s("7-iliac");
  await b(/Inflection line/).click();
  await b(/Load by hand/).click();
  await page.waitForTimeout(500);
  const h = page.getByRole("button", { name: /Tip of the load/ });
  const box = (await h.boundingBox())!;
  await page.mouse.move(box.x + 15, box.y + 15);
  await page.mouse.down();
  await page.mouse.move(box.x - 60, box.y, { steps: 12 });
  await page.waitForTimeout(500);
  await s("8-load");
  console.log(
    await page.evaluate(() =>
      JSON.stringify(performance.getEntriesByType("measure").map((m) => Math.round(m.duration))),
    ),
  );
  await page.mouse.move(box.x - 360, box.y, { steps: 12 });
  await page.waitForTimeout(800);
  await page.mouse.up();
  await s("9-load-far");
  await b(/Flat views/).click();
  await page.waitForTimeout(500);
  await s("10-flat-load");
  await b(/Left bending/).click();
  await page.waitForTimeout(500);
  await s("11-flat");
});
