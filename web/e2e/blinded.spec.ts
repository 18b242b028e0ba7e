import { expect, expectAccessible, shot, test } from "./app";
import { CORNERS, FilmPage } from "./marking";

const POSTURES = /erect|bending|neutral|traction/i;

test("a blinded reader sees codes: no posture, no results", async ({ app, page }) => {
  await app.open(page);
  await FilmPage.ofDemo(page);
  const study = /studies\/([^/]+)/.exec(page.url())![1]!;
  await page.evaluate(async (name) => {
    const session = (await (await fetch("/api/session")).json()) as { csrf: string };
    const answer = await fetch(`/api/studies/${name}/plan`, {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Spineline-Csrf": session.csrf },
      body: JSON.stringify({ observers: ["tester"], repeats: 1, washout_days: 14, seed: 7 }),
    });
    if (!answer.ok) throw new Error(await answer.text());
  }, study);

  const told: string[] = [];
  page.on("response", async (response) => {
    const isText = response.headers()["content-type"]?.includes("json") ?? false;
    if (isText && response.url().includes("/readings")) told.push(await response.text());
  });
  await page.goto(page.url().replace(/#.*/, `#/studies/${study}/read`));
  await expect(page.getByRole("heading", { name: /next film/i })).toBeVisible();
  await shot(page, "blinded-next");
  await page.getByRole("button", { name: "Begin" }).click();
  const film = new FilmPage(page);
  await film.painted();
  await expect(film.target).toContainText("L4");
  const box = (await film.viewer.boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  for (const [index] of CORNERS.entries()) {
    await page.mouse.click(x + (index === 1 || index === 2 ? 60 : 0), y + (index > 1 ? 40 : 0));
  }
  await film.saved();
  await shot(page, "blinded-reading");
  expect(await page.locator("main").innerText()).not.toMatch(POSTURES);
  await expect(page.getByRole("heading", { name: /what the marks say/i })).toHaveCount(0);
  expect(told.length).toBeGreaterThan(0);
  for (const text of told) expect(text).not.toMatch(/"posture":"/);
  await expectAccessible(page);

  // It goes on with the same film after a reload, and with another one once it is finished.
  const code = await page.locator("h1 .code").innerText();
  await page.reload();
  await expect(page.locator("h1 .code")).toHaveText(code);
  await page.getByRole("button", { name: /finish reading/i }).click();
  await page.getByRole("button", { name: "Finish", exact: true }).click();
  await expect(page.getByRole("heading", { name: /next film/i })).toBeVisible();
  await expect(page.locator("h1 .code")).not.toHaveText(code);
});

test("who has read all films is told so, and who has to wait sees until when", async ({
  app,
  page,
}) => {
  await app.open(page);
  await FilmPage.ofDemo(page);
  const study = /studies\/([^/]+)/.exec(page.url())![1]!;
  const until_ms = Date.UTC(2027, 2, 4, 12);
  let next: object = { kind: "wait", until_ms };
  await page.route(`**/api/studies/${study}`, async (route) => {
    const answer = await route.fetch();
    await route.fulfill({ json: { ...(await answer.json()), plan: { blinded: true, next } } });
  });
  const address = page.url().replace(/#.*/, `#/studies/${study}/read`);
  await page.goto(address);
  await expect(page.getByRole("heading", { name: /4 mar 2027/i })).toBeVisible();
  await shot(page, "blinded-wait");
  next = { kind: "done" };
  await page.reload();
  await expect(page.getByRole("heading", { name: /all films are read/i })).toBeVisible();
});
