import type { Api } from "../api/types";
import { lasting, ofWindow } from "../shell/storage.svelte";
import type { Entry, Keeping } from "./outbox";

type Event = Api<"Event">;

const PREFIX = "spineline.unsaved";
/** Suffix of the key of changes that were refused as outdated. */
const LOST = ".lost";

/** Name of this browser window, kept across reloads. */
let tab: string | null = null;

/**
 * Finds the name of this window. A duplicated window starts with a copy of the other's name and takes a new one:
 * two windows that send the same events would record them twice.
 */
export async function nameTab(): Promise<string> {
  if (tab !== null) return tab;
  const earlier = ofWindow.get(`${PREFIX}.tab`);
  const name = earlier !== null && (await holdSoon(earlier)) ? earlier : freshName();
  if (name !== earlier) await hold(name);
  ofWindow.set(`${PREFIX}.tab`, name);
  tab = name;
  return name;
}

/** Not `randomUUID`, which browsers allow only on pages with a certificate. */
function freshName(): string {
  return Array.from(crypto.getRandomValues(new Uint32Array(4)), (part) => part.toString(36)).join(
    "",
  );
}

/** The page before a reload may hold the name briefly. */
async function holdSoon(name: string): Promise<boolean> {
  const TRIES = 6;
  const PAUSE_MS = 80;
  for (let i = 0; i < TRIES; i += 1) {
    if (await hold(name)) return true;
    await new Promise((resolve) => setTimeout(resolve, PAUSE_MS));
  }
  return false;
}

/** Locks a name until the window closes; returns whether no other window holds it. */
function hold(name: string): Promise<boolean> {
  if (!("locks" in navigator)) return Promise.resolve(true);
  return new Promise((resolve) => {
    void navigator.locks.request(`${PREFIX}.${name}`, { ifAvailable: true }, (lock) => {
      resolve(lock !== null);
      return lock ? new Promise(() => undefined) : undefined;
    });
  });
}

/** Storage of one window for a reading. */
export interface ReadingKeeping extends Keeping {
  /** Refused events that the person has not yet decided on. */
  lost(): Event[];
  /** The person has decided on the refused events. */
  decided(): void;
}

/** For readings of others, which are never changed here. */
export const keepsNothing: ReadingKeeping = {
  load: () => [],
  save: () => undefined,
  lose: () => undefined,
  lost: () => [],
  decided: () => undefined,
};

/** Unsaved events of one reading in this window. The key identifies the reading and contains no patient's name. */
export function keepingOf(reading: Api<"ReadingView">, tabName: string): ReadingKeeping {
  const key = `${groupOf(reading)}.${tabName}`;
  const lost = (): Event[] => keptOf(key + LOST).entries.flatMap(({ events }) => events);
  return {
    load: () => keptOf(key).entries,
    save: (entries) => keep(key, entries),
    lose: (events) => keep(key + LOST, [{ events: [...lost(), ...events], expected: 0 }]),
    lost,
    decided: () => lasting.remove(key + LOST),
  };
}

/** Unsaved events of other windows. */
interface LeftBehind {
  events: Event[];
  /** Time of the newest event. */
  since_ms: number;
  /** Whether such a window may still be open: without a certificate, browsers do not report it. */
  mayBeOpen: boolean;
  forget: () => void;
}

/** Unsaved events of other windows: sent only on request, because the reading may have changed. */
export async function leftBehind(
  reading: Api<"ReadingView">,
  tabName: string,
): Promise<LeftBehind | null> {
  const group = `${groupOf(reading)}.`;
  const open = await openWindows();
  const keys = lasting.keys().filter((key) => {
    if (!key.startsWith(group)) return false;
    const name = key.slice(group.length).replace(LOST, "");
    return name !== tabName && open?.has(`${PREFIX}.${name}`) !== true;
  });
  const kept = keys.map(keptOf).filter(({ entries }) => entries.length > 0);
  if (kept.length === 0) return null;
  return {
    events: kept.flatMap(({ entries }) => entries.flatMap(({ events }) => events)),
    since_ms: Math.max(...kept.map(({ kept_ms }) => kept_ms)),
    mayBeOpen: open === null,
    forget: () => keys.forEach((key) => lasting.remove(key)),
  };
}

/** Names of the open windows; null where the browser does not report them. */
async function openWindows(): Promise<Set<string | undefined> | null> {
  if (!("locks" in navigator)) return null;
  return new Set((await navigator.locks.query()).held?.map((lock) => lock.name));
}

function groupOf(reading: Api<"ReadingView">): string {
  const film = reading.code ?? `${reading.study}.${reading.film}.${reading.repeat}`;
  return `${PREFIX}.${reading.observer}.${film}.${reading.reading}`;
}

interface Kept {
  /** Time of writing. */
  kept_ms: number;
  entries: Entry[];
}

function keep(key: string, entries: readonly Entry[]): void {
  if (entries.length === 0) lasting.remove(key);
  else if (!lasting.set(key, JSON.stringify({ kept_ms: Date.now(), entries })))
    lasting.refused = true;
}

function keptOf(key: string): Kept {
  const none = { kept_ms: 0, entries: [] };
  const text = lasting.get(key);
  if (text === null) return none;
  try {
    const kept = JSON.parse(text) as Partial<Kept> | null;
    return Array.isArray(kept?.entries) ? (kept as Kept) : none;
  } catch {
    return none;
  }
}
