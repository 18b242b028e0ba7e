import type { Api } from "../api/types";
import type { Event } from "./landmarks";
import type { FilmPoint } from "./viewport";

/** Time that a dropped axis waits for its angle. */
export const TURN_MS = 5_000;

/** A dragged axis: the program computes its angle, which comes with an answer. */
export interface Turning {
  readonly level: string;
  readonly towards: FilmPoint;
}

export interface PreviewWish {
  readonly events: readonly Event[];
  readonly turn?: Turning;
  /** Time of the pointer's move. */
  readonly at: number;
}

/** The event of an axis as the program has turned it. */
export function turnedIn(preview: Api<"Preview">, level: string): Event | null {
  const axis = preview.reading.vertebrae.find((vertebra) => vertebra.level === level)?.axis;
  return axis ? { kind: "set_axis", level, axis_deg: axis.axis_deg } : null;
}
