import { Refusal } from "../api/client";
import type { Api } from "../api/types";

type Event = Api<"Event">;
type Preview = Api<"Preview">;
type ReadingView = Api<"ReadingView">;

/** Events that belong together, with the revision on which they were made. */
export interface Entry {
  readonly events: readonly Event[];
  /** Set when the entry is made: identifies a repeat after a lost answer. */
  readonly expected: number;
  /** Consecutive unsent entries with the same word are combined. */
  readonly coalesce?: string | undefined;
  /** Sent at least once: the program may have recorded it, so it must not change. */
  readonly attempted?: boolean | undefined;
}

/** State of saving. */
export type SaveState =
  | { kind: "saved" }
  | { kind: "saving"; count: number }
  /** The program does not answer or is busy; the request is repeated. */
  | { kind: "waiting"; count: number; why: string | null }
  /** The program refuses for a temporary reason; the person can try again. */
  | { kind: "held"; count: number; why: string }
  /** The session has ended. */
  | { kind: "signed_out"; count: number };

export interface Keeping {
  load(): Entry[];
  save(entries: readonly Entry[]): void;
  /** Stores refused events beside earlier ones until the person decides. */
  lose(events: readonly Event[]): void;
}

interface OutboxOptions {
  /** Revision of the loaded reading. */
  revision: number;
  /** Records events; the answer is the new reading with its results. */
  send(events: readonly Event[], expected: number): Promise<Preview>;
  keeping: Keeping;
  /** The reading after events that were recorded. */
  saved(answer: Preview): void;
  /**
   * Other changes came first, or the program lacks acknowledged changes (`wentBack`): these events are not recorded,
   * and the current reading is given.
   */
  conflict(lost: readonly Event[], reading: ReadingView, wentBack: boolean): void;
  /** The program refuses these events. */
  refused(lost: readonly Event[], why: Refusal): void;
  /** The state or the waiting events have changed. */
  changed(): void;
  /** Milliseconds that a nudge waits for the next one. */
  restMs?: number;
  /** Milliseconds until each repeated request. */
  retryMs?: readonly number[];
}

const REST_MS = 350;
const RETRY_MS = [250, 500, 1_000, 2_000];

/**
 * Sends every event of a reading in order and once. Unrecorded events survive a reload and a stop of the program.
 */
export class Outbox {
  #entries: Entry[];
  #sending = false;
  #resting: ReturnType<typeof setTimeout> | null = null;
  #retrying: ReturnType<typeof setTimeout> | null = null;
  #failures = 0;
  #why: string | null = null;
  #stopped: "signed_out" | "held" | null = null;
  #closed = false;
  #revision: number;
  readonly #options: OutboxOptions;

  constructor(options: OutboxOptions) {
    this.#options = options;
    this.#revision = options.revision;
    this.#entries = options.keeping.load();
    if (this.#entries.length > 0) this.#pump(true);
  }

  get state(): SaveState {
    const count = this.#entries.length;
    if (count === 0) return { kind: "saved" };
    if (this.#stopped === "signed_out") return { kind: "signed_out", count };
    if (this.#stopped === "held") return { kind: "held", count, why: this.#why ?? "" };
    if (this.#failures > 0) return { kind: "waiting", count, why: this.#why };
    return { kind: "saving", count };
  }

  /** Events that are not recorded yet, oldest first. */
  get pending(): Event[] {
    return this.#entries.flatMap((entry) => entry.events);
  }

  /** The revision once everything is recorded. */
  get revision(): number {
    const last = this.#entries.at(-1);
    return last ? last.expected + last.events.length : this.#revision;
  }

  /** The last revision that the program reported. */
  get known(): number {
    return this.#revision;
  }

  push(events: readonly Event[], coalesce?: string): void {
    if (this.#closed || events.length === 0) return;
    const last = this.#entries.at(-1);
    if (last && !last.attempted && coalesce !== undefined && last.coalesce === coalesce) {
      this.#entries[this.#entries.length - 1] = { ...last, events };
    } else {
      this.#entries.push({ events, expected: this.revision, coalesce });
    }
    this.#keep();
    this.#pump();
  }

  /** Sends waiting nudges at once. */
  flush(): void {
    this.#stopResting();
    this.#pump(true);
  }

  /** Asks again without waiting. */
  retry(): void {
    this.#stopRetrying();
    this.#stopped = null;
    this.#pump(true);
  }

  /** The reading was loaded again and no own event is being sent. */
  rebase(revision: number): void {
    if (this.#entries.length === 0) this.#revision = Math.max(this.#revision, revision);
  }

  /** Stops sending and storing; waiting entries are sent after the next load. */
  close(): void {
    if (this.#closed) return;
    // A waiting nudge is complete now: keys on another page do not extend it.
    this.#entries = this.#entries.map((entry) => ({ ...entry, coalesce: undefined }));
    this.#options.keeping.save(this.#entries);
    this.#closed = true;
    this.#stopResting();
    this.#stopRetrying();
  }

  #pump(now = false): void {
    const entry = this.#entries[0];
    if (!entry || this.#sending || this.#closed || this.#retrying || this.#stopped) return;
    const isLast = this.#entries.length === 1;
    if (entry.coalesce !== undefined && isLast && !now) {
      this.#rest();
      return;
    }
    this.#stopResting();
    void this.#send(entry);
  }

  async #send(entry: Entry): Promise<void> {
    this.#sending = true;
    if (!entry.attempted) {
      this.#entries[0] = { ...entry, attempted: true };
      this.#options.keeping.save(this.#entries);
    }
    try {
      const answer = await this.#options.send(entry.events, entry.expected);
      if (this.#closed) return;
      this.#sending = false;
      this.#failures = 0;
      this.#revision = Math.max(this.#revision, answer.reading.revision);
      this.#entries.shift();
      this.#keep();
      this.#options.saved(answer);
    } catch (error) {
      // The outbox of the next page reads the entry from storage and gets the same answer.
      if (this.#closed) return;
      this.#sending = false;
      this.#failed(entry, error);
    }
    this.#pump();
  }

  #failed(entry: Entry, error: unknown): void {
    if (!(error instanceof Refusal) || isPassing(error.status)) {
      this.#wait(error instanceof Refusal ? error.message : null);
      return;
    }
    const reading = error.status === 409 ? readingOf(error.body) : null;
    if (reading) this.#lose(reading);
    else if (error.status === 409 && ["finished", "withdrawn"].includes(error.problem.code)) {
      const lost = this.pending;
      this.#entries = [];
      this.#failures = 0;
      this.#keep();
      this.#options.refused(lost, error);
    } else if (error.status === 422) {
      this.#drop(entry);
      this.#options.refused(entry.events, error);
    } else this.#hold(error);
  }

  /** Later entries depend on the refused one. */
  #lose(reading: ReadingView): void {
    const [lost, wentBack] = [this.pending, reading.revision < this.#revision];
    // Stored as refused first, then removed from the waiting ones.
    this.#options.keeping.lose(lost);
    this.#entries = [];
    this.#failures = 0;
    this.#revision = reading.revision;
    this.#keep();
    this.#options.conflict(lost, reading, wentBack);
  }

  /** Continues after the person signed in again or got the role back. */
  #hold(error: Refusal): void {
    this.#stopped = error.status === 401 ? "signed_out" : "held";
    this.#why = error.message;
    this.#options.changed();
  }

  /** Removes an entry; the revisions of later ones depend on it. */
  #drop(entry: Entry): void {
    this.#failures = 0;
    this.#entries = this.#entries
      .slice(1)
      .map((later) => ({ ...later, expected: later.expected - entry.events.length }));
    this.#keep();
  }

  #wait(why: string | null): void {
    this.#why = why;
    const delays = this.#options.retryMs ?? RETRY_MS;
    const delay = delays[Math.min(this.#failures, delays.length - 1)]!;
    this.#failures += 1;
    this.#options.changed();
    this.#retrying = setTimeout(() => {
      this.#retrying = null;
      this.#pump(true);
    }, delay);
  }

  #rest(): void {
    this.#stopResting();
    this.#resting = setTimeout(() => {
      this.#resting = null;
      this.#pump(true);
    }, this.#options.restMs ?? REST_MS);
  }

  #stopResting(): void {
    if (this.#resting) clearTimeout(this.#resting);
    this.#resting = null;
  }

  #stopRetrying(): void {
    if (this.#retrying) clearTimeout(this.#retrying);
    this.#retrying = null;
  }

  #keep(): void {
    this.#options.keeping.save(this.#entries);
    this.#options.changed();
  }
}

/** Whether the same request may succeed later. */
function isPassing(status: number): boolean {
  return status >= 500 || status === 429 || status === 408;
}

function readingOf(body: unknown): ReadingView | null {
  if (typeof body !== "object" || body === null || !("reading" in body)) return null;
  return (body.reading as ReadingView | null | undefined) ?? null;
}
