import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import { expect, expectAccessible, expectReadable, shot, test } from "./app";
import { FilmPage, LEVELS, farthest } from "./marking";

test.use({ hasDemo: true });

/** Makes found vertebrae uncertain: on the films of the demo, all are clear. */
async function blur(page: Page, isBlurred: (level: string) => boolean): Promise<void> {
  await page.route(/\/detection$/, async (route) => {
    const response = await route.fetch();
    const seen = (await response.json()) as Api<"DetectionView">;
    const proposals = seen.proposals.map((one) =>
      isBlurred(one.level) ? { ...one, is_sure: false } : one,
    );
    await route.fulfill({ response, json: { ...seen, proposals } });
  });
}

/** A film whose vertebrae are found. */
async function proposed(film: FilmPage): Promise<void> {
  await film.viewer.focus();
  await film.page.keyboard.press("p");
  await expect(film.target).toContainText("were found clearly");
}

test("one key accepts what was found clearly, undo takes it back, and two clicks mark the rest", async ({
  app,
  page,
}) => {
  const left = ["L1", "T6", "T5", "T2"];
  await blur(page, (level) => left.includes(level));
  const film = await FilmPage.ofDemo(app, page);
  const truth = await film.truth();
  const drawn = page.locator("[data-proposal]");
  const toCheck = page.getByRole("button", { name: "proposed, to be checked" });
  let actions = 1;
  await proposed(film);
  await expect(film.target).toContainText("12 of 16 vertebrae");
  await expectReadable(film.target.locator("p"));
  await expectReadable(page.getByRole("button", { name: "Accept 12 vertebrae" }));
  await expect(page.getByTestId("faults")).toContainText("Check the levels first");
  await expect(drawn.filter({ hasText: "?" })).toHaveCount(left.length);
  await expect(toCheck).toHaveCount(left.length);
  await expectAccessible(page);
  await shot(page, "found");
  // A vertebra that a person chooses is asked for.
  await page.getByRole("button", { name: /^T9/ }).click();
  await expect(film.target).toContainText("T9");
  await page.keyboard.press("p");
  await expect(drawn).toHaveCount(0);
  await proposed(film);

  const accepted = async (): Promise<string[]> => {
    await film.saved();
    const { vertebrae } = await film.reading();
    return vertebrae.filter(({ complete }) => complete).map(({ level }) => level);
  };
  await page.keyboard.press("a");
  actions += 1;
  await expect(drawn).toHaveCount(left.length);
  expect(await accepted()).toHaveLength(12);
  await page.keyboard.press("Control+z");
  await expect(drawn).toHaveCount(16);
  expect(await accepted()).toEqual([]);
  await page.keyboard.press("a");
  await expect(drawn).toHaveCount(left.length);

  // The clicks replace what was found, whose deviation stays with those that are left.
  for (const level of left) {
    await film.markWalls(truth, level);
    actions += 2;
    if (level !== "L1") continue;
    await film.saved();
    await expect(page.getByRole("button", { name: "Accept L1" })).toBeVisible();
    await expect(page.locator('[data-proposal="L1"]')).not.toContainText("?");
    await expect(toCheck).toHaveCount(left.length - 1);
    await shot(page, "found-left");
  }
  await film.saved();
  await page.keyboard.press("Enter");
  actions += 1;
  await expect(drawn).toHaveCount(0);
  expect(await accepted()).toEqual(expect.arrayContaining([...LEVELS]));
  const whole = await film.reading();
  const vertebrae = whole.vertebrae.filter(({ level }) => LEVELS.includes(level as never));
  expect(farthest({ ...whole, vertebrae }, truth)).toBeLessThan(60);
  // By hand, the same film takes 32: T, two clicks on each of 15 vertebrae, and Enter.
  expect(actions).toBe(11);
});

test("where few vertebrae are clear, the page says that two clicks is faster, and P discards", async ({
  app,
  page,
}) => {
  const clear = ["L4", "L3", "T9", "T8", "T7"];
  await blur(page, (level) => !clear.includes(level));
  const film = await FilmPage.ofDemo(app, page);
  await proposed(film);
  await expect(film.target).toHaveText(
    /Two clicks is faster on this film: 5 of 16 vertebrae were found clearly/,
  );
  await expectReadable(film.target.locator("p"));
  await expectAccessible(page);
  await shot(page, "found-few");
  await page.getByRole("button", { name: "Discard proposals" }).click();
  await expect(page.locator("[data-proposal]")).toHaveCount(0);
  await expect(film.target).toContainText("L4");
  await expect(film.target).toContainText("middle of the wall, patient’s left");
  await expect(page.getByTestId("faults")).toBeEmpty();
});
