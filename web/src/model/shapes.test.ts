import { describe, expect, it } from "vitest";

import { along, at, corner, extent, type BodySize, type Shape } from "./shapes";

const BODY: BodySize = { level: "T7", width_mm: 30, depth_mm: 20, height_mm: 10 };

const UPRIGHT: Shape["rotations"][number] = [1, 0, 0, 0, 1, 0, 0, 0, 1];
/** A quarter turn about the anterior axis, right-handed: left goes to cranial, cranial to the right. */
const LEANING: Shape["rotations"][number] = [1, 0, 0, 0, 0, -1, 0, 1, 0];

function shape(rotation: Shape["rotations"][number], midpoint: [number, number, number]): Shape {
  return { midpoints_mm: [midpoint], rotations: [rotation], joints_mm: [midpoint] };
}

describe("a vertebra's corner", () => {
  it("lies along the axes of an unrotated body", () => {
    expect(corner(shape(UPRIGHT, [1, 2, 3]), 0, BODY, [1, 1, 1])).toEqual([11, 17, 8]);
  });

  it("rotates with the body, whose axes are the columns of a matrix given by rows", () => {
    // Half a width to its left is 15 mm up, half a height cranially 5 mm to the right.
    expect(corner(shape(LEANING, [0, 0, 0]), 0, BODY, [0, 1, 0])).toEqual([0, 0, 15]);
    expect(corner(shape(LEANING, [0, 0, 0]), 0, BODY, [1, 0, 1])).toEqual([10, -5, 0]);
  });
});

describe("a path", () => {
  const path = [shape(UPRIGHT, [0, 0, 0]), shape(UPRIGHT, [0, 8, 0]), shape(LEANING, [0, 8, 4])];

  it("passes through all computed shapes", () => {
    expect(along(path, 0)).toBe(path[0]);
    expect(along(path, 0.5)).toBe(path[1]);
    expect(along(path, 1)).toBe(path[2]);
  });

  it("interpolates places linearly and rotations evenly", () => {
    const between = along(path, 0.75);
    expect(between.midpoints_mm[0]).toEqual([0, 8, 2]);
    const expected = [1, 0, 0, 0, Math.SQRT1_2, -Math.SQRT1_2, 0, Math.SQRT1_2, Math.SQRT1_2];
    at(between.rotations, 0).forEach((value, i) => expect(value).toBeCloseTo(at(expected, i), 12));
  });

  it("is constant beyond its ends", () => {
    expect(along(path, -1)).toBe(path[0]);
    expect(along(path, 7)).toBe(path[2]);
    expect(along(path.slice(0, 1), 0.4)).toBe(path[0]);
  });
});

it("contains every body at any rotation", () => {
  const [low, high] = extent([shape(UPRIGHT, [0, 0, 0]), shape(LEANING, [0, 40, 0])], [BODY]);
  expect(low).toEqual([-15, -15, -15]);
  expect(high).toEqual([15, 55, 15]);
});
