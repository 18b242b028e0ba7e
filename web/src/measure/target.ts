import {
  OPTIONAL_LEVELS,
  missingCorner,
  missingCrest,
  missingPedicle,
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

/** What a level lacks. */
export const MISSING: Record<Way, typeof missingCorner> = {
  corners: missingCorner,
  walls: missingWall,
  pedicles: missingPedicle,
};

/** The next landmark, from the drawn and the recorded reading. */
export function targetOf(
  reading: ReadingView,
  recorded: ReadingView,
  pending: readonly Event[],
  chosen: Chosen,
  way: Way,
): Landmark | null {
  if (pending.some(({ kind }) => kind === "undo" || kind === "redo")) return null;
  if (way === "pedicles") return pedicleTarget(reading, chosen);
  const missing = MISSING[way];
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

/** The next pedicle: of the chosen level, or of the vertebrae with four corners in the guided order. */
function pedicleTarget(reading: ReadingView, chosen: Chosen): Landmark | null {
  const complete = reading.order.filter((level) =>
    reading.vertebrae.some((vertebra) => vertebra.level === level && vertebra.complete),
  );
  const levels = typeof chosen === "string" ? [chosen, ...complete] : complete;
  for (const level of levels) {
    const landmark = missingPedicle(reading, level);
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
