import { expect, shot, test } from "./app";
import { FilmPage } from "./marking";

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
