import type { Api } from "../api/types";
import type { Entry, Keeping } from "./outbox";

type Event = Api<"Event">;

const PREFIX = "spineline.unsaved";

/** A window of the browser, from reload to reload. */
let tab: string | null = null;

/**
 * Finds the name of this window. A duplicated window starts with a copy of the other's name, and takes one of its own:
 * two windows that send the same events would record them twice.
 */
export async function nameTab(): Promise<string> {
  if (tab !== null) return tab;
  const earlier = sessionStorage.getItem(`${PREFIX}.tab`);
  const name = earlier !== null && (await holdSoon(earlier)) ? earlier : freshName();
  if (name !== earlier) await hold(name);
  sessionStorage.setItem(`${PREFIX}.tab`, name);
  tab = name;
  return name;
}

/** Not `randomUUID`, which browsers keep from pages without a certificate. */
function freshName(): string {
  return Array.from(crypto.getRandomValues(new Uint32Array(4)), (part) => part.toString(36)).join(
    "",
  );
}

/** The page before a reload may still hold the name for a moment. */
async function holdSoon(name: string): Promise<boolean> {
  const TRIES = 6;
  const PAUSE_MS = 80;
  for (let i = 0; i < TRIES; i += 1) {
    if (await hold(name)) return true;
    await new Promise((resolve) => setTimeout(resolve, PAUSE_MS));
  }
  return false;
}

/** Holds a name for as long as the window lives; says whether nobody else does. */
function hold(name: string): Promise<boolean> {
  if (!("locks" in navigator)) return Promise.resolve(true);
  return new Promise((resolve) => {
    void navigator.locks.request(`${PREFIX}.${name}`, { ifAvailable: true }, (lock) => {
      resolve(lock !== null);
      return lock ? new Promise(() => undefined) : undefined;
    });
  });
}

/** What is not saved yet of one reading in this window. The key carries no patient's name, only what tells readings apart. */
export function keepingOf(reading: Api<"ReadingView">, tabName: string): Keeping {
  const key = `${groupOf(reading)}.${tabName}`;
  return {
    load: () => entriesOf(localStorage.getItem(key)),
    save: (entries) => {
      if (entries.length === 0) localStorage.removeItem(key);
      else localStorage.setItem(key, JSON.stringify(entries));
    },
  };
}

/** What windows left behind that are closed by now: never sent unasked, as the reading may have gone on. */
export async function leftBehind(
  reading: Api<"ReadingView">,
): Promise<{ events: Event[]; forget: () => void } | null> {
  if (!("locks" in navigator)) return null;
  const group = `${groupOf(reading)}.`;
  const held = new Set((await navigator.locks.query()).held?.map((lock) => lock.name));
  const keys = Object.keys(localStorage).filter(
    (key) => key.startsWith(group) && !held.has(`${PREFIX}.${key.slice(group.length)}`),
  );
  const events = keys
    .flatMap((key) => entriesOf(localStorage.getItem(key)))
    .flatMap((entry) => entry.events);
  const forget = (): void => keys.forEach((key) => localStorage.removeItem(key));
  return events.length > 0 ? { events, forget } : null;
}

function groupOf(reading: Api<"ReadingView">): string {
  const film = reading.code ?? `${reading.study}.${reading.film}.${reading.repeat}`;
  return `${PREFIX}.${reading.observer}.${film}.${reading.reading}`;
}

function entriesOf(text: string | null): Entry[] {
  if (text === null) return [];
  try {
    const entries: unknown = JSON.parse(text);
    return Array.isArray(entries) ? (entries as Entry[]) : [];
  } catch {
    return [];
  }
}
