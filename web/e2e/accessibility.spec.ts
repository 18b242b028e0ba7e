import { expect, expectAccessible, test, usePages } from "./app";
import { answerWith, cohort, manyStudies, study, uploads } from "./made";

test("signing in", async ({ app, page }) => {
  await usePages(page);
  await page.goto(app.address);
  await expect(page.getByLabel("Your reader name")).toBeVisible();
  await expectAccessible(page);
  await page.goto("about:blank");
  await page.goto(new URL("/", app.address).href);
  await expect(page.getByLabel("Address that the program printed")).toBeVisible();
  await expectAccessible(page);
});

test("studies: none, many, none found", async ({ app, page }) => {
  await answerWith(page, "/api/studies", []);
  await app.open(page);
  await expect(page.getByRole("heading", { name: "No study yet" })).toBeVisible();
  await expectAccessible(page);
  await answerWith(page, "/api/studies", manyStudies(14));
  await page.reload();
  await expect(page.getByRole("article")).toHaveCount(14);
  await expectAccessible(page);
  await page.getByRole("searchbox").fill("missing study");
  await expectAccessible(page);
});

test("a new study: no films, then films with open questions", async ({ app, page }) => {
  const answers = uploads();
  let next = 0;
  await page.route("**/api/uploads", (route) => {
    const answer = answers[next++ % answers.length];
    return route.fulfill({ json: answer, status: answer && "code" in answer ? 422 : 200 });
  });
  await app.openAt(page, "#/new");
  await expectAccessible(page);
  const files = ["a.dcm", "b.dcm", "c.png", "d.dcm", "e.dcm"];
  await page
    .locator("input[type=file]")
    .setInputFiles(
      files.map((name) => ({ name, mimeType: "image/png", buffer: Buffer.from("x") })),
    );
  await expect(page.getByRole("article")).toHaveCount(5);
  await page.getByRole("radio", { name: "entered by hand" }).first().check();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Create the study" }).click();
  await expect(page.getByText(/To do:/)).toBeVisible();
  await expectAccessible(page);
});

test("the import of a case", async ({ app, page }) => {
  await app.openAt(page, "#/import");
  const films = [{ image: { file: "erect.dcm" } }];
  const text = JSON.stringify({ format: "spineline-case", films });
  await page
    .locator("input[type=file]")
    .setInputFiles([
      { name: "case.json", mimeType: "application/json", buffer: Buffer.from(text) },
    ]);
  await expect(page.getByText("missing: drop it here")).toBeVisible();
  await expectAccessible(page);
});

test("the cohort", async ({ app, page }) => {
  await answerWith(page, "/api/cohort", cohort());
  await app.openAt(page, "#/cohort");
  await expect(page.locator("svg.chart")).toHaveCount(3);
  await expectAccessible(page);
});

test("access, with accounts and without", async ({ app, page }) => {
  await app.openAt(page, "#/access");
  await expect(page.getByText("spineline account add")).toBeVisible();
  await expectAccessible(page);
  const session = { name: "lead", role: "admin", access: "accounts", csrf: "0", version: "0.1.0" };
  await answerWith(page, "/api/session", session);
  await answerWith(page, "/api/studies", [study("S-003")]);
  await answerWith(page, "/api/accounts", [
    { name: "lead", role: "admin", enabled: true },
    { name: "ab", role: "editor", enabled: false },
  ]);
  await answerWith(page, "/api/studies/S-003/grants", []);
  await page.reload();
  await page.getByRole("combobox", { name: "Study", exact: true }).selectOption("S-003");
  await expect(page.getByLabel("Permission of ab for S-003")).toBeVisible();
  await expectAccessible(page);
  await page.getByRole("button", { name: "Add an account" }).click();
  await expect(page.getByRole("dialog", { name: "New account" })).toBeVisible();
  await expectAccessible(page);
});

test("signing in again, and a program that does not answer", async ({ app, page }) => {
  await app.open(page);
  await answerWith(page, "/api/cohort", { code: "not_signed_in", message: "not signed in" }, 401);
  await page.getByRole("link", { name: "Cohort" }).click();
  const dialog = page.getByRole("dialog", { name: "Sign in again" });
  await expect(dialog).toBeVisible();
  await expectAccessible(page);
  await app.kill();
  await dialog.getByLabel("Address that the program printed").fill(app.address);
  await dialog.getByRole("button", { name: /and continue/ }).click();
  await expect(page.getByText("The program does not answer.")).toBeVisible();
  await expectAccessible(page);
});

test("the evidence and the model options of a study without results", async ({ app, page }) => {
  const refusal = { code: "not_ready", message: "the erect film is missing" };
  await answerWith(page, "/api/studies/S-1/lines", refusal, 409);
  await answerWith(page, "/api/studies/S-1/model", refusal, 409);
  await app.openAt(page, "#/studies/S-1/evidence");
  await expect(page.getByRole("alert")).toContainText("the erect film is missing");
  await expectAccessible(page);
  await page.goto(new URL("#/studies/S-1/model", app.address).href);
  await page.getByRole("button", { name: "Model options…" }).click();
  await expect(page.getByRole("dialog").getByRole("alert")).toBeVisible();
  await expectAccessible(page);
});
