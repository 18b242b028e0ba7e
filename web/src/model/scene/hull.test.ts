import { expect, it } from "vitest";

import { hull, type Place } from "./hull";

it("keeps only the corners of a square, in order", () => {
  const places: Place[] = [
    [1, 1],
    [0, 2],
    [2, 0],
    [0, 0],
    [1, 0],
    [2, 2],
    [0.5, 1.2],
  ];
  expect(hull(places)).toEqual([
    [0, 0],
    [2, 0],
    [2, 2],
    [0, 2],
  ]);
});

it("keeps two places, and one repeated place", () => {
  expect(
    hull([
      [3, 1],
      [2, 5],
    ]),
  ).toEqual([
    [2, 5],
    [3, 1],
  ]);
  expect(
    new Set(
      hull([
        [1, 1],
        [1, 1],
        [1, 1],
      ]).map(String),
    ),
  ).toEqual(new Set(["1,1"]));
});
