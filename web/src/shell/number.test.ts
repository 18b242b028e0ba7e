import { expect, test } from "vitest";

import { fixed, threeDigits } from "./number";

test("a negative number has a minus sign and no hyphen", () => {
  expect(fixed(-0.17, 2)).toBe("−0.17");
  expect(fixed(998, 0)).toBe("998");
  expect(threeDigits(-12.34)).toBe("−12.3");
});

test("zero has no sign", () => {
  for (const tiny of [0, -0, -0.004, 0.004]) expect(fixed(tiny, 2)).toBe("0.00");
  expect(threeDigits(-0)).toBe("0");
});

test("what is missing is a dash", () => {
  for (const missing of [null, undefined, NaN, Infinity, -Infinity]) {
    expect([fixed(missing, 1), threeDigits(missing)]).toEqual(["–", "–"]);
  }
});
