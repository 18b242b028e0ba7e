import { expect, it } from "vitest";

import { apart, type Wanted } from "./apart";

const VIEW = { width: 600, height: 400 };
const wanted = (text: string, at: [number, number], side: Wanted["side"] = "right"): Wanted => ({
  text,
  at,
  size_px: 12,
  side,
});

it("puts a text beside its object", () => {
  expect(apart([wanted("48.2°", [100, 50])], VIEW)).toEqual([{ x: 109, y: 54, anchor: "start" }]);
  expect(apart([wanted("INF", [100, 50], "left")], VIEW)[0]).toMatchObject({ anchor: "end" });
});

it("moves a text that would cover one before it to the other side, and then to another row", () => {
  const [angle, residual, third] = apart(
    [wanted("48.2°", [100, 50]), wanted("3.1 mm", [100, 50]), wanted("2.0 mm", [100, 50])],
    VIEW,
  );
  expect(angle).toEqual({ x: 109, y: 54, anchor: "start" });
  expect(residual).toEqual({ x: 91, y: 54, anchor: "end" });
  expect(third).toEqual({ x: 109, y: 69, anchor: "start" });
});

it("keeps off texts that are drawn already", () => {
  const [angle] = apart([wanted("48.2°", [100, 50])], VIEW, [wanted("T8", [110, 50])]);
  expect(angle).toEqual({ x: 91, y: 54, anchor: "end" });
});

it("keeps a text within the view", () => {
  expect(apart([wanted("48.2°", [590, 50])], VIEW)[0]).toMatchObject({ anchor: "end" });
  expect(apart([wanted("INF", [5, 50], "left")], VIEW)[0]).toMatchObject({ anchor: "start" });
});
