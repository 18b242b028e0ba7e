import type { Event, ReadingView } from "./landmarks";

/** The clicks on both walls of L4. */
export const WALLS: readonly Event[] = [
  { kind: "place_wall", level: "L4", side: "left", column_px: 10, row_px: 20 },
  { kind: "place_wall", level: "L4", side: "right", column_px: 30, row_px: 20 },
];

/** A reading without landmarks, for tests. */
export function reading(): ReadingView {
  return {
    reading: 7,
    study: "S-1",
    film: 3,
    posture: "erect",
    code: null,
    observer: "tester",
    repeat: 1,
    mine: true,
    finished: false,
    withdrawn: null,
    corrects: null,
    synthetic: true,
    image: {
      columns: 3000,
      rows: 4000,
      pixel_aspect: 1,
      is_lateral: false,
      patient_left: "image_left",
      plane: "patient",
      spacing_text: "0.143 × 0.143 mm (patient)",
      inverted: false,
    },
    revision: 0,
    undoable: 0,
    redoable: 0,
    vertebrae: [],
    crests: { left_px: null, right_px: null },
    notes: [],
    order: ["L4", "L3", "L2"],
    next: { kind: "corner", level: "L4", corner: "superior_left" },
    next_by_walls: { kind: "wall", level: "L4", side: "left" },
    proposals_allowed: true,
    proposals: [],
    faults: [],
    conflicts: [],
  };
}
