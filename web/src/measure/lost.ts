import type { Event } from "./landmarks";

/** Number and interval of checks for events of windows that have just closed. */
const AGAIN_TIMES = 5;
const AGAIN_MS = 800;

/** Looks for events of other windows, several times: a window that closes keeps its name for a moment. */
export async function lookedFor<Found>(
  look: () => Promise<Found | null>,
  isOver: () => boolean,
): Promise<Found | null> {
  let found = await look();
  for (let i = 0; !found && i < AGAIN_TIMES && !isOver(); i += 1) {
    await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
    found = await look();
  }
  return found;
}

/** Events that were not recorded, with the reason. */
export interface Lost {
  readonly events: readonly Event[];
  readonly why: "conflict" | "left_behind";
  /** Times at which other windows left events. */
  readonly since_ms?: number;
  /** Whether such a window may still be open. */
  readonly mayBeOpen?: boolean;
  readonly forget: () => void;
}

/** A failed change and its error. */
export interface Trouble {
  readonly what: string;
  readonly error: unknown;
}

/** The program lacks changes of a reading that it had acknowledged. */
export const WENT_BACK: Trouble = {
  what: "The study store went back",
  error:
    "changes of this reading that were acknowledged are missing, because an earlier copy is in its place or its log was lost; " +
    "stop, and tell the person who keeps the store (`spineline study verify` says more)",
};
