import {
  OPTIONAL_LEVELS,
  missingCorner,
  missingCrest,
  missingWall,
  nextLandmark,
  placeOf,
  type Event,
  type Landmark,
  type ReadingView,
} from "./landmarks";
import type { Way } from "./proposals";

/** Selected in place of a level. */
export const CRESTS = Symbol("iliac crests");

/** Out of the guided order: a level, or the crests. */
export type Chosen = string | typeof CRESTS | null;

/** The next landmark, from the drawn and the recorded reading. */
export function targetOf(
  reading: ReadingView,
  recorded: ReadingView,
  pending: readonly Event[],
  chosen: Chosen,
  way: Way,
): Landmark | null {
  if (pending.some(({ kind }) => kind === "undo" || kind === "redo")) return null;
  const missing = way === "walls" ? missingWall : missingCorner;
  const wanted = chosenTarget(reading, chosen, missing);
  if (wanted) return wanted;
  const next = nextLandmark(recorded, way);
  if (pending.length === 0 || !next || !("level" in next)) {
    return next && !placeOf(reading, next) ? next : null;
  }
  // The person is faster than the program: continue in the guided order up to the optional levels.
  const rest = reading.order.slice(reading.order.indexOf(next.level));
  const sure = rest.filter((level) => !OPTIONAL_LEVELS.includes(level));
  for (const level of sure) {
    const landmark = missing(reading, level);
    if (landmark) return landmark;
  }
  return null;
}

function chosenTarget(
  reading: ReadingView,
  chosen: Chosen,
  missing: typeof missingCorner,
): Landmark | null {
  if (chosen === null) return null;
  return chosen === CRESTS ? missingCrest(reading) : missing(reading, chosen);
}
