import { expect, it } from "vitest";

import { adjusted, greyTable, limited, windowOfPart, windowOfPicture } from "./grey";

const red = (colour: number): number => colour & 0xff;

it("maps the window from black to white", () => {
  const table = greyTable({ centre: 100, width: 100 }, false, 255);
  expect([0, 50, 100, 150, 255].map((value) => red(table[value]!))).toEqual([0, 0, 128, 255, 255]);
  expect(table[100]).toBe(0xff808080);
});

it("inverts grey levels", () => {
  const table = greyTable({ centre: 100, width: 100 }, true, 255);
  expect([0, 50, 150, 255].map((value) => red(table[value]!))).toEqual([255, 255, 0, 0]);
});

it("is monotonic", () => {
  const table = greyTable({ centre: 2047.5, width: 4095 }, false, 4095);
  for (let value = 1; value < table.length; value += 1) {
    expect(red(table[value]!)).toBeGreaterThanOrEqual(red(table[value - 1]!));
  }
});

it("limits the window to the range of the picture", () => {
  expect(limited({ centre: -5, width: 0 }, 4095)).toEqual({ centre: 0, width: 40.95 });
  expect(adjusted({ centre: 100, width: 100 }, { brighter: 1, wider: 9 }, 255)).toEqual({
    centre: 0,
    width: 510,
  });
});

it("excludes the darkest and the brightest percent", () => {
  const values = Uint16Array.from({ length: 1000 }, (_, i) =>
    i < 5 ? 0 : i < 995 ? 500 + i : 4095,
  );
  const window = windowOfPicture({ columns: 1000, rows: 1, values }, 4095);
  expect(window.centre - window.width / 2).toBe(510);
  expect(window.centre + window.width / 2).toBe(1490);
});

it("stretches the contrast of a part, and not its noise", () => {
  const values = new Uint16Array(10_000).fill(4000);
  for (let row = 40; row < 60; row += 1)
    for (let column = 40; column < 60; column += 1)
      values[100 * row + column] = 1000 + 40 * (column % 20);
  const plane = { columns: 100, rows: 100, values };
  const whole = { centre: 2048, width: 4096 };
  const part = windowOfPart(plane, [49.5, 49.5], 9, whole, 4095);
  expect(part.centre).toBeCloseTo(1380, -2);
  expect(part.width).toBeGreaterThan(512);
  expect(part.width).toBeLessThan(800);
  // Beside the square there is one brightness.
  expect(windowOfPart(plane, [5, 5], 3, whole, 4095)).toMatchObject({ centre: 4000, width: 512 });
  // At the edge of the picture.
  expect(windowOfPart(plane, [-2, 99.4], 9, whole, 4095).width).toBe(512);
});
