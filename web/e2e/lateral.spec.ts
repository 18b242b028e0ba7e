import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";

import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import {
  expect,
  expectAccessible,
  expectReadable,
  onPhoneAndComputer,
  shot,
  test,
  type App,
} from "./app";
import { FilmPage } from "./marking";

const PATIENT = "phantom-rod-02";

type Place = [number, number];
type Vertebra = Record<
  "superior_left" | "superior_right" | "inferior_left" | "inferior_right",
  Place
>;
interface Film {
  posture: string;
  image: { columns: number; rows: number; file: string; sha256: string };
  readings: { observer: string; repeat: number; vertebrae: Record<string, Vertebra> }[];
}

/** A body seen from the side, as high as it is on the erect film. */
function fromTheSide(erect: Vertebra, columns: number, bend: number): Record<string, Place> {
  const { superior_left: a, superior_right: b, inferior_left: c, inferior_right: d } = erect;
  const [top, bottom] = [(a[1] + b[1]) / 2, (c[1] + d[1]) / 2];
  const half = 0.4 * Math.abs(a[0] - b[0]);
  const middle = columns / 2 + bend;
  return {
    superior_anterior: [middle - half, top],
    superior_posterior: [middle + half, top],
    inferior_anterior: [middle - half, bottom],
    inferior_posterior: [middle + half, bottom],
  };
}

/**
 * A study with a lateral film: it has the picture of another posture, because phantoms have no radiograph from the
 * side.
 */
async function withLateral(app: App, page: Page): Promise<void> {
  const folder = await app.makePhantom("--subject", "2", "--noise", "0", "--pixel-size", "2");
  const file = path.join(folder, `${PATIENT}.json`);
  const made = JSON.parse(await readFile(file, "utf8")) as { films: Film[] };
  const erect = made.films.find(({ posture }) => posture === "erect")!;
  const { image } = made.films.find(({ posture }) => posture === "neutral")!;
  const levels = Object.entries(erect.readings[0]!.vertebrae);
  const vertebrae = levels.map(([level, body], index) => [
    level,
    fromTheSide(body, image.columns, 0.06 * image.columns * Math.sin(index / 2.5)),
  ]);
  const lateral = {
    image: {
      columns: image.columns,
      rows: image.rows,
      patient_anterior: "image_left",
      file: image.file,
      sha256: image.sha256,
    },
    readings: [{ observer: "A", repeat: 1, vertebrae: Object.fromEntries(vertebrae) }],
  };
  const films = made.films.filter(({ posture }) => posture !== "neutral");
  await writeFile(file, JSON.stringify({ ...made, films, lateral }));
  await app.addCases(file);
  await app.start();
  await app.open(page);
}

/** What a complete lateral film does not show. */
const ASSUMED = "Arches and sizes from front to back are assumed.";

test("with a lateral film the model opens in 3D, and says what is assumed", async ({
  app,
  page,
}) => {
  await withLateral(app, page);
  await page.goto(new URL(`#/studies/${PATIENT}/model`, app.address).href);
  const view = page.getByRole("application", { name: "Spine in three dimensions" });
  await expect(view.getByText(/^Seen /)).toBeVisible();
  await onPhoneAndComputer(page, "lateral-model", async () => {
    await expectReadable(page.getByText(ASSUMED, { exact: true }));
    // Drawn in full after a rest.
    await page.waitForTimeout(1500);
  });
  await page.getByRole("button", { name: "Flat views" }).click();
  await expect(page.getByRole("img", { name: /^Sagittal/ })).toBeVisible();
  await expect(page.locator("polygon.assumed")).toHaveCount(0);
});

test("the spine in space names an unusable lateral film, also beside results of pedicles", async ({
  app,
  page,
}) => {
  await withLateral(app, page);
  await page.route("**/model", async (route) => {
    const answer = await route.fetch();
    const view = (await answer.json()) as Api<"ModelView">;
    const pitch_from = view.bodies.map(() => "population");
    await route.fulfill({ json: { ...view, pitch_from } });
  });
  await page.goto(new URL(`#/studies/${PATIENT}/films`, app.address).href);
  await page.getByLabel("Spine in space").check();
  await expect(page.getByText(/^The lateral film shows no two neighbouring/)).toBeVisible();
  await expect(page.getByText(/^Depth and arches are assumed/)).toBeVisible();
  await expect(page.getByText("Kyphosis").first()).toBeVisible();
});

test(
  "a lateral film beside the erect one: heights, the spine in space, corners and pedicles",
  { tag: "@long" },
  async ({ app, page }) => {
    await withLateral(app, page);
    await page.goto(new URL(`#/studies/${PATIENT}/films`, app.address).href);
    const [erect, lateral] = [
      page.getByRole("region", { name: "First film" }),
      page.getByRole("region", { name: "Second film" }),
    ];
    await expect(lateral.getByText("patient’s FRONT")).toBeVisible();
    await page.getByLabel("Show on both films").selectOption("T9");
    for (const film of [erect, lateral]) {
      await expect(film.locator('[data-height="T9"]')).toHaveCount(1);
      await expect(film.locator("[data-height]")).toHaveCount(1);
    }
    await page.getByLabel("Spine in space").check();
    await expect(page.getByText("Kyphosis").first()).toBeVisible();
    await expect(
      page.getByRole("application", { name: "Spine in three dimensions" }),
    ).toBeVisible();
    await expect(page.getByText(ASSUMED, { exact: true })).toBeVisible();
    await onPhoneAndComputer(page, "lateral", async (width) => {
      expect(await page.evaluate(() => document.scrollingElement!.scrollWidth)).toBe(width);
      // Both films fill the page below their tools.
      for (const film of [erect, lateral]) {
        const box = await film.getByRole("application").boundingBox();
        expect(box!.height).toBeGreaterThan(300);
      }
    });

    await page.goto(new URL(`#/studies/${PATIENT}/measure`, app.address).href);
    const films = page.getByRole("navigation", { name: "Films" });
    await films.getByRole("link", { name: /lateral/i }).click();
    const film = new FilmPage(page);
    await film.begin();
    await expect(film.target).toContainText("superior endplate, front");
    await expect(page.locator('[data-height="L4"]')).toHaveCount(0);
    const { columns, rows } = (await film.reading()).image;
    for (const [x, y] of [
      [-60, -40],
      [60, -40],
      [60, 40],
      [-60, 40],
    ] as const) {
      await film.click([columns / 2 + x, rows / 2 + y]);
    }
    await expect(film.target).toContainText("L3");
    await film.saved();
    const { vertebrae, faults } = await film.reading();
    expect(vertebrae[0]!.corners.map(({ corner }) => corner)).toContain("superior_anterior");
    expect(faults).toEqual([]);
    await expectAccessible(page);
    await shot(page, "lateral-marking");

    await films.getByRole("link", { name: /^erect/i }).click();
    await film.begin();
    await film.markSquare((await film.reading()).image);
    await page.getByRole("button", { name: /^Pedicles/ }).click();
    await expect(film.target).toContainText("pedicle, patient’s left");
    await film.click([columns / 2 - 60, rows / 2]);
    await expect(page.locator('[data-pedicle="L4.left"]')).toBeVisible();
    await film.saved();
  },
);
