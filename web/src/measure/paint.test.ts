import { expect, it } from "vitest";

import { greyTable } from "./grey";
import { paint } from "./paint";
import { Pyramid } from "./pyramid";
import { UPRIGHT, type Turn } from "./turn";
import { cssOf } from "./viewport";

/** Node lacks a canvas; painting needs only these parts of `ImageData`. */
function target(width: number, height: number): ImageData {
  return { width, height, data: new Uint8ClampedArray(4 * width * height) } as ImageData;
}

const red = (image: ImageData, x: number, y: number): number =>
  image.data[4 * (y * image.width + x)]!;

/** A black film with one bright pixel. */
function dot(columns: number, rows: number, column: number, row: number): Pyramid {
  const values = new Uint16Array(columns * rows);
  values[row * columns + column] = 255;
  return new Pyramid({ columns, rows, values });
}

const TABLE = greyTable({ centre: 127.5, width: 255 }, false, 255);

it.each([
  { ratio: 1, aspect: 1 },
  { ratio: 1.25, aspect: 1 },
  { ratio: 2, aspect: 0.5 },
  { ratio: 1.25, aspect: 2 },
  { ratio: 1, aspect: 1, turn: { mirrored: true, quarters: 0 }, left: 140.4 },
  { ratio: 1.25, aspect: 2, turn: { mirrored: false, quarters: 1 }, left: 180.4 },
  { ratio: 2, aspect: 0.5, turn: { mirrored: true, quarters: 3 }, left: 70.3, top: 10.6 },
] satisfies { ratio: number; aspect: number; turn?: Turn; left?: number; top?: number }[])(
  "paints a pixel at the place of its landmark: $ratio device pixels, aspect $aspect, $turn",
  ({ ratio, aspect, turn = UPRIGHT, left = 10.4, top = -7.2 }) => {
    const view = { scale: 8, aspect, left, top, turn };
    const image = target(Math.floor(160 * ratio), Math.floor(160 * ratio));
    paint(image, dot(16, 16, 7, 5), view, ratio, TABLE);
    let [sum, x, y] = [0, 0, 0];
    for (let row = 0; row < image.height; row += 1) {
      for (let column = 0; column < image.width; column += 1) {
        const weight = red(image, column, row);
        sum += weight;
        x += weight * (column + 0.5);
        y += weight * (row + 0.5);
      }
    }
    // The centre of brightness in CSS pixels against the transform of landmarks.
    const [cssX, cssY] = cssOf(view, [7, 5]);
    expect(Math.abs(x / sum / ratio - cssX)).toBeLessThan(0.1);
    expect(Math.abs(y / sum / ratio - cssY)).toBeLessThan(0.1);
  },
);

it("averages brightness before the window, not after", () => {
  const film = new Pyramid({ columns: 2, rows: 1, values: Uint16Array.from([0, 100]) });
  const steep = greyTable({ centre: 60, width: 1 }, false, 100);
  const image = target(32, 16);
  paint(image, film, { scale: 16, aspect: 1, left: 0, top: 0, turn: UPRIGHT }, 1, steep);
  const row = Array.from({ length: 32 }, (_, x) => red(image, x, 8));
  // Half way between both pixels the brightness is 50: still black.
  expect(row.findIndex((grey) => grey > 127)).toBe(18);
});

it("paints black outside of the film", () => {
  const film = new Pyramid({ columns: 1, rows: 1, values: Uint16Array.from([255]) });
  const image = target(30, 30);
  paint(image, film, { scale: 10, aspect: 1, left: 10, top: 10, turn: UPRIGHT }, 1, TABLE);
  expect([red(image, 9, 15), red(image, 10, 15), red(image, 19, 15), red(image, 20, 15)]).toEqual([
    0, 255, 255, 0,
  ]);
});
