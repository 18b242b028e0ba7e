import type { Api } from "../api/types";

export type Shape = Api<"Shape">;
export type BodySize = Api<"BodySize">;
/** In the patient's frame, in mm: anterior, to the patient's left, cranial. */
export type Point = [number, number, number];

/** Place of a point of a vertebra: `local` is along its anterior, left and cranial axes from its midpoint. */
export function placed(shape: Shape, index: number, local: Point): Point {
  const origin = at(shape.midpoints_mm, index);
  const turn = at(shape.rotations, index);
  const row = (first: number): number =>
    at(turn, first) * local[0] + at(turn, first + 1) * local[1] + at(turn, first + 2) * local[2];
  return [at(origin, 0) + row(0), at(origin, 1) + row(3), at(origin, 2) + row(6)];
}

/** A corner of a vertebral body: each part is -1, 0 or 1 of half its depth, width and height. */
export function corner(shape: Shape, index: number, body: BodySize, part: Point): Point {
  return placed(shape, index, [
    (part[0] * body.depth_mm) / 2,
    (part[1] * body.width_mm) / 2,
    (part[2] * body.height_mm) / 2,
  ]);
}

const AROUND = [
  [-1, -1],
  [1, -1],
  [1, 1],
  [-1, 1],
] as const;

/** The corners around a body, in the plane of an axis (0 anterior, 1 to the left) and the cranial one. */
export const around = (shape: Shape, index: number, body: BodySize, axis: 0 | 1): Point[] =>
  AROUND.map(([a, z]) => corner(shape, index, body, axis === 1 ? [0, a, z] : [a, 0, z]));

/**
 * The shape at a part of a path, from 0 to 1. Between computed shapes, points are interpolated linearly and axes
 * rotate evenly: this is an animation, not a simulation.
 */
export function along(path: readonly Shape[], part: number): Shape {
  const place = Math.min(Math.max(part, 0), 1) * (path.length - 1);
  const index = Math.min(Math.floor(place), Math.max(path.length - 2, 0));
  const from = at(path, index);
  const to = path[index + 1];
  const share = place - index;
  if (!to || share === 0) return from;
  if (share === 1) return to;
  const points = (a: readonly number[][], b: readonly number[][]): Point[] =>
    a.map((p, i) => mix(p, at(b, i), share) as Point);
  return {
    midpoints_mm: points(from.midpoints_mm, to.midpoints_mm),
    joints_mm: points(from.joints_mm, to.joints_mm),
    rotations: from.rotations.map((r, i) => upright(mix(r, at(to.rotations, i), share))),
  };
}

/** Lowest and highest coordinates of all bodies of some shapes. */
export function extent(shapes: readonly Shape[], bodies: readonly BodySize[]): [Point, Point] {
  const low: Point = [Infinity, Infinity, Infinity];
  const high: Point = [-Infinity, -Infinity, -Infinity];
  for (const shape of shapes) {
    shape.midpoints_mm.forEach((midpoint, index) => {
      const body = at(bodies, index);
      const reach = Math.max(body.depth_mm, body.width_mm, body.height_mm) / 2;
      for (const axis of [0, 1, 2] as const) {
        low[axis] = Math.min(low[axis], at(midpoint, axis) - reach);
        high[axis] = Math.max(high[axis], at(midpoint, axis) + reach);
      }
    });
  }
  return [low, high];
}

/** An entry that the interface guarantees; its absence is a bug of the program. */
export function at<T>(list: readonly T[], index: number): T {
  const entry = list[index];
  if (entry === undefined) throw new Error(`the model lacks entry ${index} of ${list.length}`);
  return entry;
}

function mix(a: readonly number[], b: readonly number[], share: number): number[] {
  return a.map((value, i) => value + (at(b, i) - value) * share);
}

/** Makes the columns of a nearly orthonormal matrix orthonormal: cranial first, then left, then their normal. */
function upright(m: number[]): Shape["rotations"][number] {
  const column = (i: number): Point => [at(m, i), at(m, i + 3), at(m, i + 6)];
  const cranial = unit(column(2));
  const slanted = column(1);
  const shared = dot(slanted, cranial);
  const left = unit([
    slanted[0] - shared * cranial[0],
    slanted[1] - shared * cranial[1],
    slanted[2] - shared * cranial[2],
  ]);
  const anterior: Point = [
    left[1] * cranial[2] - left[2] * cranial[1],
    left[2] * cranial[0] - left[0] * cranial[2],
    left[0] * cranial[1] - left[1] * cranial[0],
  ];
  return [0, 1, 2].flatMap((row) => [
    at(anterior, row),
    at(left, row),
    at(cranial, row),
  ]) as Shape["rotations"][number];
}

function dot(a: Point, b: Point): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function unit(a: Point): Point {
  const length = Math.sqrt(dot(a, a));
  return [a[0] / length, a[1] / length, a[2] / length];
}
