import { Refusal } from "../api/client";
import type { Api } from "../api/types";

type Event = Api<"Event">;
type Preview = Api<"Preview">;
type ReadingView = Api<"ReadingView">;

/** Events that belong together, and the revision they were made on. */
export interface Entry {
  readonly events: readonly Event[];
  /** Fixed when the entry is made: a repeat after a lost answer is recognised by it. */
  readonly expected: number;
  /** Entries in a row with the same word become one while nobody has sent them. */
  readonly coalesce?: string | undefined;
  /** Sent at least once: the program may have it, so that it must not become another one. */
  readonly attempted?: boolean | undefined;
}

/** How things stand between the screen and the disk. */
export type SaveState =
  | { kind: "saved" }
  | { kind: "saving"; count: number }
  /** The program does not answer, or cannot right now, and is asked again and again. */
  | { kind: "waiting"; count: number; why: string | null }
  /** The program refuses for a reason that may pass; it is asked again when somebody wants it. */
  | { kind: "held"; count: number; why: string }
  /** The program no longer knows this session. */
  | { kind: "signed_out"; count: number };

export interface Keeping {
  load(): Entry[];
  save(entries: readonly Entry[]): void;
  /** Keeps events that lost against others, beside earlier ones, until somebody decides about them. */
  lose(events: readonly Event[]): void;
}

export interface OutboxOptions {
  /** Revision of the reading as it was loaded. */
  revision: number;
  /** Records events; the answer is the reading after them, with what follows. */
  send(events: readonly Event[], expected: number): Promise<Preview>;
  keeping: Keeping;
  /** The reading after events that were recorded. */
  saved(answer: Preview): void;
  /** Others were first: these events are not recorded, and here is how things stand. */
  conflict(lost: readonly Event[], reading: ReadingView): void;
  /** The program will never take these events. */
  refused(lost: readonly Event[], why: Refusal): void;
  /** The state or the waiting events have changed. */
  changed(): void;
  /** Milliseconds that a nudge waits for the next one. */
  restMs?: number;
  /** Milliseconds until the program is asked again, from the first time on. */
  retryMs?: readonly number[];
}

const REST_MS = 350;
const RETRY_MS = [250, 500, 1_000, 2_000];

/**
 * Sends every event of a reading, in order and once. What is not recorded yet survives a reload and a program that was stopped.
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

  /** The revision that the program has told of. */
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

  /** Sends at once what waits for the keys to rest. */
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

  /** The reading was loaded anew and nothing of ours is on its way. */
  rebase(revision: number): void {
    if (this.#entries.length === 0) this.#revision = Math.max(this.#revision, revision);
  }

  /** No more is sent, kept or told; what waits, or is on its way, is sent again after the next load. */
  close(): void {
    if (this.#closed) return;
    // A nudge that rests is whole now: the keys of another page do not go on with it.
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
      // The next page's outbox has the entry from storage, and is told the same.
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
    else if (error.status === 409 && error.problem.code === "finished") {
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

  /** What was made after the lost event was made on top of it. */
  #lose(reading: ReadingView): void {
    const lost = this.pending;
    // First kept as lost, and only then no longer as waiting.
    this.#options.keeping.lose(lost);
    this.#entries = [];
    this.#failures = 0;
    this.#revision = reading.revision;
    this.#keep();
    this.#options.conflict(lost, reading);
  }

  /** Whoever signs in again, or gets their role back, goes on from here. */
  #hold(error: Refusal): void {
    this.#stopped = error.status === 401 ? "signed_out" : "held";
    this.#why = error.message;
    this.#options.changed();
  }

  /** Takes an entry out; those behind it were counted on it. */
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

/** Whether the same request may be taken a moment later. */
function isPassing(status: number): boolean {
  return status >= 500 || status === 429 || status === 408;
}

function readingOf(body: unknown): ReadingView | null {
  if (typeof body !== "object" || body === null || !("reading" in body)) return null;
  return (body.reading as ReadingView | null | undefined) ?? null;
}
