import { expect, it } from "vitest";

import { presetsOf, sameWindow } from "./presets";
import { Pyramid } from "./pyramid";

/** A film with one pixel of each brightness from 0 to 999. */
const values = Uint16Array.from({ length: 1000 }, (_, value) => value);
const picture = {
  columns: 1000,
  rows: 1,
  aspect: 1,
  max: 999,
  window: { centre: 500, width: 400 },
  fileWindows: [
    { centre: 500, width: 400 },
    { centre: 600, width: 300 },
  ],
  pyramid: new Pyramid({ columns: 1000, rows: 1, values }),
};

it("are the file's windows, and those between parts of the pixels", () => {
  const presets = presetsOf(picture);
  const ends = presets.map(({ label, window: { centre, width } }) => [
    label,
    centre - width / 2,
    centre + width / 2,
  ]);
  expect(ends).toEqual([
    ["As filmed 1", 300, 700],
    ["As filmed 2", 450, 750],
    ["Bone", 500, 998],
    ["Soft tissue", 50, 800],
    ["Darkest to brightest 1 %", 10, 990],
    ["Full range", 0, 999],
  ]);
  expect(sameWindow(presets[0]!.window, picture.window)).toBe(true);
});

it("lack file windows for a file without windows", () => {
  const labels = presetsOf({ ...picture, fileWindows: [] }).map(({ label }) => label);
  expect(labels[0]).toBe("Bone");
});
