import { test } from "@playwright/test";
import { loadAnswer, modelView } from "./model.fixture";
test("perf", async ({ page }) => {
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
  await page.goto("http://localhost:5176/#/studies/phantom-rod-01/model");
  await page.getByRole("application").waitFor();
  await page.waitForTimeout(2500);
  const t = await page.evaluate(async () => {
    const v = document.querySelector("[role=application]") as HTMLElement;
    v.focus();
    const raf = () => new Promise((r) => requestAnimationFrame(r));
    const out: number[] = [];
    for (let i = 0; i < 30; i++) {
      const t0 = performance.now();
      v.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
      await raf();
      await raf();
      out.push(Math.round(performance.now() - t0));
    }
    const gl = document.createElement("canvas").getContext("webgl2")!;
    return {
      out,
      slow: gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info")!.UNMASKED_RENDERER_WEBGL),
    };
  });
  console.log(JSON.stringify(t));
});
