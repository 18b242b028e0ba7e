import { beginReading, correctReading, readReading, withdrawReading } from "../api/readings";
import { editFilm, editStudy, readStudy } from "../api/studies";
import type { Api } from "../api/types";
import { backAfter } from "../shell/loaded.svelte";
import { inFilmOrder } from "../shell/words";
import { counts } from "../studies/listing";
import { nameTab } from "./keeping";
import { isChangeable } from "./landmarks";
import { Marking } from "./marking.svelte";
import { movedText } from "./scale";

type FilmSummary = Api<"FilmSummary">;
type ReadingSummary = Api<"ReadingSummary">;

/** Changes within this time cause one load. */
const BURST_MS = 300;

/** State of the measuring page: study, film and reading. */
export class StudyPage {
  detail = $state.raw<Api<"StudyDetail"> | null>(null);
  marking = $state.raw<Marking | null>(null);
  /** The failed action and its error. */
  problem = $state.raw<{ what: string; error: unknown } | null>(null);
  /** Text of the banner on changes by others. */
  changeNotice = $state<string | null>(null);
  /** Whether the reading is being loaded. */
  isLooking = $state(true);
  #film = $state<number | null>(null);
  #burst: ReturnType<typeof setTimeout> | null = null;
  #openings = 0;
  #isClosed = false;

  readonly film = $derived(this.films.find(({ film }) => film === this.#film) ?? null);

  constructor(readonly study: string) {}

  /** In the usual order. */
  get films(): FilmSummary[] {
    return inFilmOrder(this.detail?.summary.films ?? []);
  }

  /** The next or previous film. */
  beside(by: 1 | -1): FilmSummary | null {
    return this.films[this.films.findIndex(({ film }) => film === this.#film) + by] ?? null;
  }

  /** The signed-in person's readings of the film. */
  get mine(): ReadingSummary[] {
    return this.film?.readings.filter((reading) => reading.mine) ?? [];
  }

  get nextRepeat(): number {
    return 1 + Math.max(0, ...this.mine.map(({ repeat }) => repeat));
  }

  /** Whether the person may change the study's record: also of a blinded one, as an admin. */
  get mayEdit(): boolean {
    const { role } = this.detail?.summary ?? { role: "reader" };
    return this.detail?.plan?.blinded ? role === "admin" : role !== "reader";
  }

  get mayMark(): boolean {
    return this.mayEdit && !this.detail?.summary.archived && !this.detail?.plan?.blinded;
  }

  /** Whether the person may withdraw a reading. */
  mayWithdraw({ mine, withdrawn }: ReadingSummary): boolean {
    return this.mayMark && !withdrawn && (mine || this.detail?.summary.role === "admin");
  }

  /** Whether a correction can begin: a planned reading has none, because it would not be blinded. */
  mayCorrect(reading: ReadingSummary): boolean {
    return this.mayMark && reading.mine && counts(reading) && !this.detail?.plan;
  }

  /** Whether blinded readings can be planned: the study must have no readings. */
  get mayPlan(): boolean {
    return (
      this.detail !== null &&
      this.detail.summary.role === "admin" &&
      !this.detail.summary.archived &&
      !this.detail.plan &&
      this.films.length > 0 &&
      this.films.every(({ readings }) => readings.length === 0)
    );
  }

  /** Whether the films are hidden from this person, who reads them under codes on another page. */
  get isHidden(): boolean {
    return this.detail?.plan?.blinded === true && this.films.length === 0;
  }

  async refresh(): Promise<void> {
    await this.#tried("The study could not be loaded", async () => {
      this.detail = await readStudy(this.study);
    });
  }

  /** Shows a film with the person's latest unfinished reading, if there is one; or begins the first one. */
  async open(film: number | undefined, begins = false): Promise<void> {
    const erect = this.films.find(({ posture }) => posture === "erect");
    const chosen = this.films.find((one) => one.film === film) ?? erect ?? this.films[0];
    this.#film = chosen?.film ?? null;
    const standing = this.mine.filter(({ withdrawn }) => !withdrawn);
    const latest = standing.toSorted((a, b) => b.reading - a.reading);
    const reading = latest.find(({ finished }) => !finished) ?? latest[0];
    await this.openReading(reading?.reading ?? null);
    if (begins && !reading && this.mayMark && this.#film === film) await this.begin();
  }

  async openReading(reading: number | null): Promise<void> {
    this.#openings += 1;
    const opening = this.#openings;
    this.#close();
    this.isLooking = reading !== null;
    if (reading === null) return;
    await this.#tried("The reading could not be opened", async () => {
      const view = await readReading(reading);
      const tab = await nameTab();
      if (opening === this.#openings) this.marking = new Marking(view, tab);
    });
    if (opening === this.#openings) this.isLooking = false;
  }

  async begin(): Promise<void> {
    const film = this.film;
    if (!film) return;
    const repeat = this.nextRepeat;
    await this.#tried("The reading could not be started", async () => {
      // An earlier attempt without an answer may have begun it.
      await this.refresh();
      const now = this.films.find((one) => one.film === film.film);
      const begun = now?.readings.find((one) => one.mine && one.repeat === repeat);
      const { reading } = begun ?? (await beginReading(film.film, { repeat }));
      await this.refresh();
      await this.openReading(reading);
    });
  }

  /** Opens the correction of a finished reading, and begins it unless an earlier attempt did. */
  async correct({ reading }: ReadingSummary): Promise<void> {
    await this.#tried("The correction could not be started", async () => {
      await this.refresh();
      const begun = this.mine.find((one) => one.corrects === reading && isChangeable(one));
      const correction = begun ?? (await correctReading(reading));
      await this.refresh();
      await this.openReading(correction.reading);
    });
  }

  /** Withdraws a reading; errors are for the dialog that asks for the reason. */
  async withdraw({ reading }: ReadingSummary, reason: string): Promise<void> {
    await withdrawReading(reading, { reason });
    await Promise.all([this.refresh(), this.marking?.reload()]);
  }

  /** Returns a function that changes the label of the study, or archives it, as the film's `editor` does. */
  studyEditor(): (edit: Api<"StudyEditName">) => Promise<void> {
    let expected_revision = this.detail?.summary.revision ?? 0;
    return async (edit) => {
      try {
        this.detail = await editStudy(this.study, { expected_revision, edit });
        expected_revision = this.detail.summary.revision;
        // A restored study takes the changes that waited.
        this.marking?.retry();
      } catch (error) {
        // After a refusal the shown record is outdated.
        await this.refresh();
        throw error;
      }
    };
  }

  /**
   * Returns a function that changes the film's current record, also several times; a change by another person in
   * between takes precedence.
   */
  editor(): (edit: Api<"FilmEditName">) => Promise<void> {
    const seen = this.film;
    let expected_revision = seen?.revision ?? 0;
    return async (edit) => {
      if (!seen) return;
      try {
        const edited = await editFilm(seen.film, { expected_revision, edit });
        expected_revision = edited.revision;
        if (edit.kind === "scale")
          this.changeNotice = movedText(seen, edited, this.marking?.reading.vertebrae ?? []);
      } finally {
        // After a refusal the shown record is outdated.
        await Promise.all([this.refresh(), this.marking?.reload()]);
      }
    };
  }

  /** A change was reported, possibly of this window. */
  heard(change: Api<"Change">, me: string): void {
    if (this.marking?.isNews(change)) {
      this.changeNotice =
        change.who === me
          ? "This reading was changed in another window."
          : `${change.who} has changed this reading.`;
      void this.marking.reload();
    } else if (change.who !== me) this.changeNotice = `${change.who} has changed this study.`;
    this.#later();
  }

  /** Loads again after a lost connection. */
  async catchUp(): Promise<void> {
    this.marking?.retry();
    await Promise.all([this.refresh(), this.marking?.reload()]);
  }

  close(): void {
    this.#isClosed = true;
    if (this.#burst) clearTimeout(this.#burst);
    this.#close();
  }

  #later(): void {
    if (this.#burst) clearTimeout(this.#burst);
    this.#burst = setTimeout(() => void this.refresh(), BURST_MS);
  }

  #close(): void {
    this.marking?.close();
    this.marking = null;
  }

  /** Attempts again when the connection or the session is back; other errors are shown. */
  async #tried(what: string, attempt: () => Promise<void>): Promise<void> {
    while (!this.#isClosed) {
      try {
        await attempt();
        this.problem = null;
        return;
      } catch (error) {
        const back = backAfter(error);
        if (!back) {
          this.problem = { what, error };
          return;
        }
        await back;
      }
    }
  }
}
