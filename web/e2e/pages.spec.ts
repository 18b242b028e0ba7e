import { crc32, deflateSync } from "node:zlib";

import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";
import { DEMO, expect, expectAccessible, shot, test, type App } from "./app";
import { answerWith, cohort } from "./made";
import { LEVELS } from "./marking";
import { loadAnswer, modelView } from "./model.fixture";
import { get, send } from "./wire";

test.use({ hasDemo: true });

const BROKEN = "This page could not be shown";

/** An 8-bit grey PNG of one brightness, which states nothing about its patient. */
function png(columns: number, rows: number): Buffer {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(columns, 0);
  header.writeUInt32BE(rows, 4);
  header.set([8, 0, 0, 0, 0], 8);
  const pixels = deflateSync(Buffer.alloc((columns + 1) * rows, 0));
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  return Buffer.concat([
    signature,
    chunk("IHDR", header),
    chunk("IDAT", pixels),
    chunk("IEND", Buffer.alloc(0)),
  ]);
}

function chunk(name: string, data: Buffer): Buffer {
  const body = Buffer.concat([Buffer.from(name, "latin1"), data]);
  const size = Buffer.alloc(4);
  size.writeUInt32BE(data.length);
  const check = Buffer.alloc(4);
  check.writeUInt32BE(crc32(body));
  return Buffer.concat([size, body, check]);
}

/** A study with one erect film that is not synthetic; returns the film. */
async function makeStudy(page: Page, id: string, columns: number, rows: number): Promise<number> {
  const { csrf } = (await get<Api<"SessionView">>(page, "/api/session")).body;
  const uploaded = await page.request.post(new URL("/api/uploads", page.url()).href, {
    data: png(columns, rows),
    headers: {
      "content-type": "application/octet-stream",
      "x-spineline-csrf": csrf,
      origin: new URL(page.url()).origin,
    },
  });
  expect(uploaded.status(), await uploaded.text()).toBe(200);
  const { upload } = (await uploaded.json()) as Api<"UploadView">;
  const film: Api<"NewFilm"> = {
    upload,
    posture: "erect",
    patient_left: "image_right",
    scale: { kind: "stated", column_mm: 0.2, row_mm: 0.2, plane: "patient" },
  };
  const made = await send<Api<"StudyDetail">>(page, "POST", "/api/studies", { id, films: [film] });
  expect(made.status, JSON.stringify(made.body)).toBe(200);
  return made.body.summary.films[0]!.film;
}

/** A finished reading with the landmarks of another one, mirrored if the sides are to be swapped. */
async function read(
  page: Page,
  film: number,
  repeat: number,
  truth: Api<"ReadingView">,
  isSwapped = false,
): Promise<void> {
  const begun = await send<Api<"ReadingView">>(page, "POST", `/api/films/${film}/readings`, {
    repeat,
  });
  const { reading } = begun.body;
  const { columns } = truth.image;
  const isMirrored = isSwapped === (truth.image.patient_left === "image_right");
  const across = (column: number): number => (isMirrored ? columns - column : column);
  const events = truth.vertebrae
    .filter(({ level }) => LEVELS.some((one) => one === level))
    .flatMap(({ level, corners }) =>
      corners.map(({ corner, px: [column, row] }) => ({
        kind: "place_corner",
        level,
        corner,
        column_px: across(column!),
        // Repeats differ by a little.
        row_px: row! + repeat,
      })),
    );
  const sent = await send<Api<"Preview">>(page, "POST", `/api/readings/${reading}/events`, {
    expected_revision: 0,
    events,
  });
  expect(sent.status, JSON.stringify(sent.body).slice(0, 400)).toBe(200);
  const done = await send(page, "POST", `/api/readings/${reading}/finish`, {
    expected_revision: sent.body.reading.revision,
  });
  expect(done.status, JSON.stringify(done.body).slice(0, 400)).toBe(200);
}

/** A synthetic study, a real one that was read twice, a refused and a blinded one. */
async function makeMixedStore(app: App, page: Page): Promise<string[]> {
  await app.open(page, "lead");
  const demo = (await get<Api<"StudyDetail">>(page, `/api/studies/${DEMO}`)).body.summary;
  const erect = demo.films.find(({ posture }) => posture === "erect")!;
  const other = erect.readings.find(({ complete_levels }) => complete_levels === 15)!;
  const truth = (await get<Api<"ReadingView">>(page, `/api/readings/${other.reading}`)).body;
  const { columns, rows } = truth.image;
  const real = await makeStudy(page, "real-1", columns, rows);
  for (const repeat of [1, 2]) await read(page, real, repeat, truth);
  const refused = await makeStudy(page, "refused-1", columns, rows);
  await read(page, refused, 1, truth, true);
  await makeStudy(page, "blind-1", columns, rows);
  const plan = { observers: ["bob"], repeats: 1, washout_days: 0 };
  expect((await send(page, "POST", "/api/studies/blind-1/plan", plan)).status).toBe(200);
  return [demo.id, "real-1", "refused-1", "blind-1"];
}

test("every page of a mixed store has its heading and throws nothing", async ({ app, page }) => {
  test.setTimeout(400_000);
  const studies = await makeMixedStore(app, page);
  const addresses = [
    ...["studies", "new", "import", "cohort", "access"].map((place) => `#/${place}`),
    ...studies.flatMap((study) =>
      ["measure", "model", "evidence", "read"].map((place) => `#/studies/${study}/${place}`),
    ),
  ];
  const bob = await page.context().browser()!.newPage();
  await app.open(bob, "bob");
  const list = (await get<Api<"StudySummary">[]>(bob, "/api/studies")).body;
  const statusOf = (id: string) => list.find((one) => one.id === id)!.status;
  expect(statusOf("refused-1")).toBe("refused");
  expect(statusOf("blind-1")).toBe("blinded");
  for (const one of [page, bob]) {
    const thrown: string[] = [];
    one.on("pageerror", (error) => thrown.push(String(error)));
    for (const address of addresses) {
      await one.goto(new URL(address, app.address).href);
      await expect(one.getByRole("heading", { level: 1 }).first(), address).toBeVisible();
      await expect(
        one.getByText(/^(Opening|Loading|Building|Computing|Comparing).*…$/),
        address,
      ).toHaveCount(0, { timeout: 60_000 });
      await expect(one.getByRole("heading", { name: BROKEN }), address).toHaveCount(0);
      expect(thrown, address).toEqual([]);
    }
  }
  await bob.close();
});

test("repeated texts of a cohort and of a model are all shown", async ({ app, page }) => {
  const once = cohort();
  const reliability = once.reliability[0]!;
  const { statistics } = reliability;
  const twice = {
    ...once,
    verdict: [...once.verdict, ...once.verdict],
    charts: [...once.charts, ...once.charts],
    comparisons: [...once.comparisons, ...once.comparisons],
    reliability: [{ ...reliability, statistics: [...statistics, ...statistics] }, reliability],
  };
  await answerWith(page, "/api/cohort", twice);
  await app.openAt(page, "#/cohort");
  const agreement = page.getByRole("region", { name: "Table of agreement" });
  await expect(agreement.getByRole("rowheader")).toHaveCount(2);
  await expect(agreement.getByText("3.1°; 3.1°")).toHaveCount(1);
  const model = modelView();
  const sentence = model.verdict[0]!;
  const view = { ...model, verdict: [sentence, sentence] };
  await answerWith(page, `/api/studies/${view.study}/model`, view);
  await page.route("**/load", async (route) => {
    await route.fulfill({ json: loadAnswer(route.request().postDataJSON()) });
  });
  await page.goto(new URL(`#/studies/${view.study}/model`, app.address).href);
  await expect(page.getByText(sentence)).toHaveCount(2);
});

test("a page that throws says so and offers a way out", async ({ app, page }) => {
  await app.open(page);
  // An answer that the page cannot draw.
  await answerWith(page, "/api/cohort", { ...cohort(), verdict: null });
  const heading = page.getByRole("heading", { level: 1 });
  await page.getByRole("link", { name: "Cohort" }).click();
  await expect(heading).toHaveText(BROKEN);
  await expectAccessible(page);
  await shot(page, "page-broken");
  await page.getByRole("main").getByRole("link", { name: "studies" }).click();
  await expect(heading).toHaveText("Studies");
  await page.getByRole("link", { name: "Cohort" }).click();
  await expect(heading).toHaveText(BROKEN);
  await answerWith(page, "/api/cohort", cohort());
  await page.getByRole("button", { name: "Try again" }).click();
  await expect(heading).toHaveText("Cohort");
});
