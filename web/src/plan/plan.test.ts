import { afterEach, beforeEach, expect, it, vi } from "vitest";

import { LEVELS } from "../../e2e/levels";
import type { Api } from "../api/types";
import type { Point } from "../model/shapes";
import { memoryStorage } from "../shell/storage.fixture";
import { arrowOf, endsOf } from "./arrows";
import {
  brace,
  fieldsOf,
  levelOf,
  loadsOf,
  moved,
  pointed,
  textOf,
  valueOf,
  type Load,
} from "./loads";
import { Plan } from "./plan.svelte";

const PAD: Load & { kind: "pad" } = {
  kind: "pad",
  level: "T8",
  direction: [0, 1, 0],
  force_per_mm: 2,
  advance_mm: 10,
  point_in_vertebra_mm: [0, 0, 0],
  timing: "growing",
};
const STRAP: Load = {
  kind: "strap",
  level: "T8",
  anchor_mm: [3, 154, 200],
  force_per_mm: 2,
  shortening_mm: 10,
  point_in_vertebra_mm: [0, 0, 0],
  timing: "growing",
};
const midpointOf = (level: string): Point => (level === "T8" ? [3, 4, 200] : [5, -6, 230]);
const ANSWER = { loads: ["a pad"], faults: [], simulation: null };

const sent: string[] = [];
const made: Plan[] = [];

beforeEach(() => {
  sent.length = 0;
  vi.stubGlobal("localStorage", memoryStorage());
  vi.stubGlobal("fetch", async (request: Request) => {
    const text = await request.text();
    sent.push(text);
    const isBad = text.includes("pda");
    const body = isBad ? { code: "refused", message: "unknown name `padd`" } : ANSWER;
    return new Response(JSON.stringify(body), { status: isBad ? 422 : 200 });
  });
});
afterEach(() => {
  for (const plan of made.splice(0)) plan.leave();
  vi.unstubAllGlobals();
});

const settled = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 10));

/** A plan with loads, which the end of the test leaves. */
function plan(...loads: Load[]): Plan {
  const own = new Plan("S-1", "ab", () => "inflection_line");
  if (loads.length > 0) own.add(...loads);
  made.push(own);
  return own;
}

it("sends the text of the load file that is saved, and keeps it over a reload", async () => {
  const own = plan(PAD);
  await settled();
  expect(sent).toEqual([textOf([PAD])]);
  expect(own.wordsOf(0)).toBe("a pad");
  expect(plan().loads).toEqual([PAD]);
  // Neither another person's nor another study's.
  expect(new Plan("S-1", "cd", () => "inflection_line").loads).toEqual([]);
  expect(new Plan("S-2", "ab", () => "inflection_line").loads).toEqual([]);
  own.remove(0);
  expect(plan().loads).toEqual([]);
});

it("undoes and redoes, and takes digits of one number together", () => {
  const own = plan(PAD);
  own.edit(0, { ...PAD, advance_mm: 1 }, "0 advance_mm");
  own.edit(0, { ...PAD, advance_mm: 15 }, "0 advance_mm");
  own.edit(0, { ...PAD, advance_mm: 15, level: "T6" }, "0 level");
  own.undo();
  expect(own.loads).toEqual([{ ...PAD, advance_mm: 15 }]);
  own.undo();
  expect(own.loads).toEqual([PAD]);
  own.undo();
  expect([own.loads, own.canUndo]).toEqual([[], false]);
  own.redo();
  expect([own.loads, own.canRedo]).toEqual([[PAD], true]);
  own.add(STRAP);
  expect(own.canRedo).toBe(false);
});

it("hides results of other loads, and texts of loads that have changed since", async () => {
  const own = plan(PAD);
  await settled();
  expect(own.isCurrent).toBe(true);
  own.edit(0, { ...PAD, level: "T6" }, "0 level");
  expect([own.isCurrent, own.wordsOf(0)]).toEqual([false, null]);
  await settled();
  expect(own.isCurrent).toBe(true);
});

it("opens a file that the program reads, and leaves the loads where it does not", async () => {
  const own = plan(PAD);
  await settled();
  const { signal } = new AbortController();
  const bad = '{"format":"spineline-load","version":1,"loads":[{"kind":"pda"}]}';
  await expect(own.open(bad, signal)).rejects.toThrow("unknown name");
  expect(own.loads).toEqual([PAD]);
  own.step = 0;
  await own.open(`\uFEFF${textOf([STRAP])}`, signal);
  expect([own.loads, own.step], "the result is shown").toEqual([[STRAP], null]);
  own.undo();
  expect(own.loads).toEqual([PAD]);
});

it("reads its own files only", () => {
  expect(loadsOf(textOf([PAD, STRAP]))).toEqual([PAD, STRAP]);
  for (const text of ["", "[]", "{}", '{"loads":[1]}', '{"loads":[{}]}', '{"loads":"pad"}'])
    expect(loadsOf(text)).toBeNull();
});

it("moves and points loads; the end of a strap stays at its side", () => {
  expect(moved(PAD, "T6", midpointOf)).toEqual({ ...PAD, level: "T6" });
  expect(moved(STRAP, "T6", midpointOf)).toMatchObject({ level: "T6", anchor_mm: [5, 144, 230] });
  expect(pointed(PAD, -1, midpointOf)).toMatchObject({ direction: [0, -1, 0] });
  expect(pointed(STRAP, -1, midpointOf)).toMatchObject({ anchor_mm: [3, -146, 200] });
  const force: Load = { kind: "force_at_point", level: "T8", force: [3, 0, 4] } as Load;
  expect(pointed(force, 1, midpointOf)).toMatchObject({ force: [0, 5, 0] });
});

it("has fields with units for every value of a kind", () => {
  const keys = (load: Load) => fieldsOf(load.kind, "N").map((field) => field.key);
  for (const load of [PAD, STRAP]) {
    const own = Object.keys(load).filter((key) => key !== "kind" && key !== "timing");
    expect(keys(load).toSorted()).toEqual(own.toSorted());
  }
  const units = fieldsOf("moment", "N").flatMap((field) => ("unit" in field ? [field.unit] : []));
  expect(units).toEqual(["N·mm"]);
  const weight = { kind: "gravity", body_weight: 20 } as Load;
  expect([valueOf(weight, "timing"), valueOf(PAD, "timing")]).toEqual(["held", "growing"]);
  expect(valueOf({ kind: "force_at_point" } as Load, "point_in_vertebra_mm")).toEqual([0, 0, 0]);
});

it("draws a pad towards its vertebra and a pull away from it, on the side from which it is seen", () => {
  const arrow = { load: 0, point_mm: [0, 10, 100], vector: [0, 4, 0], is_moment: false, part: 1 };
  expect(endsOf(arrow, false)).toEqual({ from: [0, 10, 100], tip: [0, 65, 100] });
  expect(endsOf(arrow, true)).toEqual({ from: [0, -45, 100], tip: [0, 10, 100] });
  expect(arrowOf(arrow, false, -1)).toMatchObject({ x1: -10, x2: -65, y1: -100, y2: -100 });
  expect(arrowOf({ ...arrow, vector: [1, 0, 0] }, false, 1)).toBeNull();
  expect(endsOf({ ...arrow, is_moment: true }, false)).toBeNull();
});

it("shows intervals with the loads that they were computed for, and with no others", async () => {
  const own = plan(PAD);
  const rows = [{ label: "Cobb", intervals: ["1° to 2°", "", ""] }];
  const found = { done: 5, asked: 5, file: textOf([PAD]), rows, texts: [] };
  own.intervals = { ...found, state: "done" };
  expect(own.intervalRows, "before the numbers of these loads are known").toEqual([]);
  await settled();
  expect([own.intervalRows, own.areIntervalsOfOthers]).toEqual([rows, false]);
  own.edit(0, { ...PAD, advance_mm: 11 }, "0 advance_mm");
  expect([own.intervalRows, own.areIntervalsOfOthers]).toEqual([[], true]);
  await settled();
  expect([own.intervalRows, own.areIntervalsOfOthers]).toEqual([[], true]);
  own.undo();
  await settled();
  expect([own.intervalRows, own.areIntervalsOfOthers]).toEqual([rows, false]);
  // Another line has other springs.
  own.again();
  expect([own.intervals, own.intervalRows]).toEqual([null, []]);
});

it("a brace has a pad and counter-pads on the other side, at vertebrae that exist", () => {
  const levels = LEVELS.filter((level) => level !== "L4");
  const of = (level: Api<"Level">) => brace({ ...PAD, level }, levels);
  const [pad, ...held] = of("T8");
  expect(pad).toEqual(PAD);
  expect(held).toMatchObject([
    { level: "T12", direction: [0, -1, 0], advance_mm: 0 },
    { level: "T4", direction: [0, -1, 0], advance_mm: 0 },
  ]);
  expect(of("L2").map(levelOf)).toEqual(["L2", "L3", "T10"]);
  expect(of("T2").map(levelOf)).toEqual(["T2", "T6"]);
  const own = plan(...of("T8"));
  own.undo();
  expect(own.loads).toEqual([]);
});
