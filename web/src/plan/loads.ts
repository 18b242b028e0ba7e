import type { Api } from "../api/types";
import { at, type Point } from "../model/shapes";

/** One load, as load files have it. */
export type Load = Api<"AppliedLoad">;
export type Kind = Load["kind"];

/** The text of a load file, which `spineline simulate --load` reads. */
export function textOf(loads: readonly Load[]): string {
  return `${JSON.stringify({ format: "spineline-load", version: 1, loads }, null, 2)}\n`;
}

/** The loads of a file that the program or this page has written; null for any other text. */
export function loadsOf(text: string): Load[] | null {
  try {
    const file = JSON.parse(text.replace(/^\uFEFF/, "")) as { loads?: unknown };
    if (!Array.isArray(file.loads)) return null;
    const loads = file.loads as Partial<Load>[];
    return loads.every((load) => typeof load?.kind === "string") ? (loads as Load[]) : null;
  } catch {
    return null;
  }
}

/** Words for the positive and the negative direction of three axes. */
type Ways = readonly [[string, string], [string, string], [string, string]];

const PATIENT: Ways = [
  ["front", "back"],
  ["patient’s left", "patient’s right"],
  ["up", "down"],
];
const OWN: Ways = [
  ["anterior", "posterior"],
  ["left", "right"],
  ["cranial", "caudal"],
];
const TURNS: Ways = [
  ["bending right", "bending left"],
  ["flexing", "extending"],
  ["turning left", "turning right"],
];

/** Part of a load that is edited. */
export type Field =
  | { key: string; type: "level"; label: string }
  | { key: string; type: "direction"; label: string }
  | { key: string; type: "number"; label: string; unit: string; limits: [number, number] }
  | { key: string; type: "vector"; label: string; unit: string; ways: Ways; isRare?: boolean };

const LEVEL: Field = { key: "level", type: "level", label: "Vertebra" };

/** Units of a field; `{force}` is replaced by the model's unit. */
const vector = (key: string, label: string, unit: string, ways: Ways) => ({
  key,
  type: "vector" as const,
  label,
  unit,
  ways,
});

const number = (key: string, label: string, unit: string, limits: [number, number]): Field => ({
  key,
  type: "number",
  label,
  unit,
  limits,
});

/** The midpoint in nearly all plans, so its fields are folded. */
const POINT: Field = {
  ...vector("point_in_vertebra_mm", "Point on the vertebra", "mm", OWN),
  isRare: true,
};

const FIELDS: Record<Kind, readonly Field[]> = {
  pad: [
    LEVEL,
    { key: "direction", type: "direction", label: "Pushes to the" },
    number("force_per_mm", "Stiffness", "{force}/mm", [0, 1000]),
    number("advance_mm", "Displacement", "mm", [-500, 500]),
    POINT,
  ],
  strap: [
    LEVEL,
    vector("anchor_mm", "Point on the ground", "mm", PATIENT),
    number("force_per_mm", "Stiffness", "{force}/mm", [0, 1000]),
    number("shortening_mm", "Shortening", "mm", [-500, 500]),
    POINT,
  ],
  rod: [
    { key: "inferior", type: "level", label: "Lower vertebra" },
    { key: "superior", type: "level", label: "Upper vertebra" },
    vector("turn_deg", "Rotation of the upper vertebra", "°", TURNS),
    vector("shift_mm", "Displacement of the upper vertebra", "mm", OWN),
  ],
  gravity: [number("body_weight", "Weight of the whole body", "{force}", [0, 10_000])],
  force_at_point: [LEVEL, vector("force", "Force", "{force}", PATIENT), POINT],
  force_on_line: [
    LEVEL,
    vector("force", "Force", "{force}", PATIENT),
    vector("point_mm", "Point of the line", "mm", PATIENT),
  ],
  follower_force: [LEVEL, vector("force_in_vertebra", "Force", "{force}", OWN), POINT],
  moment: [LEVEL, vector("moment", "Moment", "{force}·mm", TURNS)],
  follower_moment: [LEVEL, vector("moment_in_vertebra", "Moment", "{force}·mm", TURNS)],
};

/** The fields of a load, with the unit of forces of its model. */
export function fieldsOf(kind: Kind, force: string): Field[] {
  return (FIELDS[kind] ?? []).map((field) =>
    "unit" in field ? { ...field, unit: field.unit.replace("{force}", force) } : field,
  );
}

/** A value of a load by its key; a missing key has the default of the file format. */
export function valueOf(load: Load, key: string): unknown {
  const value = (load as unknown as Record<string, unknown>)[key];
  if (value !== undefined) return value;
  if (key === "timing") return load.kind === "gravity" ? "held" : "growing";
  return [0, 0, 0];
}

export const withValue = (load: Load, key: string, value: unknown): Load =>
  ({ ...load, [key]: value }) as Load;

/** The vertebra at which a load is shown. */
export function levelOf(load: Load): string | null {
  if ("level" in load) return load.level;
  return "superior" in load ? load.superior : null;
}

/** The same load on another vertebra; the end of a strap stays at its side. */
export function moved(load: Load, level: string, midpointOf: (level: string) => Point): Load {
  if (load.kind === "rod") return withValue(load, "superior", level);
  if (!("level" in load)) return load;
  const there = withValue(load, "level", level);
  if (load.kind !== "strap") return there;
  const [from, to] = [midpointOf(load.level), midpointOf(level)];
  const anchor = load.anchor_mm.map((value, axis) => value + at(to, axis) - at(from, axis));
  return withValue(there, "anchor_mm", anchor);
}

/** Whether a load can be pointed sideways in the picture. */
export const isPointed = (load: Load): boolean =>
  load.kind === "pad" || load.kind === "strap" || load.kind === "force_at_point";

/** The same load towards the patient's left (1) or right (-1). */
export function pointed(load: Load, left: 1 | -1, midpointOf: (level: string) => Point): Load {
  if (load.kind === "pad") return withValue(load, "direction", [0, left, 0]);
  if (load.kind === "force_at_point") return withValue(load, "force", sideways(load.force, left));
  if (load.kind !== "strap") return load;
  const from = midpointOf(load.level);
  const reach = load.anchor_mm.map((value, axis) => value - at(from, axis));
  const turned = sideways(reach, left);
  return withValue(
    load,
    "anchor_mm",
    turned.map((value, axis) => value + at(from, axis)),
  );
}

/** Vertebrae between the pad of a brace and its counter-pads. */
const BRACE_REACH = 4;

/** A three-point brace: a pad, and a counter-pad above and below it that hold the spine from the other side. */
export function brace(pad: Load & { kind: "pad" }, levels: readonly string[]): Load[] {
  const here = levels.indexOf(pad.level);
  const places = [here - BRACE_REACH, here + BRACE_REACH].map((place) =>
    Math.max(0, Math.min(place, levels.length - 1)),
  );
  const direction = pad.direction.map((value) => (value === 0 ? 0 : -value));
  const held = places
    .filter((place) => place !== here)
    .map((place) => ({ ...pad, level: at(levels, place), direction, advance_mm: 0 }) as Load);
  return [pad, ...held];
}

/** A vector of the same length, to one side. */
function sideways(vector: readonly number[], left: 1 | -1): number[] {
  return [0, left * Math.hypot(...vector), 0];
}
