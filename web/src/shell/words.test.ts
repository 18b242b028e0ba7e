import { describe, expect, it } from "vitest";

import { counted, imageSideWord, momentText, viewWord, sideWord, statuses } from "./words";

describe("words", () => {
  it("distinguish the patient's side from the side of the picture", () => {
    expect(sideWord("left")).toContain("patient");
    expect(imageSideWord("image_left")).toContain("picture");
  });

  it("name postures", () => {
    expect(viewWord("left_bending")).toBe("Left bending");
  });

  it("name every status once", () => {
    expect(new Set(statuses).size).toBe(8);
  });

  it("count", () => {
    expect(counted(1, "film")).toBe("1 film");
    expect(counted(0, "film")).toBe("0 films");
    expect(counted(2, "study", "studies")).toBe("2 studies");
  });

  it("write a moment with its day", () => {
    expect(momentText(Date.UTC(2024, 4, 17, 12))).toContain("17 May 2024");
  });
});
