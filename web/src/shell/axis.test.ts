import { expect, it } from "vitest";

import { axisOf, dotsAt } from "./axis";

it("an axis holds its values between round ticks", () => {
  const axis = axisOf([-14, 22], 0, 400);
  expect(axis.ticks).toEqual([-20, -10, 0, 10, 20, 30]);
  expect([axis.at(-20), axis.at(5), axis.at(30)]).toEqual([0, 200, 400]);
  expect(axisOf([0, 8.2], 100, 0).at(0)).toBe(100);
});

it("an axis of one value, or of none, has a length", () => {
  for (const values of [[], [7], [7, 7]]) {
    const { ticks, at } = axisOf(values, 0, 100);
    expect(ticks.length).toBeGreaterThan(1);
    expect(at(values[0] ?? 0)).toBe(50);
  }
});

it("a hundred thousand points are one path without repeated places", () => {
  const points = Array.from({ length: 100_000 }, (_, i) => [i % 300, i % 200] as const);
  expect(dotsAt(points).match(/M/g)).toHaveLength(600);
});
