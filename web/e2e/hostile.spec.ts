import { expect, shot, test } from "./app";
import { EVIL, expectHarmless, poisonAnswers } from "./hostile";
import { FilmPage } from "./marking";
import { requestsElsewhere } from "./wire";

test.use({ hasDemo: true });

test(
  "Measure and Model show hostile texts as text, and no request leaves the machine",
  { tag: "@long" },
  async ({ app, page }) => {
    test.setTimeout(240_000);
    const elsewhere = requestsElsewhere(page, app.address);
    const film = await FilmPage.ofDemo(app, page);

    // A note that a person writes, stored and returned by the program.
    const notes = page.locator("details").filter({ hasText: "Notes (" });
    for (const [index, text] of EVIL.entries()) {
      if (index === 0) await notes.getByText("Notes (0)").click();
      await notes.getByRole("textbox", { name: "New note" }).fill(text);
      await notes.getByRole("button", { name: "Add note" }).click();
      await film.saved();
    }
    await page.reload();
    await film.painted();
    await notes.getByText(`Notes (${EVIL.length})`).click();
    for (const text of EVIL)
      await expect(notes.getByRole("listitem").getByText(text)).toBeVisible();
    await shot(page, "hostile-notes");
    await expectHarmless(page);

    // Then every text of every answer.
    await poisonAnswers(page);
    await page.reload();
    await film.painted();
    await expect(page.getByRole("heading", { level: 1 })).toContainText("window.ran=1");
    await film.markSquare((await film.reading()).image);
    await expect(page.getByTestId("live-status")).toContainText("window.ran=1");
    await shot(page, "hostile-measure");
    await expectHarmless(page);

    // Without an own reading, the results of finished readings are drawn over the film.
    await page.getByRole("link", { name: /left bending/i }).click();
    await film.painted();
    await expect(page.getByTestId("findings")).toContainText("window.ran=1");
    await shot(page, "hostile-findings");
    await expectHarmless(page);

    await page.getByRole("link", { name: /^model/i }).click();
    await expect(page.getByRole("heading", { level: 1, name: /^Model/ })).toBeVisible();
    await page.getByRole("button", { name: "3D view" }).click();
    await expect(page.getByRole("application", { name: /three dimensions/ })).toBeVisible();
    for (const text of EVIL) await expect(page.getByText(text).first()).toBeAttached();
    await shot(page, "hostile-model");
    await expectHarmless(page);
    expect(elsewhere).toEqual([]);
  },
);
