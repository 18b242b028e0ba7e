import path from "node:path";

import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import {
  enterSide,
  expect,
  expectAccessible,
  runProgram,
  shot,
  signIn,
  test,
  usePages,
  type App,
} from "./app";
import { FilmPage } from "./marking";
import { answers, get } from "./wire";

const STUDY = "blind-1";
/** Texts that would reveal film, other readers or results to a blinded reader. */
const TELLING = /erect|bending|neutral|traction|"eve"|cobb|lenke|phantom-rod/i;

test(
  "a plan hides films, readers and results until all readings are finished",
  { tag: "@long" },
  async ({ app, page }) => {
    test.setTimeout(240_000);
    await app.open(page, "lead");
    await makeStudy(app, page);
    const films = (await get<Api<"StudyDetail">>(page, `/api/studies/${STUDY}`)).body.summary.films;
    // Another reader looks at the films while the plan is made.
    const early = await page.context().browser()!.newPage();
    await app.open(early, "bob");
    await early.goto(new URL(`#/studies/${STUDY}/measure`, app.address).href);
    await expect(early.getByRole("link", { name: /left bending/i })).toBeVisible();

    await page.getByRole("button", { name: "Plan blinded readings…" }).click();
    const plan = page.getByRole("dialog", { name: "Plan blinded readings" });
    await plan.getByLabel("Observers").fill("bob, eve");
    await plan.getByLabel("Readings per film").fill("1,5");
    await expect(plan).toContainText("A whole number from 1.");
    await expect(plan.getByRole("button", { name: "Make the plan" })).toBeDisabled();
    await plan.getByLabel("Readings per film").fill("1");
    await plan.getByLabel("Days between them").fill("0");
    await expect(plan).toContainText("4 readings");
    await expectAccessible(page);
    await shot(page, "blinded-plan");
    await plan.getByRole("button", { name: "Make the plan" }).click();
    await expect(plan).toBeHidden();
    await expect(page.getByRole("button", { name: "Plan blinded readings…" })).toHaveCount(0);
    // Until the first reading begins, the plan can be changed.
    await page.getByRole("button", { name: "Change the plan…" }).click();
    const change = page.getByRole("dialog", { name: "Change the plan" });
    await expect(change.getByLabel("Observers")).toHaveValue("bob, eve");
    await expect(change.getByRole("checkbox", { name: "Propose vertebrae" })).not.toBeChecked();
    await change.getByLabel("Readings per film").fill("2");
    await expect(change).toContainText("8 readings");
    await change.getByLabel("Readings per film").fill("1");
    await change.getByRole("checkbox", { name: "Propose vertebrae" }).check();
    await shot(page, "blinded-plan-change");
    await change.getByRole("button", { name: "Change the plan" }).click();
    await expect(change).toBeHidden();
    // The open page gets the change, and shows the reading under a code, also in its address.
    await expect(early.getByRole("heading", { name: /^next film/i })).toBeVisible();
    await expect(early).toHaveURL(new RegExp(`#/studies/${STUDY}/read$`));
    await early.goto(new URL(`#/studies/${STUDY}/measure`, app.address).href);
    await expect(early.getByRole("heading", { name: /^next film/i })).toBeVisible();
    await early.close();

    const bob = await page.context().browser()!.newPage();
    const told = answers(bob);
    await app.open(bob, "bob");
    const row = bob.getByRole("article").filter({ hasText: STUDY });
    await expect(row).toContainText(
      "blinded readings: results are shown when all planned readings are finished",
    );
    await expect(row.getByRole("img")).toHaveCount(0);
    await shot(bob, "blinded-list");
    await row.getByRole("link", { name: `Read ${STUDY}` }).click();
    await shot(bob, "blinded-next");
    const first = await beginNext(bob);
    const film = new FilmPage(bob);
    await film.painted();
    await film.markSquare(await image(film));
    await shot(bob, "blinded-reading");

    // A reload continues with the same film.
    await bob.reload();
    await expect(bob.getByRole("heading", { name: `Film ${first}` })).toBeVisible();
    await expect(film.target).toContainText("L3");
    const addresses = forbidden(films);
    for (const address of addresses) {
      const { status, body } = await get(bob, address);
      expect([403, 404], address).toContain(status);
      expect(JSON.stringify(body), address).not.toMatch(TELLING);
    }
    await film.finish();
    const second = await beginNext(bob);
    expect(second).not.toBe(first);
    await film.painted();
    // A reading with an incomplete vertebra cannot be finished, and the vertebra is named.
    await film.viewer.focus();
    await bob.keyboard.press("c");
    await bob.keyboard.press("Enter");
    await film.saved();
    await bob.getByRole("button", { name: /finish reading/i }).click();
    const dialog = bob.getByRole("dialog", { name: /finish this reading/i });
    await expect(dialog.getByRole("button", { name: "Finish", exact: true })).toBeDisabled();
    await expect(dialog).toContainText("Half placed: L4");
    await shot(bob, "blinded-finish-refused");
    await dialog.getByRole("button", { name: "Continue reading" }).click();
    await bob.getByRole("button", { name: "Undo" }).click();
    await film.saved();
    await bob.getByRole("button", { name: /finish reading/i }).click();
    await expect(dialog.getByRole("button", { name: "Finish", exact: true })).toBeDisabled();
    await expect(dialog).toContainText("No vertebra is marked.");
    await dialog.getByRole("button", { name: "Continue reading" }).click();
    await film.markSquare(await image(film));
    await film.finish();
    await expect(bob.getByRole("heading", { name: /all films are read/i })).toBeVisible();
    // A finished reading does not reveal films that others have not finished.
    await bob.getByRole("link", { name: "Studies", exact: true }).click();
    await expect(row).toContainText(
      "blinded readings: results are shown when all planned readings are finished",
    );
    for (const address of addresses) {
      expect([403, 404], address).toContain((await get(bob, address)).status);
    }
    expect(told.texts.length).toBeGreaterThan(8);
    for (const { address, text } of await told.read()) expect(text, address).not.toMatch(TELLING);
    expect(told.kinds.has("image/png")).toBe(false);

    const eve = await page.context().browser()!.newPage();
    await app.open(eve, "eve");
    await eve.getByRole("link", { name: `Read ${STUDY}` }).click();
    for (const earlier of [first, second]) {
      expect(await beginNext(eve)).not.toBe(earlier);
      const film = new FilmPage(eve);
      await film.painted();
      await film.markSquare(await image(film));
      await film.finish();
    }
    await expect(eve.getByRole("heading", { name: /all films are read/i })).toBeVisible();
    // All readings are finished: postures and readings are visible, without a new sign-in.
    await bob.reload();
    await row.getByRole("link", { name: `Measure ${STUDY}` }).click();
    await expect(bob.getByRole("link", { name: /left bending/i })).toBeVisible();
    const { body } = await get<Api<"StudyDetail">>(bob, `/api/studies/${STUDY}`);
    expect(body.plan?.blinded).toBe(false);
    expect(body.summary.films.flatMap(({ readings }) => readings)).toHaveLength(4);
    await shot(bob, "blinded-open");
    await bob.close();
    await eve.close();
  },
);

test(
  "an admin chooses the observers among the accounts that may read",
  { tag: "@long" },
  async ({ app, page }) => {
    await app.open(page, "lead");
    await makeStudy(app, page);
    await app.kill();
    for (const [name, role] of [
      ["lead", "admin"],
      ["anna", "editor"],
      ["ben", "editor"],
      ["carl", "reader"],
    ] as const) {
      await app.addAccount(name, role);
    }
    await runProgram("account", "grant", "anna", STUDY, "--role", "editor", app.store);
    await app.start("--accounts");
    const signedIn = async (name: string): Promise<Page> => {
      const page_ = await page.context().browser()!.newPage();
      await usePages(page_);
      await page_.goto(new URL(`#/studies/${STUDY}/measure`, app.address).href);
      await signIn(page_, name);
      return page_;
    };
    const [lead, anna] = [await signedIn("lead"), await signedIn("anna")];
    await expect(anna.getByRole("link", { name: /left bending/i })).toBeVisible();
    await expect(anna.getByRole("button", { name: "Plan blinded readings…" })).toHaveCount(0);

    await lead.getByRole("button", { name: "Plan blinded readings…" }).click();
    const plan = lead.getByRole("dialog", { name: "Plan blinded readings" });
    for (const unable of ["ben", "carl"]) {
      await expect(plan.getByRole("checkbox", { name: unable })).toBeDisabled();
    }
    await plan.getByRole("checkbox", { name: "anna" }).check();
    await expect(plan).toContainText("4 readings");
    await shot(lead, "blinded-plan-accounts");
    await plan.getByRole("button", { name: "Make the plan" }).click();
    await expect(plan).toBeHidden();
    await expect(anna.getByRole("heading", { name: /^next film/i })).toBeVisible();
    for (const one of [lead, anna]) await one.context().close();
  },
);

/** Two films of a phantom, dropped on the page. */
async function makeStudy(app: App, page: Page): Promise<void> {
  const phantom = await app.makePhantom("--subject", "1", "--pixel-size", "4");
  await page.getByRole("link", { name: "New study" }).first().click();
  const files = ["erect", "left_bending"].map((posture) =>
    path.join(phantom, `phantom-rod-01-${posture}.dcm`),
  );
  await page.locator("input[type=file]").setInputFiles(files);
  await expect(page.getByLabel("Posture")).toHaveCount(2, { timeout: 60_000 });
  for (const film of await page.getByRole("article").all()) await enterSide(film);
  await page.getByRole("textbox", { name: "Identifier" }).fill(STUDY);
  await page.getByRole("button", { name: "Create the study" }).click();
  await expect(page).toHaveURL(new RegExp(`#/studies/${STUDY}/measure`), { timeout: 60_000 });
}

/** Begins the next film and returns its code. */
async function beginNext(page: Page): Promise<string> {
  const heading = page.getByRole("heading", { name: /next film/i });
  await expect(heading).toBeVisible();
  const code = /[A-Z2-9]{6}$/.exec((await heading.innerText()).trim())![0];
  await page.getByRole("button", { name: "Begin" }).click();
  await expect(page.getByRole("heading", { name: `Film ${code}` })).toBeVisible();
  return code;
}

/** Picture of the current reading. */
async function image(film: FilmPage): Promise<Api<"FilmImage">> {
  const next = (await film.detail()).plan?.next;
  if (next?.kind !== "continue") throw new Error("no reading was begun");
  return (await film.get<Api<"ReadingView">>(`/api/readings/${next.reading}`)).image;
}

/** Values that reveal more about a study and its films than their codes. */
function forbidden(films: Api<"FilmSummary">[]): string[] {
  const ofStudy = [
    "findings",
    "model",
    "exports/analysis",
    "exports/report",
    "case",
    "reliability",
  ];
  return [
    ...ofStudy.map((what) => `/api/studies/${STUDY}/${what}`),
    ...films.flatMap(({ film }) => [
      `/api/studies/${STUDY}/films/${film}/overlay`,
      `/api/films/${film}/pixels`,
      `/api/films/${film}/thumbnail`,
    ]),
  ];
}

test.describe("of the demo", () => {
  test.use({ hasDemo: true });
  test(
    "a reader who has finished sees so, and a reader who must wait sees until when",
    { tag: "@long" },
    async ({ app, page }) => {
      await FilmPage.ofDemo(app, page);
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
    },
  );
});
