import type { Api } from "../api/types";
import type { Event, ReadingView } from "./landmarks";
import type { FilmPoint } from "./viewport";

/** Time that a dropped axis waits for its angle. */
export const TURN_MS = 5_000;

/** A dragged axis: the program computes its angle, which comes with an answer. */
export interface Turning {
  readonly level: string;
  readonly towards: FilmPoint;
}

export interface PreviewInput {
  readonly events: readonly Event[];
  readonly turn?: Turning;
  /** Time of the pointer's move. */
  readonly at: number;
}

/** The event of an axis that keys turn by steps. */
export function turnedBy(
  reading: ReadingView,
  { level }: { level: string },
  by: FilmPoint,
): Event | null {
  const axis = reading.vertebrae.find((vertebra) => vertebra.level === level)?.axis;
  if (!axis) return null;
  // Right and up rotate clockwise as seen; a whole step rounds to 0.1°.
  const tenths = Math.round((axis.axis_deg + by[0] - by[1]) * 10);
  return { kind: "set_axis", level, axis_deg: tenths / 10 };
}

/** The event of an axis as turned by the program. */
export function turnedIn(preview: Api<"Preview">, level: string): Event | null {
  const axis = preview.reading.vertebrae.find((vertebra) => vertebra.level === level)?.axis;
  return axis ? { kind: "set_axis", level, axis_deg: axis.axis_deg } : null;
}
