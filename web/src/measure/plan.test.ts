import { expect, it } from "vitest";

import { candidates, namesIn, wholeNumber } from "./plan";

it("offers enabled accounts, and says who may not place landmarks", () => {
  const account = (name: string, role: "reader" | "editor" | "admin", enabled = true) => ({
    name,
    role,
    enabled,
  });
  const accounts = [
    account("lead", "admin"),
    account("anna", "editor"),
    account("ben", "editor"),
    account("carl", "reader"),
    account("dora", "editor"),
    account("gone", "editor", false),
  ];
  const grants = [
    { name: "anna", role: "editor" as const },
    { name: "carl", role: "editor" as const },
    { name: "dora", role: "reader" as const },
    { name: "gone", role: "editor" as const },
  ];
  const offered = candidates(accounts, grants);
  expect(offered.map(({ name }) => name)).toEqual(["lead", "anna", "ben", "carl", "dora"]);
  const able = offered.filter(({ trouble }) => trouble === null);
  expect(able.map(({ name }) => name)).toEqual(["lead", "anna"]);
});

it("reads names with commas or spaces between them, each once", () => {
  expect(namesIn(" anna, ben;carl  anna\n")).toEqual(["anna", "ben", "carl"]);
  expect(namesIn(" , ")).toEqual([]);
});

it("reads whole numbers only", () => {
  expect(wholeNumber(" 14 ", 0)).toBe(14);
  for (const text of ["", "2,5", "2.5", "-1", "1e3", "two"])
    expect(wholeNumber(text, 0)).toBe(null);
  expect(wholeNumber("0", 1)).toBe(null);
});
