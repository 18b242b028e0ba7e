import { expect, test } from "./app";
import { KILLED, kept, markFilm, truthOf } from "./byclicks";
import { FilmPage, LEVELS } from "./marking";

test.use({ hasDemo: true });

/** Time before a click: a practised reader takes a second, with which the test lasts six minutes. */
const AIM_MS = Number(process.env.SPINELINE_AIM_MS ?? 200);
const FILMS = [/^erect/i, /left bending/i, /right bending/i, /neutral/i, /traction/i];
/** The film during which the program is killed. */
const KILLED_FILM = 2;

test(
  "five films are marked click by click while the program is killed and started again",
  { tag: "@long" },
  async ({ app, page }) => {
    test.setTimeout(1_200_000);
    await app.openDemo(page);
    const film = new FilmPage(page);
    const wrong: string[] = [];
    for (const [index, name] of FILMS.entries()) {
      const link = page.getByRole("navigation", { name: "Films" }).getByRole("link", { name });
      await link.click();
      await expect(link).toHaveAttribute("aria-current", "page");
      await film.begin();
      const truth = await truthOf(film);
      const clicks = await markFilm(film, truth, AIM_MS, async (click) => {
        if (index !== KILLED_FILM) return;
        // Without a wait for anything on the page.
        if (click === KILLED.click) await app.kill();
        if (click === KILLED.back) await app.start();
      });
      await film.saved();
      const reading = await film.reading();
      expect(reading.vertebrae.filter(({ complete }) => complete)).toHaveLength(LEVELS.length);
      expect(reading.conflicts).toEqual([]);
      const { lost, misplaced } = kept(reading, clicks);
      wrong.push(...[...lost, ...misplaced].map((what) => `${String(name)} ${what}`));
    }
    expect(wrong).toEqual([]);
  },
);
