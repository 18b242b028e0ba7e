import { afterEach, beforeEach, expect, it, vi } from "vitest";

import { memoryStorage } from "../shell/storage.fixture";
import { lasting } from "../shell/storage.svelte";
import { keepingOf } from "./keeping";
import { Marking } from "./marking.svelte";
import type { Event, ReadingView } from "./landmarks";
import { reading } from "./reading.fixture";

type Asked = { method: string; path: string; json: unknown };
type Answer = { status: number; body: unknown };

const asked: Asked[] = [];
let answer: (asked: Asked) => Promise<Answer> | Answer;

beforeEach(() => {
  asked.length = 0;
  vi.stubGlobal("localStorage", memoryStorage());
  // As on a page without a certificate.
  vi.stubGlobal("navigator", {});
  vi.stubGlobal("requestAnimationFrame", () => 0);
  vi.stubGlobal("fetch", async (request: Request) => {
    const path = new URL(request.url).pathname;
    const body = await request.text();
    const one = { method: request.method, path, json: body ? JSON.parse(body) : null };
    asked.push(one);
    const { status, body: text } = path.endsWith("/live")
      ? { status: 403, body: null }
      : await answer(one);
    return new Response(JSON.stringify(text), { status });
  });
  vi.useFakeTimers();
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** Waits until requests and answers are processed. */
async function settle(ms = 10): Promise<void> {
  await vi.advanceTimersByTimeAsync(ms);
  for (let turn = 0; turn < 5; turn += 1) await vi.advanceTimersByTimeAsync(0);
}

const crest = (column_px: number): Event => ({
  kind: "place_iliac_crest",
  side: "left",
  column_px,
  row_px: 1,
});

const sent = (): Event[] =>
  asked
    .filter(({ path }) => path.endsWith("/events"))
    .flatMap(({ json }) => (json as { events: Event[] }).events);

/** A program that accepts all requests. */
function taking(start = 0): (one: Asked) => Answer {
  let revision = start;
  return ({ path, json }) => {
    if (!path.endsWith("/events")) return { status: 200, body: { ...reading(), revision } };
    revision += (json as { events: Event[] }).events.length;
    return { status: 200, body: { reading: { ...reading(), revision }, live: null } };
  };
}

it("sends one request per click and shows its results", async () => {
  const live = { status: "partial", status_text: "1 of 15 vertebrae", notices: [] };
  answer = () => ({ status: 200, body: { reading: { ...reading(), revision: 1 }, live } });
  const marking = new Marking(reading(), "me");
  await settle();
  asked.length = 0;
  marking.note("one");
  await settle();
  expect(asked.map(({ path }) => path)).toEqual(["/api/readings/7/events"]);
  expect(marking.live).toEqual(live);
});

function conflict(now: Partial<ReadingView>): Answer {
  const problem = { code: "conflict", message: "changed meanwhile", help: null };
  return { status: 409, body: { problem, reading: { ...reading(), revision: 5, ...now } } };
}

/** A reading with one vertebra whose axis has the given angle. */
function turned(axis_deg: number): ReadingView {
  const axis = { axis_deg, by_hand: true, from_px: [0, 0], to_px: [0, 1] };
  const vertebra = { level: "L4", corners: [], complete: true, midpoint_px: [0, 0], axis };
  return { ...reading(), vertebrae: [vertebra as unknown as ReadingView["vertebrae"][number]] };
}

it("sends unsaved events of an earlier page", async () => {
  keepingOf(reading(), "me").save([{ events: [crest(1)], expected: 0 }]);
  answer = taking();
  const marking = new Marking(reading(), "me");
  await settle();
  expect(sent()).toEqual([crest(1)]);
  expect(marking.saving).toEqual({ kind: "saved" });
});

it("shows refused events again after a reload until the person decides", async () => {
  keepingOf(reading(), "me").save([
    { events: [crest(1), { kind: "undo" }, crest(2)], expected: 0 },
  ]);
  answer = () => conflict({});
  const before = new Marking(reading(), "me");
  await settle();
  expect(before.lost?.events).toHaveLength(3);
  before.close();

  answer = taking(5);
  const after = new Marking({ ...reading(), revision: 5 }, "me");
  await settle();
  expect(after.lost?.events).toHaveLength(3);
  asked.length = 0;
  after.applyLost();
  await settle();
  // The undo belonged to a refused event; alone it would undo a change of another person.
  expect(sent()).toEqual([crest(2)]);
  expect(after.lost).toBeNull();
  expect(keepingOf(reading(), "me").lost()).toEqual([]);
});

it("lists what a refusal lost beside what was lost before", async () => {
  const lost = (text: string): ReadingView["conflicts"][number] => ({
    who: "cd",
    at_ms: 1,
    text,
    base_revision: 0,
    found_revision: 5,
  });
  keepingOf(reading(), "me").save([{ events: [crest(1)], expected: 0 }]);
  answer = () => conflict({ conflicts: [lost("later")] });
  const marking = new Marking({ ...reading(), conflicts: [lost("earlier")] }, "me");
  await settle();
  expect(marking.reading.conflicts.map(({ text }) => text)).toEqual(["earlier", "later"]);
});

it("redoes several times while the first redo is still being sent", async () => {
  answer = taking();
  const marking = new Marking({ ...reading(), redoable: 2 }, "me");
  marking.redo();
  marking.redo();
  expect(marking.canRedo).toBe(false);
  marking.redo();
  await settle();
  expect(sent()).toEqual([{ kind: "redo" }, { kind: "redo" }]);
});

it("applies no event to a finished reading and keeps refused events", async () => {
  keepingOf(reading(), "me").save([{ events: [crest(1)], expected: 0 }]);
  answer = () => conflict({ finished: true });
  const marking = new Marking(reading(), "me");
  await settle();
  marking.applyLost();
  expect(marking.lost?.events).toEqual([crest(1)]);
  expect(keepingOf(reading(), "me").lost()).toEqual([crest(1)]);
  marking.forgetLost();
  expect(keepingOf(reading(), "me").lost()).toEqual([]);
});

it("offers unsaved events of another window that may be open, with their age", async () => {
  keepingOf(reading(), "other").save([{ events: [crest(1)], expected: 0 }]);
  const since_ms = Date.now();
  await settle(60_000);
  answer = taking();
  const marking = new Marking(reading(), "me");
  await settle();
  expect(marking.lost).toMatchObject({ events: [crest(1)], since_ms, mayBeOpen: true });
  expect(sent()).toEqual([]);
});

it("reports a refused event even if the reading cannot be loaded again", async () => {
  const problem = { code: "refused", message: "a place is within a million pixels", help: null };
  answer = ({ method }) => ({ status: method === "POST" ? 422 : 404, body: problem });
  const marking = new Marking(reading(), "me");
  marking.note("one");
  await settle();
  expect(marking.trouble?.what).toBe("Not recorded: note: one");
  expect(marking.saving).toEqual({ kind: "saved" });
});

it("ignores a reading older than the current one", async () => {
  let late: (answer: Answer) => void = () => undefined;
  const take = taking();
  answer = (one) =>
    one.method === "GET" ? new Promise<Answer>((resolve) => (late = resolve)) : take(one);
  const marking = new Marking(reading(), "me");
  const reloaded = marking.reload();
  marking.note("one");
  await settle();
  late({ status: 200, body: { ...reading(), notes: ["old"] } });
  await reloaded;
  expect(marking.reading.notes).toEqual([]);
  expect(marking.revision).toBe(1);
});

/** An axis whose angle was answered at 10° and that was released at 25°, and a function that sends the other answers. */
async function letGo(): Promise<{ marking: Marking; answerRest: () => void }> {
  const slow: (() => void)[] = [];
  const take = taking();
  answer = (one) => {
    if (!one.path.endsWith("/preview")) return take(one);
    const { turn_axis } = one.json as { turn_axis: { towards_px: [number, number] } };
    const body = { reading: turned(turn_axis.towards_px[0]), live: null };
    return new Promise((resolve) => slow.push(() => resolve({ status: 200, body })));
  };
  const marking = new Marking(turned(0), "me");
  marking.drag({ kind: "axis", level: "L4" }, [10, 0]);
  await settle();
  slow.shift()!();
  await settle();
  marking.drag({ kind: "axis", level: "L4" }, [25, 0]);
  marking.drop();
  return { marking, answerRest: () => slow.forEach((now) => now()) };
}

it("records an axis at the place of release, not at the last answer", async () => {
  const { answerRest } = await letGo();
  await settle();
  expect(sent()).toEqual([]);
  answerRest();
  await settle();
  expect(sent()).toEqual([{ kind: "set_axis", level: "L4", axis_deg: 25 }]);
});

it("records an axis that was released just before the page changed", async () => {
  const { marking, answerRest } = await letGo();
  marking.close();
  await settle();
  answerRest();
  await settle();
  expect(sent()).toEqual([{ kind: "set_axis", level: "L4", axis_deg: 25 }]);
});

it("keeps the last drawn axis if the window closes before its angle arrives", async () => {
  const { marking } = await letGo();
  marking.keepTurn();
  const [entry] = keepingOf(turned(0), "me").load();
  expect(entry?.events).toEqual([{ kind: "set_axis", level: "L4", axis_deg: 10 }]);
});

it("works without browser storage and reports it", async () => {
  vi.stubGlobal("localStorage", {
    getItem: () => null,
    removeItem: () => undefined,
    setItem: () => {
      throw new DOMException("full", "QuotaExceededError");
    },
  });
  answer = taking();
  const marking = new Marking(reading(), "me");
  marking.note("one");
  await settle();
  expect(sent()).toEqual([{ kind: "note", text: "one" }]);
  expect(marking.saving.kind).toBe("saved");
  expect(lasting.refused).toBe(true);
});

it("reports an axis whose angle does not arrive and does not record it", async () => {
  answer = ({ path }) => {
    if (path.endsWith("/preview")) throw new TypeError("no network");
    return { status: 200, body: reading() };
  };
  const marking = new Marking(turned(0), "me");
  marking.drag({ kind: "axis", level: "L4" }, [10, 0]);
  marking.drop();
  await settle();
  expect(sent()).toEqual([]);
  expect(marking.trouble?.what).toBe("L4 – axis not rotated");
  expect(marking.dragging).toBe(false);
});

it("offers unsaved events of a closed window", async () => {
  vi.stubGlobal("navigator", {
    locks: { query: async () => ({ held: [{ name: "spineline.unsaved.me" }] }) },
  });
  keepingOf(reading(), "other").save([{ events: [crest(1)], expected: 0 }]);
  answer = taking();
  const marking = new Marking(reading(), "me");
  await settle();
  expect(marking.lost).toMatchObject({ events: [crest(1)], mayBeOpen: false });
});
