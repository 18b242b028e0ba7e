import { describe, expect, it } from "vitest";

import { headingsOf, sorted, type Row } from "./table";

function row(study: string, cobb_deg: number | null): Row {
  const text = cobb_deg === null ? "–" : `${cobb_deg}°`;
  return {
    study,
    synthetic: false,
    status: "measured",
    excluded: null,
    cells: [{ heading: "main Cobb (°)", text, value: cobb_deg }],
  };
}

const ROWS = [row("S-10", 9), row("S-2", 48.2), row("A", null)];
const studies = (rows: Row[]): string[] => rows.map((found) => found.study);

describe("the cohort's table", () => {
  it("sorts studies with numbers by value", () => {
    expect(studies(sorted(ROWS, null, false))).toEqual(["A", "S-2", "S-10"]);
    expect(studies(sorted(ROWS, null, true))).toEqual(["S-10", "S-2", "A"]);
  });

  it("sorts by value and not by text; rows without a value are last", () => {
    expect(studies(sorted(ROWS, "main Cobb (°)", false))).toEqual(["S-10", "S-2", "A"]);
    expect(studies(sorted(ROWS, "main Cobb (°)", true))).toEqual(["S-2", "S-10", "A"]);
  });

  it("has each heading once", () => {
    expect(headingsOf(ROWS)).toEqual(["main Cobb (°)"]);
  });
});
