import { readFile, readdir } from "node:fs/promises";
import path from "node:path";

import { expect, test, type App } from "../app";
import { KILLED, kept, markFilm, truthOf, type Kept } from "../byclicks";
import { FilmPage } from "../marking";

/** Folder of case files with pictures and landmarks, as `spineline study add` takes them. */
const FOLDER = process.env.SPINELINE_OWN_FILMS;
/** With the time of the click itself, about one click per second. */
const AIM_MS = Number(process.env.SPINELINE_AIM_MS ?? 850);
const COUNT = 5;

interface Marked extends Kept {
  study: string;
  clicks: number;
  seconds: number;
  conflicts: number;
}

test("five films of one's own, at a person's pace, and a killed program", async ({ app, page }) => {
  test.skip(!FOLDER, "SPINELINE_OWN_FILMS names no folder of case files");
  test.setTimeout(1_800_000);
  const studies = await addCases(app, FOLDER!);
  await app.open(page);
  const film = new FilmPage(page);
  const marked: Marked[] = [];
  for (const [index, study] of studies.entries()) {
    await page.evaluate((hash) => (window.location.hash = hash), `#/studies/${study}/measure`);
    await expect(page).toHaveURL(new RegExp(`${study}/measure`));
    await film.begin();
    // In the middle of the films, in the middle of one.
    const isKilled = index === Math.floor(studies.length / 2);
    marked.push(await markOne(app, film, study, isKilled));
  }
  report(marked);
  expect(marked.flatMap(({ lost, misplaced }) => [...lost, ...misplaced])).toEqual([]);
});

/** Adds the first case files of the folder to the store; returns their studies. */
async function addCases(app: App, folder: string): Promise<string[]> {
  const names = (await readdir(folder)).filter((name) => name.endsWith(".json")).toSorted();
  expect(names.length, `case files in ${folder}`).toBeGreaterThanOrEqual(COUNT);
  const files = names.slice(0, COUNT).map((name) => path.resolve(folder, name));
  await app.addCases(...files);
  await app.start();
  return Promise.all(files.map(caseOf));
}

/** The study of a case file: its `case_id`. */
async function caseOf(file: string): Promise<string> {
  const { case_id } = JSON.parse(await readFile(file, "utf8")) as { case_id: string };
  return case_id;
}

async function markOne(
  app: App,
  film: FilmPage,
  study: string,
  isKilled: boolean,
): Promise<Marked> {
  const truth = await truthOf(film);
  const start = Date.now();
  const clicks = await markFilm(film, truth, AIM_MS, async (click) => {
    if (isKilled && click === KILLED.click) await app.kill();
    if (isKilled && click === KILLED.back) await app.start();
  });
  const seconds = (Date.now() - start) / 1000;
  await film.saved();
  const reading = await film.reading();
  const conflicts = reading.conflicts.length;
  return { study, clicks: clicks.size, seconds, conflicts, ...kept(reading, clicks) };
}

function report(marked: readonly Marked[]): void {
  for (const { study, clicks, seconds, conflicts, lost, misplaced, largestPx } of marked) {
    const pace = `${clicks} clicks in ${seconds.toFixed(0)} s`;
    const counts = `${lost.length} lost, ${misplaced.length} misplaced, ${conflicts} conflicts`;
    console.log(
      `${study}: ${pace}; ${counts}; at most ${largestPx.toFixed(4)} px from click to corner`,
    );
  }
}
