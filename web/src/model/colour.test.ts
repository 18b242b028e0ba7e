import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

import { describe, expect, it } from "vitest";

import { STIFFNESS_TOKENS, onScale } from "./colour";

describe("the stiffness scale", () => {
  const stops = ["#000000", "#804020", "#ffffff"];

  it("has its first stop at 0 and its last at 1, and is constant outside", () => {
    expect(onScale(stops, 0)).toBe("#000000");
    expect(onScale(stops, 1)).toBe("#ffffff");
    expect(onScale(stops, -3)).toBe("#000000");
    expect(onScale(stops, 3)).toBe("#ffffff");
  });

  it("interpolates between stops", () => {
    expect(onScale(stops, 0.25)).toBe("#402010");
    expect(onScale(stops, 0.5)).toBe("#804020");
  });

  it("is lighter for stiffer joints, in both themes", () => {
    const file = fileURLToPath(new URL("../theme/tokens.css", import.meta.url));
    const themes = readFileSync(file, "utf8").split("@media");
    expect(themes).toHaveLength(2);
    for (const theme of themes) {
      const light = STIFFNESS_TOKENS.map((token) => {
        const found = new RegExp(`${token}: #(..)(..)(..);`).exec(theme);
        const [r = 0, g = 0, b = 0] = (found ?? [])
          .slice(1)
          .map((part) => Number.parseInt(part, 16));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
      });
      expect(light.every((value) => value > 0)).toBe(true);
      expect(light).toEqual(light.toSorted((a, b) => a - b));
    }
  });
});
