import { expect, it } from "vitest";

import { barLength_mm, meanWidth_mm, movedText } from "./scale";

const film = { row_mm: 0.2, image: { rows: 4000, pixel_aspect: 2 } };
const body = {
  corners: [
    { corner: "superior_left" as const, px: [100, 0], origin: "clicked" as const },
    { corner: "superior_right" as const, px: [400, 40], origin: "clicked" as const },
    { corner: "inferior_right" as const, px: [400, 240], origin: "clicked" as const },
    { corner: "inferior_left" as const, px: [100, 200], origin: "clicked" as const },
  ],
};

it("measures bodies between the middles of their walls, on pixels that are not square", () => {
  // 300 columns of 0.1 mm and 40 rows of 0.2 mm.
  expect(meanWidth_mm(film, [body])).toBeCloseTo(Math.hypot(30, 8), 12);
  expect(meanWidth_mm(film, [{ corners: body.corners.slice(1) }])).toBeNull();
  expect(meanWidth_mm({ ...film, row_mm: null }, [body])).toBeNull();
});

it("says what a new scale has moved", () => {
  const after = { ...film, row_mm: 0.1 };
  expect(movedText(film, after, [body])).toBe(
    "Scale: 0.2000 → 0.1000 mm per row; film 800 → 400 mm high; mean body 31.0 → 15.5 mm wide",
  );
  expect(movedText({ ...film, row_mm: null }, film, [])).toBe(
    "Scale: unknown → 0.2000 mm per row; film unknown → 800 mm high",
  );
});

it("uses a round length for the bar", () => {
  expect(barLength_mm(1)).toBe(100);
  expect(barLength_mm(1.6)).toBe(100);
  expect(barLength_mm(1.61)).toBe(50);
  expect(barLength_mm(7)).toBe(20);
  expect(barLength_mm(40)).toBe(2);
});

it("keeps the bar between 64 and 160 pixels at every zoom", () => {
  for (let cssPerMm = 0.16; cssPerMm < 160; cssPerMm *= 1.07) {
    const length_css = barLength_mm(cssPerMm) * cssPerMm;
    expect(length_css).toBeGreaterThanOrEqual(64 - 1e-9);
    expect(length_css).toBeLessThanOrEqual(160);
  }
});

it("has a bar outside of the usual range of zoom", () => {
  expect(barLength_mm(0.01)).toBe(1000);
  expect(barLength_mm(1000)).toBe(1);
});
