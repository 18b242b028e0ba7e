import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";

import type { Browser, Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import { expect, runProgram, shot, signIn, test, usePages, type App } from "./app";
import { FilmPage } from "./marking";
import { get, send } from "./wire";

const [SHARED, OTHER] = ["phantom-rod-01", "of-ab-alone"];

test(
  "two editors see each other's changes and do not overwrite them",
  { tag: "@long" },
  async ({ app, browser }) => {
    test.setTimeout(300_000);
    await twoStudies(app);
    await app.addAccount("lead", "admin");
    for (const [name, role] of [
      ["ab", "editor"],
      ["cd", "editor"],
      ["ef", "reader"],
    ] as const) {
      await app.addAccount(name, role);
      await runProgram("account", "grant", name, SHARED, "--role", role, app.store);
    }
    await runProgram("account", "grant", "ab", OTHER, "--role", "editor", app.store);
    await app.start("--accounts");
    const [ab, cd] = [await signedIn(browser, app, "ab"), await signedIn(browser, app, "cd")];

    // A study without a grant is neither in the list nor at its address.
    await expect(ab.getByRole("article")).toHaveCount(2);
    await expect(cd.getByRole("article")).toHaveCount(1);
    await expect(cd.getByRole("article")).toContainText(SHARED);
    await cd.goto(new URL(`#/studies/${OTHER}/measure`, app.address).href);
    await expect(cd.getByRole("alert")).toBeVisible();
    await shot(cd, "people-no-grant");
    expect((await get(cd, `/api/studies/${OTHER}`)).status).toBe(404);

    await readAtOnce(app, ab, cd);
    await scaleAtOnce(ab, cd);

    const ef = await signedIn(browser, app, "ef");
    await expectLooking(app, ef);
    for (const page of [ab, cd, ef]) await page.context().close();
  },
);

/** Each finishes a reading, and the other one's list of readings is updated. */
async function readAtOnce(app: App, ab: Page, cd: Page): Promise<void> {
  for (const page of [ab, cd]) {
    await page.goto(new URL(`#/studies/${SHARED}/measure`, app.address).href);
    await new FilmPage(page).begin();
  }
  for (const [page, name, other] of [
    [ab, "ab", cd],
    [cd, "cd", ab],
  ] as const) {
    const film = new FilmPage(page);
    await film.markSquare((await film.reading()).image);
    await film.finish();
    await expect(film.target).toContainText("Finished");
    await expect(other.getByText(`${name} has changed this study.`)).toBeVisible();
    const readings = other.getByRole("combobox", { name: "Reading" });
    await expect(
      readings.getByRole("option", { name: `${name}, reading 1, finished` }),
    ).toHaveCount(1);
  }
  await shot(ab, "people-heard");
  await expectSidesClear(ab, "cd has changed this study.");
  await onTablet(ab, () => expectSidesClear(ab, "cd has changed this study."));
}

/** Messages must not cover the film, and the side labels stay in the window. */
async function expectSidesClear(page: Page, told: string): Promise<void> {
  const message = (await page.getByText(told).boundingBox())!;
  const film = (await page.getByTestId("viewer").boundingBox())!;
  expect(message.y + message.height).toBeLessThanOrEqual(film.y);
  const sides = page.locator(".sides text");
  await expect(sides).toHaveCount(4);
  for (const side of await sides.all()) {
    const { x, width } = (await side.boundingBox())!;
    expect(x + width).toBeLessThanOrEqual(page.viewportSize()!.width);
  }
}

/** Both record a scale on the same revision of the film: the first is applied, the second is kept as a conflict. */
async function scaleAtOnce(ab: Page, cd: Page): Promise<void> {
  for (const [page, length_mm] of [
    [ab, "25"],
    [cd, "30"],
  ] as const) {
    await page.getByRole("button", { name: "Scale" }).click();
    const box = (await page.getByTestId("viewer").boundingBox())!;
    await page.mouse.click(box.x + box.width / 2, box.y + 200);
    await page.mouse.click(box.x + box.width / 2, box.y + 300);
    const dialog = page.getByRole("dialog", { name: /scale of this film/i });
    await dialog.getByLabel(/true diameter/i).fill(length_mm);
  }
  // The second is being sent while the first is recorded.
  let letGo = (): void => undefined;
  const recorded = new Promise<void>((resolve) => (letGo = resolve));
  await cd.route("**/edits", async (route) => {
    await recorded;
    await route.continue();
  });
  const sent = cd.waitForRequest("**/edits");
  const set = { name: /set the scale/i };
  await cd.getByRole("button", set).click();
  await sent;
  await ab.getByRole("button", set).click();
  await expect(ab.getByTestId("spacing")).toContainText("ball");
  const stands = await ab.getByTestId("spacing").innerText();
  letGo();

  const dialog = cd.getByRole("dialog", { name: /scale of this film/i });
  await expect(dialog.getByRole("alert")).toContainText(/not recorded/i);
  await shot(cd, "people-scale-lost");
  await dialog.getByRole("button", { name: "Cancel" }).click();
  await expect(cd.getByTestId("spacing")).toHaveText(stands);
  for (const page of [ab, cd]) {
    const lost = page.getByText(/lost changes of this study \(1\)/i);
    await lost.click();
    await expect(page.locator("details").filter({ has: lost })).toContainText("– cd,");
  }
  await shot(ab, "people-lost");
  await onTablet(cd, () => shot(cd, "people-lost-tablet"));
  const { body } = await get<Api<"StudyDetail">>(ab, `/api/studies/${SHARED}`);
  expect(body.conflicts).toHaveLength(1);
  expect(body.conflicts[0]).toMatchObject({ who: "cd", base_revision: 0, found_revision: 1 });
  const erect = body.summary.films.find(({ posture }) => posture === "erect");
  expect(erect).toMatchObject({ revision: 1, image: { spacing_text: stands } });
}

/** A reader lacks the controls that change a study, and the program refuses such requests. */
async function expectLooking(app: App, ef: Page): Promise<void> {
  await ef.goto(new URL(`#/studies/${SHARED}/measure`, app.address).href);
  await new FilmPage(ef).painted();
  await expect(
    ef.getByText("You can view this study, but you cannot edit its landmarks."),
  ).toBeVisible();
  for (const name of [/^start marking/i, /^scale$/i, /finish reading/i, /^mark$/i, /undo/i])
    await expect(ef.getByRole("button", { name })).toHaveCount(0);
  await shot(ef, "people-reader");
  const { body } = await get<Api<"StudyDetail">>(ef, `/api/studies/${SHARED}`);
  const { film, revision } = body.summary.films[0]!;
  const edit = { expected_revision: revision, edit: { kind: "inverted", inverted: true } };
  expect((await send(ef, "POST", `/api/films/${film}/edits`, edit)).status).toBe(403);
  expect((await send(ef, "POST", `/api/films/${film}/readings`, { repeat: 1 })).status).toBe(403);
  await ef.getByRole("link", { name: "Studies", exact: true }).click();
  await expect(ef.getByRole("article")).toContainText("Reader: view only");
  await expect(ef.getByRole("link", { name: "New study" })).toHaveCount(0);
}

/** Imports a phantom into the store under two names while the program is stopped. */
async function twoStudies(app: App): Promise<void> {
  const folder = await app.makePhantom("--subject", "1", "--pixel-size", "4");
  const file = path.join(folder, `${SHARED}.json`);
  const other = path.join(folder, "other.json");
  await writeFile(other, (await readFile(file, "utf8")).replaceAll(`"${SHARED}"`, `"${OTHER}"`));
  await app.addCases(file, other);
}

/** A separate browser context, signed in with an account. */
async function signedIn(browser: Browser, app: App, name: string): Promise<Page> {
  const page = await (await browser.newContext()).newPage();
  await usePages(page);
  await page.goto(app.address);
  await signIn(page, name);
  await expect(page.getByRole("heading", { name: "Studies", level: 1 })).toBeVisible();
  return page;
}

async function onTablet(page: Page, look: () => Promise<void>): Promise<void> {
  const before = page.viewportSize()!;
  await page.setViewportSize({ width: 768, height: 1024 });
  await look();
  await page.setViewportSize(before);
}
