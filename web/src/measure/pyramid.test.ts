import { expect, it } from "vitest";

import { Pyramid, halved, inSlices, type Plane } from "./pyramid";

function whole<T>(steps: Generator<void, T>): T {
  for (;;) {
    const step = steps.next();
    if (step.done) return step.value;
  }
}

const plane = (columns: number, rows: number, values: number[]): Plane => ({
  columns,
  rows,
  values: Uint16Array.from(values),
});

it("averages four pixels with rounding", () => {
  const half = whole(halved(plane(4, 2, [0, 1, 10, 20, 2, 3, 30, 40])));
  expect([half.columns, half.rows, ...half.values]).toEqual([2, 1, 2, 25]);
});

it("repeats the last row or column of an odd size", () => {
  const half = whole(halved(plane(3, 3, [0, 4, 8, 4, 8, 10, 20, 30, 65_535])));
  expect([half.columns, half.rows, ...half.values]).toEqual([2, 2, 4, 9, 25, 65_535]);
});

it("keeps the mean of a large picture", () => {
  const values = Array.from({ length: 512 * 512 }, (_, i) => (i * 7919) % 4096);
  const pyramid = new Pyramid(plane(512, 512, values));
  whole(pyramid.build());
  expect(pyramid.levels.map(({ columns }) => columns)).toEqual([512, 256, 128, 64]);
  const mean = (list: ArrayLike<number>): number =>
    Array.from(list).reduce((sum, value) => sum + value, 0) / list.length;
  // Every halving rounds by less than half a step.
  for (const level of pyramid.levels) {
    expect(Math.abs(mean(level.values) - mean(values))).toBeLessThan(1.5);
  }
});

it("chooses the smallest size with at least one pixel per device pixel", () => {
  const pyramid = new Pyramid(plane(512, 512, Array<number>(512 * 512).fill(0)));
  expect(pyramid.level(0.125)).toBe(0);
  whole(pyramid.build());
  expect([2, 1, 0.6, 0.5, 0.3, 0.25, 0.01].map((share) => pyramid.level(share))).toEqual([
    0, 0, 0, 1, 1, 2, 3,
  ]);
});

it("stops between slices when it is aborted", async () => {
  const pyramid = new Pyramid(plane(512, 512, Array<number>(512 * 512).fill(0)));
  await inSlices(pyramid.build(), AbortSignal.abort());
  expect(pyramid.levels).toHaveLength(1);
  await inSlices(pyramid.build(), new AbortController().signal);
  expect(pyramid.levels).toHaveLength(4);
});
