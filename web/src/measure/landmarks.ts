import type { Api } from "../api/types";
import { fixed } from "../shell/number";
import type { Way } from "./proposals";
import { filmPoint, type FilmPoint } from "./viewport";

export type Corner = Api<"CornerName">;
type PatientSide = Api<"SideName">;
export type Event = Api<"Event">;
export type ReadingView = Api<"ReadingView">;
export type VertebraView = Api<"VertebraView">;

/** In the order of placing. */
export const SIDES: readonly PatientSide[] = ["left", "right"];

/** Corners of a body on a frontal film, in the order of placing: around the body. */
const FRONTAL_CORNERS = [
  "superior_left",
  "superior_right",
  "inferior_right",
  "inferior_left",
] as const satisfies Corner[];

/** Corners of a body on the lateral film. */
const LATERAL_CORNERS = [
  "superior_anterior",
  "superior_posterior",
  "inferior_posterior",
  "inferior_anterior",
] as const satisfies Corner[];

/** All corners of both views, each view around the body. */
export const CORNERS: readonly Corner[] = [...FRONTAL_CORNERS, ...LATERAL_CORNERS];

/** Corners of a body on one film. */
export const CORNER_COUNT = FRONTAL_CORNERS.length;

/** Corners of a body on this film, in the order of placing. */
export const cornersOf = ({ image }: Pick<ReadingView, "image">): readonly Corner[] =>
  image.is_lateral ? LATERAL_CORNERS : FRONTAL_CORNERS;

/** Optional levels, read on request only. */
export const OPTIONAL_LEVELS: readonly string[] = ["T1", "L5"];

export const CORNER_WORDS: Record<Corner, string> = {
  superior_left: "superior endplate, patient’s left",
  superior_right: "superior endplate, patient’s right",
  inferior_left: "inferior endplate, patient’s left",
  inferior_right: "inferior endplate, patient’s right",
  superior_anterior: "superior endplate, front",
  superior_posterior: "superior endplate, back",
  inferior_anterior: "inferior endplate, front",
  inferior_posterior: "inferior endplate, back",
};

/** Order of levels from the head down. */
export function cranialFirst(a: string, b: string): number {
  const height = (name: string): number => {
    const number = Number(name.slice(1));
    return name.startsWith("L") ? -number : 100 - number;
  };
  return height(b) - height(a);
}

/** The level above or below; null beyond the known levels. */
export function levelBeside({ order }: ReadingView, level: string, up: boolean): string | null {
  const levels = order.toSorted(cranialFirst);
  return levels[levels.indexOf(level) + (up ? -1 : 1)] ?? null;
}

/** Whether its observer can still place landmarks. */
export const isChangeable = ({
  mine,
  finished,
  withdrawn,
}: Pick<Api<"ReadingSummary">, "mine" | "finished" | "withdrawn">): boolean =>
  mine && !finished && !withdrawn;

/** A landmark or an axis on the film that can be selected and moved. */
export type Landmark =
  | Api<"ExpectedLandmark">
  | { kind: "pedicle"; level: string; side: PatientSide }
  | { kind: "axis"; level: string };

export function sameLandmark(a: Landmark | null, b: Landmark | null): boolean {
  return a !== null && b !== null && wordsOf(a) === wordsOf(b);
}

export function wordsOf(landmark: Landmark): string {
  if (landmark.kind === "corner") return `${landmark.level} – ${CORNER_WORDS[landmark.corner]}`;
  if (landmark.kind === "axis") return `${landmark.level} – axis`;
  if (landmark.kind === "wall") return `${landmark.level} – ${wallWords(landmark.side)}`;
  if (landmark.kind === "pedicle") return `${landmark.level} – ${pedicleWords(landmark.side)}`;
  return `iliac crest, patient’s ${landmark.side}`;
}

export const wallWords = (side: PatientSide): string => `middle of the wall, patient’s ${side}`;

export const pedicleWords = (side: PatientSide): string =>
  `centre of the pedicle, patient’s ${side}`;

export function placeOf(reading: ReadingView, landmark: Landmark): FilmPoint | null {
  if (landmark.kind === "crest") {
    const px = landmark.side === "left" ? reading.crests.left_px : reading.crests.right_px;
    return px ? filmPoint(px) : null;
  }
  const vertebra = reading.vertebrae.find(({ level }) => level === landmark.level);
  if (landmark.kind === "wall" || landmark.kind === "pedicle") {
    const both = landmark.kind === "wall" ? vertebra?.walls : vertebra?.pedicles;
    const px = landmark.side === "left" ? both?.left_px : both?.right_px;
    return px ? filmPoint(px) : null;
  }
  if (landmark.kind === "axis") return vertebra?.axis ? filmPoint(vertebra.axis.to_px) : null;
  const corner = vertebra?.corners.find(({ corner }) => corner === landmark.corner);
  return corner ? filmPoint(corner.px) : null;
}

/** These corners of a level, placed or not. */
export const cornersAt = (level: string, corners: readonly Corner[]): Landmark[] =>
  corners.map((corner) => ({ kind: "corner", level, corner }));

/** Both walls or both pedicles of a level, placed or not. */
const sidesAt = (level: string, kind: "wall" | "pedicle"): Landmark[] =>
  SIDES.map((side) => ({ kind, level, side }));

const BOTH_CRESTS = SIDES.map((side): Landmark => ({ kind: "crest", side }));

/** All placed landmarks in cranial order, in which the keys go through them. */
export function landmarksOf(reading: ReadingView): Landmark[] {
  const vertebrae = reading.vertebrae.flatMap(({ level, corners }): Landmark[] => [
    ...(corners.length === 0 ? sidesAt(level, "wall") : []),
    ...cornersAt(level, CORNERS),
    ...sidesAt(level, "pedicle"),
    { kind: "axis", level },
  ]);
  return [...vertebrae, ...BOTH_CRESTS].filter((landmark) => placeOf(reading, landmark) !== null);
}

/** The landmark before or after the selected one; undefined at the ends. */
export function landmarkBeside(
  reading: ReadingView,
  selected: Landmark | null,
  by: 1 | -1,
): Landmark | undefined {
  const landmarks = landmarksOf(reading);
  const now = landmarks.findIndex((landmark) => sameLandmark(landmark, selected));
  return landmarks[now < 0 ? (by > 0 ? 0 : landmarks.length - 1) : now + by];
}

/** The event that places a landmark. */
export function placing(
  reading: ReadingView,
  landmark: Landmark,
  [column_px, row_px]: FilmPoint,
): Event {
  if (landmark.kind === "crest") {
    return { kind: "place_iliac_crest", side: landmark.side, column_px, row_px };
  }
  if (landmark.kind === "wall" || landmark.kind === "pedicle") {
    const { level, side } = landmark;
    return { kind: `place_${landmark.kind}`, level, side, column_px, row_px };
  }
  if (landmark.kind === "axis") throw new Error("an axis is rotated, not placed");
  const kind = placeOf(reading, landmark) ? "move_corner" : "place_corner";
  return { kind, level: landmark.level, corner: landmark.corner, column_px, row_px };
}

/** Places are rounded to 0.001 px. */
export function round([column, row]: FilmPoint): FilmPoint {
  return [Math.round(column * 1_000) / 1_000, Math.round(row * 1_000) / 1_000];
}

/** The same event on a changed reading: a corner is placed or moved, depending on whether it exists. */
export function fresh(reading: ReadingView, event: Event): Event {
  if (event.kind !== "place_corner" && event.kind !== "move_corner") return event;
  const landmark: Landmark = { kind: "corner", level: event.level, corner: event.corner };
  return placing(reading, landmark, [event.column_px, event.row_px]);
}

/** The first landmark without a place. */
const firstMissing = (reading: ReadingView, landmarks: readonly Landmark[]): Landmark | null =>
  landmarks.find((landmark) => placeOf(reading, landmark) === null) ?? null;

/** The next missing corner of a level; null when its four corners exist. */
export const missingCorner = (reading: ReadingView, level: string): Landmark | null =>
  firstMissing(reading, cornersAt(level, cornersOf(reading)));

/** The next missing wall of a level; null when both exist, or one of its corners does. */
export function missingWall(reading: ReadingView, level: string): Landmark | null {
  const vertebra = reading.vertebrae.find((one) => one.level === level);
  return vertebra?.corners.length ? null : firstMissing(reading, sidesAt(level, "wall"));
}

/** The next missing pedicle of a level; null when both exist. */
export const missingPedicle = (reading: ReadingView, level: string): Landmark | null =>
  firstMissing(reading, sidesAt(level, "pedicle"));

/** The next missing crest; null when both exist. */
export const missingCrest = (reading: ReadingView): Landmark | null =>
  firstMissing(reading, BOTH_CRESTS);

export function nextLandmark(reading: ReadingView, way: Way): Landmark | null {
  return (way === "walls" ? reading.next_by_walls : reading.next) ?? null;
}

/**
 * The reading after events are recorded, as far as the page can know it: places only. Results
 * come from the program with its answer.
 */
export function withEvents(reading: ReadingView, events: readonly Event[]): ReadingView {
  return events.reduce(withEvent, reading);
}

function withEvent(reading: ReadingView, event: Event): ReadingView {
  switch (event.kind) {
    case "place_corner":
    case "move_corner": {
      const px = [event.column_px, event.row_px];
      return changed(reading, event.level, (vertebra) => {
        const before = vertebra.corners.find(({ corner }) => corner === event.corner);
        const others = vertebra.corners.filter((one) => one !== before);
        const origin = (before?.origin ?? "clicked") === "clicked" ? "clicked" : "adjusted";
        const corners = [...others, { corner: event.corner, px, origin } as const];
        return { ...vertebra, corners, complete: corners.length === CORNER_COUNT };
      });
    }
    case "place_wall":
    case "place_pedicle": {
      const px = [event.column_px, event.row_px];
      const kind = event.kind === "place_wall" ? "walls" : "pedicles";
      return changed(reading, event.level, (vertebra) => ({
        ...vertebra,
        [kind]: { ...vertebra[kind], [`${event.side}_px`]: px },
      }));
    }
    case "accept_corners":
      return event.vertebrae.reduce(
        (before, { level, corners }) =>
          changed(before, level, (vertebra) => ({
            ...vertebra,
            corners: CORNERS.flatMap((corner) => {
              const px = corners[corner];
              return px ? [{ corner, px, origin: "accepted" } as const] : [];
            }),
            complete: true,
          })),
        reading,
      );
    case "set_axis":
      return changed(reading, event.level, (vertebra) => {
        const { axis } = vertebra;
        if (!axis) return vertebra;
        // The line to draw comes with the program's answer; its angle is needed for the next step of the keys.
        const by_hand = event.axis_deg != null;
        return {
          ...vertebra,
          axis: { ...axis, axis_deg: event.axis_deg ?? axis.axis_deg, by_hand },
        };
      });
    case "remove_vertebra":
      return {
        ...reading,
        vertebrae: reading.vertebrae.filter(({ level }) => level !== event.level),
      };
    case "shift_levels":
      return {
        ...reading,
        vertebrae: reading.vertebrae.flatMap((vertebra) => {
          const level = levelBeside(reading, vertebra.level, event.up);
          return level ? [{ ...vertebra, level }] : [];
        }),
      };
    case "place_iliac_crest": {
      const px = [event.column_px, event.row_px];
      const crests = { ...reading.crests, [`${event.side}_px`]: px };
      return { ...reading, crests };
    }
    case "invert":
      return { ...reading, image: { ...reading.image, inverted: event.inverted } };
    case "note":
      return { ...reading, notes: [...reading.notes, event.text] };
    default:
      return reading;
  }
}

function changed(
  reading: ReadingView,
  level: string,
  change: (vertebra: VertebraView) => VertebraView,
): ReadingView {
  const empty: VertebraView = {
    level,
    corners: [],
    walls: { left_px: null, right_px: null },
    pedicles: { left_px: null, right_px: null },
    complete: false,
    midpoint_px: null,
    axis: null,
  };
  const found = reading.vertebrae.find((vertebra) => vertebra.level === level);
  const vertebra = change(found ?? empty);
  const others = reading.vertebrae.filter((other) => other.level !== level);
  return { ...reading, vertebrae: [...others, vertebra] };
}

/**
 * Events without those that they undo themselves. An undo of an earlier event is removed too: on a reading
 * that has changed, it would undo another event.
 */
export function remaining(events: readonly Event[]): Event[] {
  const done: Event[] = [];
  let undone: Event[] = [];
  for (const event of events) {
    if (event.kind === "undo") {
      // Notes are never undone.
      const last = done.findLastIndex(({ kind }) => kind !== "note");
      if (last >= 0) undone.push(...done.splice(last, 1));
    } else if (event.kind === "redo") {
      const again = undone.pop();
      if (again) done.push(again);
    } else {
      done.push(event);
      if (event.kind !== "note") undone = [];
    }
  }
  return done;
}

/** Number of possible undos and redos after the events being sent are recorded. */
export function stepsAfter(
  recorded: Pick<ReadingView, "undoable" | "redoable">,
  pending: readonly Event[],
): { undoable: number; redoable: number } {
  let { undoable, redoable } = recorded;
  for (const { kind } of pending) {
    if (kind === "note") continue;
    undoable += kind === "undo" ? -1 : 1;
    if (kind === "undo") redoable += 1;
    else redoable = kind === "redo" ? redoable - 1 : 0;
  }
  return { undoable, redoable };
}

/** Column and row after the name of a landmark; empty without a place. */
export const placeWords = (place: FilmPoint | null): string =>
  place ? `, column ${fixed(place[0], 1)} px, row ${fixed(place[1], 1)} px` : "";

/** Text of an event for the dialog on lost changes. */
export function wordsOfEvent(event: Event): string {
  const at = (column: number, row: number): string => `(${fixed(column, 1)}, ${fixed(row, 1)}) px`;
  switch (event.kind) {
    case "place_corner":
    case "move_corner":
      return `${event.level} – ${CORNER_WORDS[event.corner]} to ${at(event.column_px, event.row_px)}`;
    case "place_wall":
      return `${event.level} – ${wallWords(event.side)} to ${at(event.column_px, event.row_px)}`;
    case "place_pedicle":
      return `${event.level} – ${pedicleWords(event.side)} to ${at(event.column_px, event.row_px)}`;
    case "accept_corners":
      return `corners accepted of ${event.vertebrae.map(({ level }) => level).join(", ")}`;
    case "take_vertebra":
      return `corners of ${event.level} as in a file`;
    case "set_axis":
      return event.axis_deg === null || event.axis_deg === undefined
        ? `${event.level} – axis follows the corners`
        : `${event.level} – axis rotated by hand to ${fixed(event.axis_deg, 1)}°`;
    case "remove_vertebra":
      return `${event.level} removed`;
    case "shift_levels":
      return `all levels one ${event.up ? "up" : "down"}`;
    case "place_iliac_crest":
      return `iliac crest, patient’s ${event.side}, to ${at(event.column_px, event.row_px)}`;
    case "invert":
      return event.inverted ? "grey levels inverted" : "grey levels not inverted";
    case "note":
      return `note: ${event.text}`;
    case "scale":
      return `scale of ${event.length_mm} mm`;
    case "undo":
      return "undo";
    case "redo":
      return "redo";
  }
}
