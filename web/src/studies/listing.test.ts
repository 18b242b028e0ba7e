import { describe, expect, it } from "vitest";

import { study } from "../../e2e/made";
import { chosen, scaleTrouble, type Choice, type Study } from "./listing";

const STUDIES = [
  study("S-2", { label: "Pilot <b>cohort</b>", changed_ms: 3 }),
  study("S-10", {
    status: "measured",
    changed_ms: 1,
    curve: {
      size_deg: 48.2,
      is_cobb: true,
      region: "main thoracic",
      text: "Lenke 1, main thoracic 48.2°",
    },
  }),
  study("A", { status: "refused", contradictions: 2, changed_ms: 2 }),
  study("OLD", { status: "measured", archived: true }),
];

function ids(choice: Partial<Choice>): string[] {
  const all: Choice = { search: "", status: "all", order: "id", archived: false, ...choice };
  return chosen(STUDIES, all).map((found) => found.id);
}

describe("the list of studies", () => {
  it("finds by identifier, label, curve and status, in any case and order", () => {
    expect(ids({ search: "s-10" })).toEqual(["S-10"]);
    expect(ids({ search: "PILOT" })).toEqual(["S-2"]);
    expect(ids({ search: "thoracic lenke" })).toEqual(["S-10"]);
    expect(ids({ search: "contradicted" })).toEqual(["A"]);
    expect(ids({ search: "nothing like it" })).toEqual([]);
  });

  it("treats the search text literally", () => {
    expect(ids({ search: "<b>" })).toEqual(["S-2"]);
    expect(ids({ search: ".*" })).toEqual([]);
  });

  it("filters by status", () => {
    expect(ids({ status: "measured" })).toEqual(["S-10"]);
  });

  it("shows archived studies only on request", () => {
    expect(ids({ archived: true })).toEqual(["OLD"]);
  });

  it("sorts numbers in identifiers by value", () => {
    expect(ids({ order: "id" })).toEqual(["A", "S-2", "S-10"]);
    expect(ids({ order: "changed" })).toEqual(["S-2", "A", "S-10"]);
    expect(ids({ order: "cobb" })).toEqual(["S-10", "A", "S-2"]);
    expect(ids({ order: "trouble" })[0]).toBe("A");
  });

  it("reports films without a scale", () => {
    const film = (plane: "patient" | "pixels" | "unknown") =>
      ({ image: { plane } }) as Study["films"][number];
    expect(scaleTrouble(study("A", { films: [] }))).toBeNull();
    expect(scaleTrouble(study("A", { films: [film("patient")] }))).toBeNull();
    expect(scaleTrouble(study("A", { films: [film("patient"), film("pixels")] }))).toBe(
      "no scale on 1 of 2: angles only",
    );
    expect(scaleTrouble(study("A", { films: [film("unknown")] }))).toContain("unknown plane");
  });
});
