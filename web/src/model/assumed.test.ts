import { expect, it } from "vitest";

import { modelView } from "../../e2e/model.fixture";
import { assumedText } from "./assumed";
import { Choice } from "./choice.svelte";

/** A model whose lateral film shows all vertebrae except these. */
function without(...hidden: string[]) {
  const view = modelView();
  const pitch_from = view.bodies.map(({ level }) =>
    hidden.includes(level) ? ("population" as const) : ("lateral_film" as const),
  );
  return { ...view, pitch_from };
}

it("shows flat views first where no vertebra has a measured pitch", () => {
  expect(new Choice(modelView()).isFlat).toBe(true);
  expect(new Choice(without("T2", "T3")).isFlat).toBe(false);
  expect(new Choice(without()).isFlat).toBe(false);
});

it("stays with flat views where 3D is missing", () => {
  const choice = new Choice(without());
  choice.withoutGl = "The browser lost the 3D view.";
  expect(choice.isFlat).toBe(true);
});

it("names what is assumed", () => {
  const always = "Arches and sizes from front to back are assumed.";
  expect(assumedText(modelView())).toBe(
    "Depth and arches are assumed: no lateral film was measured.",
  );
  expect(assumedText(without())).toBe(always);
  expect(assumedText(without("T2", "T3", "T4", "T5"))).toBe(
    `${always} The pitch of T2 to T5 is assumed: the lateral film does not show them.`,
  );
  expect(assumedText(without("T9"))).toBe(
    `${always} The pitch of T9 is assumed: the lateral film does not show it.`,
  );
  expect(assumedText(without("T2", "T3", "T11", "T12", "L1", "L4"))).toBe(
    `${always} The pitch of T2, T3, T11 to L1 and L4 is assumed: the lateral film does not show them.`,
  );
});
