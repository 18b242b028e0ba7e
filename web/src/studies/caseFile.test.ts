import { describe, expect, it } from "vitest";

import { baseName, picturesOf } from "./caseFile";

describe("a case file", () => {
  it("names its pictures", () => {
    const films = [{ image: { file: "a/erect.dcm" } }, { image: {} }, { posture: "neutral" }];
    expect(picturesOf(JSON.stringify({ format: "spineline-case", films }))).toEqual([
      "a/erect.dcm",
    ]);
    expect(picturesOf(JSON.stringify({ format: "spineline-case" }))).toEqual([]);
  });

  it("is distinguished from other files", () => {
    for (const text of ["", "{", "null", "[]", '{"format":"geojson"}'])
      expect(picturesOf(text)).toBeNull();
  });

  it("may name them with folders", () => {
    expect(baseName("a/b/erect.dcm")).toBe("erect.dcm");
    expect(baseName("C:\\films\\erect.dcm")).toBe("erect.dcm");
    expect(baseName("erect.dcm")).toBe("erect.dcm");
  });
});
