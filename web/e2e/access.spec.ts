import { DEMO, PASSWORD, expect, shot, signIn, test, usePages } from "./app";
import { answerWith, study } from "./made";

const LEAD = {
  name: "lead",
  role: "admin",
  access: "accounts",
  csrf: "0123",
  version: "0.1.0",
} as const;

test("the printed address signs in under the reader's name", async ({ app, page }) => {
  await usePages(page);
  await page.goto(app.address);
  await expect(page.getByLabel("Your reader name")).toBeVisible();
  expect(new URL(page.url()).hash).toBe("");
  await shot(page, "sign-in");
  await page.getByLabel("Your reader name").fill("reader-1");
  await page.getByRole("button", { name: "Open the studies" }).click();
  await expect(page.getByRole("banner")).toContainText("reader-1");
  await expect(page.getByText("Research use only — not a medical device")).toBeVisible();
  await page.getByRole("button", { name: "Sign out" }).click();
  await expect(page.getByLabel("Your reader name")).toHaveValue("reader-1");
});

test("without a valid token the page says where to find the address", async ({ app, page }) => {
  await usePages(page);
  await page.goto(new URL("/", app.address).href);
  await expect(page.getByText("Find the address in the terminal")).toBeVisible();
  await page.getByLabel("Your reader name").fill("reader-1");
  await page
    .getByLabel("Address that the program printed")
    .fill(`http://x/#token=${"0".repeat(48)}`);
  await page.getByRole("button", { name: "Open the studies" }).click();
  await expect(page.getByRole("alert")).toBeVisible();
  await shot(page, "sign-in-wrong-token");
  await page.getByLabel("Address that the program printed").fill(app.address);
  await page.getByRole("button", { name: "Open the studies" }).click();
  await expect(page.getByRole("heading", { name: "Studies", level: 1 })).toBeVisible();
});

test("a new sign-in after the end of a session keeps the page", async ({ app, page }) => {
  await app.openAt(page, "#/new");
  await answerWith(page, "/api/uploads", { code: "not_signed_in", message: "not signed in" }, 401);
  await page
    .locator("input[type=file]")
    .setInputFiles([{ name: "erect.png", mimeType: "image/png", buffer: Buffer.from("x") }]);
  const dialog = page.getByRole("dialog", { name: "Sign in again" });
  await expect(dialog).toBeVisible();
  await page.keyboard.press("Escape");
  await expect(dialog).toBeVisible();
  await shot(page, "sign-in-again");
  await dialog.getByLabel("Address that the program printed").fill(app.address);
  await dialog.getByRole("button", { name: /and continue/ }).click();
  await expect(dialog).toBeHidden();
  await expect(page.getByRole("heading", { name: "erect.png" })).toBeVisible();
});

test("the page waits for a stopped program and continues by itself", async ({ app, page }) => {
  await app.open(page);
  await app.kill();
  await page.getByRole("link", { name: "Cohort" }).click();
  const banner = page.getByRole("status").filter({ hasText: "The program does not answer" });
  await expect(banner).toBeVisible();
  // It does not cover the links to other pages.
  await page.getByRole("link", { name: "Access" }).click();
  await expect(page).toHaveURL(/access/);
  await shot(page, "program-gone");
  await app.start();
  await expect(banner).toBeHidden({ timeout: 30_000 });
});

test("without accounts the page says how to add them", async ({ app, page }) => {
  await app.open(page);
  await page.getByRole("link", { name: "Access" }).click();
  await expect(page.getByText("spineline account add")).toBeVisible();
  await shot(page, "access-token");
});

test("accounts sign in with a password", async ({ app, page }) => {
  await answerWith(page, "/api/sign-in", { access: "accounts", version: "0.1.0" });
  await usePages(page);
  await page.goto(new URL("/", app.address).href);
  await page.getByRole("textbox", { name: "Account" }).fill("lead");
  await page.getByLabel("Password", { exact: true }).fill("not the right one");
  await page.getByRole("button", { name: "Sign in" }).click();
  await expect(page.getByRole("alert")).toBeVisible();
  await expect(page.getByLabel("Password")).toHaveValue("");
  await shot(page, "sign-in-account");
});

test("the last admin stays admin, and the page gives the reason", async ({ app, page }) => {
  await answerWith(page, "/api/session", LEAD);
  await answerWith(page, "/api/studies", [study("S-003")]);
  await answerWith(page, "/api/accounts", [
    { name: "lead", role: "admin", enabled: true },
    { name: "ab", role: "editor", enabled: true },
    { name: "guest", role: "reader", enabled: false },
  ]);
  const last = { code: "last_admin", message: "lead is the last admin that may sign in" };
  await answerWith(page, "/api/accounts/lead", last, 409);
  await usePages(page);
  await page.goto(new URL("#/access", app.address).href);
  await page.getByLabel("Role of lead").selectOption("Reader");
  await expect(page.getByRole("alert")).toContainText("lead is the last admin");
  await expect(page.getByLabel("Role of lead")).toHaveValue("admin");
  await shot(page, "access-last-admin");
});

test("people change their own password", async ({ app, page }) => {
  await answerWith(page, "/api/session", { ...LEAD, name: "ab", role: "reader" });
  await answerWith(page, "/api/studies", [study("S-003")]);
  await usePages(page);
  await page.goto(app.address);
  await page.getByRole("button", { name: /^ab ?: change your password$/ }).click();
  const dialog = page.getByRole("dialog", { name: "Your password" });
  await dialog.getByLabel("Current password").fill("the one from the admin");
  await dialog.getByLabel("Password", { exact: true }).fill("aaaaaaaaaaaa");
  await dialog.getByLabel("Repeat the password").fill("aaaaaaaaaaaa");
  const weak = { code: "bad_password", message: "the password has 1 different character" };
  await answerWith(page, "/api/session/password", weak, 422);
  await dialog.getByRole("button", { name: "Change the password" }).click();
  await expect(dialog.getByRole("alert")).toContainText("1 different character");
  await expect(dialog.getByLabel("Repeat the password")).toHaveValue("");
  await shot(page, "own-password");

  await dialog.getByLabel("Current password").fill("the one from the admin");
  await dialog.getByLabel("Password", { exact: true }).fill("a sentence of my own");
  await dialog.getByLabel("Repeat the password").fill("a sentence of my own");
  await answerWith(page, "/api/session/password", { ...LEAD, name: "ab", role: "reader" });
  const sent = page.waitForRequest("**/api/session/password");
  await dialog.getByRole("button", { name: "Change the password" }).click();
  expect((await sent).postDataJSON()).toEqual({
    current: "the one from the admin",
    password: "a sentence of my own",
  });
  await expect(dialog).toBeHidden();
});

test("admins add accounts and grant studies", async ({ app, page }) => {
  await answerWith(page, "/api/session", LEAD);
  await answerWith(page, "/api/studies", [study("S-003")]);
  await answerWith(page, "/api/accounts", [
    { name: "lead", role: "admin", enabled: true },
    { name: "ab", role: "editor", enabled: true },
  ]);
  await answerWith(page, "/api/studies/S-003/grants", []);
  await usePages(page);
  await page.goto(new URL("#/access", app.address).href);

  await page.getByRole("button", { name: "Add an account" }).click();
  const dialog = page.getByRole("dialog", { name: "New account" });
  await dialog.getByLabel("Name").fill("cd");
  await dialog.getByLabel("Role").selectOption("Editor");
  await dialog.getByLabel("Password", { exact: true }).fill("too short");
  await expect(dialog.getByText(/at least 12 characters/)).toBeVisible();
  await shot(page, "access-add");
  await dialog.getByLabel("Password", { exact: true }).fill("long enough for anyone");
  await dialog.getByLabel("Repeat the password").fill("long enough for anyone");
  const added = page.waitForRequest("**/api/accounts/cd");
  await answerWith(page, "/api/accounts/cd", { name: "cd", role: "editor", enabled: true });
  await dialog.getByRole("button", { name: "Add the account" }).click();
  expect((await added).postDataJSON()).toMatchObject({ role: "editor", enabled: true });
  await expect(dialog).toBeHidden();

  await page.getByRole("combobox", { name: "Study", exact: true }).selectOption("S-003");
  const granted = page.waitForRequest(
    (request) => request.method() === "PUT" && request.url().endsWith("/grants"),
  );
  await page.getByLabel("Permission of ab for S-003").selectOption("Editor: view and edit");
  expect((await granted).postDataJSON()).toEqual([{ name: "ab", role: "editor" }]);
  await shot(page, "access");
});

test.describe("with a study", () => {
  test.use({ hasDemo: true });

  test(
    "accounts on the real program: the admin adds an editor and grants one study",
    { tag: "@long" },
    async ({ app, page }) => {
      await app.kill();
      await app.addAccount("lead", "admin");
      await app.start("--accounts");
      await usePages(page);

      const enter = async (name: string): Promise<void> => {
        await signIn(page, name);
        await expect(page.getByRole("heading", { name: "Studies", level: 1 })).toBeVisible();
      };
      await page.goto(app.address);
      await enter("lead");
      await page.getByRole("link", { name: "Access" }).click();
      await page.getByLabel("lead may sign in").uncheck();
      await expect(page.getByRole("alert")).toBeVisible();
      await expect(page.getByLabel("lead may sign in")).toBeChecked();
      await page.getByRole("button", { name: "Add an account" }).click();
      const dialog = page.getByRole("dialog", { name: "New account" });
      await dialog.getByLabel("Name").fill("ab");
      await dialog.getByLabel("Role").selectOption("Editor");
      await dialog.getByLabel("Password", { exact: true }).fill(PASSWORD);
      await dialog.getByLabel("Repeat the password").fill(PASSWORD);
      await dialog.getByRole("button", { name: "Add the account" }).click();
      await expect(page.getByRole("rowheader", { name: "ab", exact: true })).toBeVisible();
      await shot(page, "access-accounts");

      // Before the grant the editor sees nothing, after it the granted study.
      const signOut = page.getByRole("button", { name: "Sign out" });
      await signOut.click();
      await enter("ab");
      await expect(page.getByRole("heading", { name: "No study yet" })).toBeVisible();
      await expect(page.getByRole("link", { name: "Access" })).toBeHidden();
      await signOut.click();
      await enter("lead");
      await page.getByRole("link", { name: "Access" }).click();
      await page.getByRole("combobox", { name: "Study", exact: true }).selectOption(DEMO);
      await page.getByLabel(`Permission of ab for ${DEMO}`).selectOption("Reader: view only");
      await signOut.click();
      await enter("ab");
      await expect(page.getByRole("article")).toContainText("Reader: view only");
    },
  );
});
