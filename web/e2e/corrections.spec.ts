import type { Api } from "../src/api/types";
import { DEMO, expect, expectAccessible, shot, test } from "./app";
import { FilmPage, cornerOf, farthest } from "./marking";

type ReadingView = Api<"ReadingView">;

test.use({ hasDemo: true });

/** Half a pixel of the screen on the film. */
const CLOSE_PX = 2;

/** A finished reading of the demo's erect film, with T6 tilted: its left corners lie 60 px lower. */
async function tilted(film: FilmPage): Promise<ReadingView> {
  const truth = await film.truth();
  const levels = truth.vertebrae.map(({ level }) => level);
  await film.record(levels, (level, corner) => {
    const [column, row] = cornerOf(truth, level, corner);
    const isLower = level === "T6" && corner.endsWith("left");
    return [column, isLower ? row + 60 : row];
  });
  await expect(film.target).not.toContainText("L4");
  await film.finish();
  await expect(film.target).toContainText("Finished");
  return truth;
}

test("a finished reading is corrected by a copy, which replaces it", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  const truth = await tilted(film);
  await page.getByRole("button", { name: "Correct this reading" }).click();
  await expect(film.target).toContainText("T1");
  const choice = page.getByRole("combobox", { name: "Reading" });
  await expect(choice.getByRole("option", { selected: true })).toHaveText(
    "tester, reading 1, correction",
  );
  for (const corner of ["superior_left", "inferior_left"] as const) {
    const place = cornerOf(truth, "T6", corner);
    await film.lookAt(place, 1);
    await film.drag([place[0], place[1] + 60], place);
    await film.saved();
  }
  await page.getByRole("button", { name: /finish reading/i }).click();
  const dialog = page.getByRole("dialog", { name: /finish this reading/i });
  await expect(dialog).toContainText("This correction replaces the reading that it corrects");
  await shot(page, "correction-finish");
  await dialog.getByRole("button", { name: "Finish", exact: true }).click();
  await expect(film.target).toContainText("Finished");
  expect(farthest(await film.reading(), truth)).toBeLessThan(CLOSE_PX);
  await expect(choice.getByRole("option", { name: "tester, reading 1, replaced" })).toHaveCount(1);
  await expect(
    choice.getByRole("option", { name: "tester, reading 1, correction, finished" }),
  ).toHaveCount(1);
  await choice.selectOption("tester, reading 1, replaced");
  await expect(film.target).toContainText("Withdrawn");
  await expect(page.getByText("Replaced by its correction")).toBeVisible();
  await expect(page.getByRole("button", { name: "Correct this reading" })).toHaveCount(0);
  await shot(page, "correction-replaced");
});

test("a finished reading is withdrawn with a reason", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  await tilted(film);
  await page.getByRole("button", { name: "Withdraw…" }).click();
  const dialog = page.getByRole("dialog", { name: "Withdraw this reading?" });
  await expect(dialog.getByRole("button", { name: "Withdraw", exact: true })).toBeDisabled();
  await dialog.getByLabel("Reason").fill("T6 is tilted");
  await expectAccessible(page);
  await shot(page, "withdraw");
  await dialog.getByRole("button", { name: "Withdraw", exact: true }).click();
  await expect(dialog).toBeHidden();
  await expect(film.target).toContainText("Withdrawn");
  await expect(page.getByRole("status").filter({ hasText: "T6 is tilted" })).toContainText(
    "tester",
  );
  await expectAccessible(page);
  await shot(page, "withdrawn");
  await page.getByRole("button", { name: "Read again" }).click();
  await expect(film.target).toContainText("L4");
});

test("a study is renamed, archived, hidden and restored", async ({ app, page }) => {
  const film = await FilmPage.ofDemo(app, page);
  const dialog = page.getByRole("dialog", { name: `Edit ${DEMO}` });
  const edit = page.getByRole("button", { name: "Edit this study…" });
  await edit.click();
  await dialog.getByLabel("Label").fill("before brace");
  await expectAccessible(page);
  await shot(page, "edit-study");
  await dialog.getByRole("button", { name: "Change the study" }).click();
  await expect(page.getByRole("heading", { name: "before brace" })).toBeVisible();
  await edit.click();
  await dialog.getByRole("checkbox", { name: "Archived" }).check();
  await dialog.getByRole("button", { name: "Change the study" }).click();
  await expect(page.getByText("Archived: restore the study to change it.")).toBeVisible();
  await expect(page.getByRole("link", { name: "Add films…" })).toHaveCount(0);
  await expect(page.getByRole("button", { name: "Edit this film…" })).toHaveCount(0);
  // A click in a window that was open is held with the reason, and kept.
  await film.viewer.focus();
  await page.keyboard.press("c");
  await page.keyboard.press("Enter");
  await expect(page.getByTestId("saving")).toContainText("1 not saved");
  await shot(page, "archived-measure");

  await page.getByRole("link", { name: "Studies", exact: true }).click();
  await expect(page.getByRole("heading", { name: "No study matches" })).toBeVisible();
  await expect(page.getByText("Every study is archived.")).toBeVisible();
  await page.getByRole("checkbox", { name: "Archived (1)" }).check();
  const row = page.getByRole("article").filter({ hasText: DEMO });
  await expect(row).toContainText("Archived");
  await expectAccessible(page);
  await shot(page, "archived-list");
  await row.getByRole("link", { name: `Measure ${DEMO}` }).click();
  await edit.click();
  await dialog.getByRole("checkbox", { name: "Archived" }).uncheck();
  await dialog.getByRole("button", { name: "Change the study" }).click();
  await expect(page.getByText("Archived: restore the study to change it.")).toHaveCount(0);
  await film.saved();
  expect((await film.reading()).vertebrae).toHaveLength(1);
});
