import { expect, test } from "vitest";

import { barText, fixed, threeDigits, withUnit } from "./number";

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

test("lengths of the patient need no plane, others name theirs", () => {
  expect(withUnit("12.3", "mm (patient)")).toBe("12.3 mm");
  expect(withUnit("12.3", "mm (detector)")).toBe("12.3 mm (detector)");
  expect(withUnit("−0.2", "°")).toBe("−0.2°");
  expect(barText(50, "mm (patient)")).toBe("50 mm at the spine");
});
