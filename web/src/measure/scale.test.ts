import { expect, it } from "vitest";

import { barLength_mm } from "./scale";

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
