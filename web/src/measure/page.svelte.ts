import { beginReading, readReading } from "../api/readings";
import { editFilm, readStudy } from "../api/studies";
import type { Api } from "../api/types";
import { nameTab } from "./keeping";
import { Marking } from "./marking.svelte";

type FilmSummary = Api<"FilmSummary">;
type ReadingSummary = Api<"ReadingSummary">;

/** Changes of a burst are read once. */
const BURST_MS = 300;

/** A study on the page where its films are marked: which film, and which reading of it. */
export class StudyPage {
  detail = $state.raw<Api<"StudyDetail"> | null>(null);
  marking = $state.raw<Marking | null>(null);
  /** What went wrong, and what was tried. */
  problem = $state.raw<{ what: string; error: unknown } | null>(null);
  /** Who changed what, for a banner. */
  changeNotice = $state<string | null>(null);
  /** Whether the reading of the film is being looked for. */
  isLooking = $state(true);
  #film = $state<number | null>(null);
  #burst: ReturnType<typeof setTimeout> | null = null;
  #openings = 0;

  readonly film = $derived(this.films.find(({ film }) => film === this.#film) ?? null);

  constructor(readonly study: string) {}

  get films(): FilmSummary[] {
    return this.detail?.summary.films ?? [];
  }

  /** Readings of the film by whoever is here. */
  get mine(): ReadingSummary[] {
    return this.film?.readings.filter((reading) => reading.mine) ?? [];
  }

  get nextRepeat(): number {
    return 1 + Math.max(0, ...this.mine.map(({ repeat }) => repeat));
  }

  get mayMark(): boolean {
    return (
      this.detail !== null && this.detail.summary.role !== "reader" && !this.detail.plan?.blinded
    );
  }

  async refresh(): Promise<void> {
    await this.#tried("The study could not be read", async () => {
      this.detail = await readStudy(this.study);
    });
  }

  /** Shows a film with the reading that its reader most likely wants: their own, unfinished, latest. */
  async open(film: number | undefined): Promise<void> {
    const erect = this.films.find(({ posture }) => posture === "erect");
    const chosen = this.films.find((one) => one.film === film) ?? erect ?? this.films[0];
    this.#film = chosen?.film ?? null;
    const latest = this.mine.toSorted((a, b) => b.repeat - a.repeat);
    const reading = latest.find(({ finished }) => !finished) ?? latest[0];
    await this.openReading(reading?.reading ?? null);
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
    await this.#tried("The reading could not be started", async () => {
      const view = await beginReading(film.film, { repeat: this.nextRepeat });
      await this.refresh();
      await this.openReading(view.reading);
    });
  }

  /** A way to change the film's record as it is seen now: what somebody else changes in between wins. */
  editor(): (edit: Api<"FilmEditName">) => Promise<void> {
    const seen = this.film;
    return async (edit) => {
      if (!seen) return;
      try {
        await editFilm(seen.film, { expected_revision: seen.revision, edit });
      } finally {
        // After a refusal the film stands otherwise than it is shown.
        await Promise.all([this.refresh(), this.marking?.reload()]);
      }
    };
  }

  /** Somebody, perhaps this window, has changed something. */
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

  /** The program was away. */
  async catchUp(): Promise<void> {
    this.marking?.retry();
    await Promise.all([this.refresh(), this.marking?.reload()]);
  }

  close(): void {
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

  async #tried(what: string, attempt: () => Promise<void>): Promise<void> {
    try {
      await attempt();
      this.problem = null;
    } catch (error) {
      this.problem = { what, error };
    }
  }
}
