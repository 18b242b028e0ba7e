import { expect, test } from "vitest";

import { nearestSite } from "./sites";

const places = [
  { site: "L4", at: [100, 400] as const },
  { site: "L4/L3", at: [100, 380] as const },
  { site: "L3", at: [102, 360] as const },
];

test("a click picks the nearest place", () => {
  expect(nearestSite(places, [110, 392])).toBe("L4");
  expect(nearestSite(places, [95, 383])).toBe("L4/L3");
});

test("a click far from the curve picks nothing", () => {
  expect(nearestSite(places, [200, 380])).toBeNull();
  expect(nearestSite([], [100, 400])).toBeNull();
});
