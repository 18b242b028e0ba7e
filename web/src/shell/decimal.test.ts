import { expect, test } from "vitest";

import { decimalFault, parseDecimal } from "./decimal";

test("a decimal comma is a decimal point", () => {
  expect(parseDecimal("25,4")).toBe(25.4);
  expect(parseDecimal("0,18")).toBe(0.18);
  expect(parseDecimal(" 25.4 ")).toBe(25.4);
  expect(parseDecimal(",5")).toBe(0.5);
  expect(parseDecimal("-3")).toBe(-3);
});

test("what may be read in two ways is not read", () => {
  for (const text of ["1.234,5", "1,234.5", "1 234", "25,4 mm", "1e3", "", "."]) {
    expect(parseDecimal(text)).toBeNull();
  }
});

test("a fault names the value and the limits", () => {
  expect(decimalFault("254", [1, 200], "mm")).toBe("254 mm: expected 1 to 200 mm");
  expect(decimalFault("1.234,5", [1, 200], "mm")).toContain("1.234,5");
  expect(decimalFault("25,4", [1, 200], "mm")).toBeNull();
  expect(decimalFault("", [1, 200], "mm")).toBeNull();
});
