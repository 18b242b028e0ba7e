import { afterEach, beforeEach, expect, it, vi } from "vitest";

import { Refusal, Unreachable } from "../api/client";
import { reading } from "./reading.fixture";
import type { Api } from "../api/types";
import type { Event, ReadingView } from "./landmarks";
import { Outbox, type Entry, type Keeping } from "./outbox";

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

const at = (column_px: number): Event => ({
  kind: "place_corner",
  level: "L4",
  corner: "superior_left",
  column_px,
  row_px: 1,
});

function memory(): Keeping & { entries: Entry[]; lost: Event[]; saves: number } {
  const kept = {
    entries: [] as Entry[],
    lost: [] as Event[],
    saves: 0,
    load: () => kept.entries,
    save: (entries: readonly Entry[]) => {
      kept.entries = structuredClone([...entries]);
      kept.saves += 1;
    },
    lose: (events: readonly Event[]) => void kept.lost.push(...events),
  };
  return kept;
}

/** A program as the outbox uses it. */
class Program {
  events: Event[] = [];
  asked: { events: readonly Event[]; expected: number }[] = [];
  /** Faults of the next requests, before or after recording. */
  faults: ("away" | "answer lost" | Refusal)[] = [];

  async send(events: readonly Event[], expected: number): Promise<Api<"Preview">> {
    this.asked.push({ events, expected });
    const fault = this.faults.shift();
    await Promise.resolve();
    if (fault === "away") throw new Unreachable();
    if (fault instanceof Refusal) throw fault;
    const repeated = JSON.stringify(this.events.slice(expected)) === JSON.stringify(events);
    if (!repeated && expected !== this.events.length) throw this.conflict();
    if (!repeated) this.events.push(...events);
    if (fault === "answer lost") throw new Unreachable();
    return { reading: this.view(), live: null };
  }

  view(): ReadingView {
    return { ...reading(), revision: this.events.length };
  }

  conflict(): Refusal {
    const problem = { code: "conflict", message: "changed meanwhile", help: null };
    return new Refusal(409, problem, { problem, reading: this.view() });
  }
}

/** An outbox with its program, which has these faults first, and with its storage. */
function outbox(faults: Program["faults"] = [], program = new Program(), keeping = memory()) {
  program.faults = faults;
  const told = {
    saved: [] as number[],
    lost: [] as Event[],
    refused: [] as Event[],
    wentBack: false,
  };
  const box = new Outbox({
    revision: program.events.length,
    send: (events, expected) => program.send(events, expected),
    keeping,
    saved: (answer) => told.saved.push(answer.reading.revision),
    conflict: (lost, _, wentBack) => {
      told.lost.push(...lost);
      told.wentBack = wentBack;
    },
    refused: (lost) => told.refused.push(...lost),
    changed: () => undefined,
    restMs: 300,
    retryMs: [100, 200],
  });
  return { box, told, program, keeping };
}

function refusal(status: number, code: string): Refusal {
  const problem = { code, message: `refused as ${code}`, help: null };
  return new Refusal(status, problem, problem);
}

const settle = (ms = 0): Promise<unknown> => vi.advanceTimersByTimeAsync(ms);

it("says that a store went back which lacks acknowledged events", async () => {
  const { box, told, program } = outbox();
  box.push([at(1), at(2)]);
  await settle();
  program.events.push(at(9));
  box.push([at(3)]);
  await settle();
  expect([told.lost, told.wentBack]).toEqual([[at(3)], false]);
  program.events.length = 1;
  box.push([at(4)]);
  await settle();
  expect([told.lost, told.wentBack]).toEqual([[at(3), at(4)], true]);
});

it("sends entries in order, each after the one before", async () => {
  const { box, told, program } = outbox();
  box.push([at(1)]);
  box.push([at(2), at(3)]);
  box.push([at(4)]);
  expect(box.state).toEqual({ kind: "saving", count: 3 });
  expect(program.asked).toHaveLength(1);
  await settle();
  expect(program.asked.map(({ expected }) => expected)).toEqual([0, 1, 3]);
  expect(program.events).toEqual([at(1), at(2), at(3), at(4)]);
  expect(told.saved).toEqual([1, 3, 4]);
  expect(box.state).toEqual({ kind: "saved" });
});

it("repeats a request until the program answers, without loss", async () => {
  const { box, program, keeping } = outbox(["away", "away", "away"]);
  box.push([at(1)]);
  box.push([at(2)]);
  await settle();
  expect(box.state).toEqual({ kind: "waiting", count: 2, why: null });
  expect(keeping.entries).toHaveLength(2);
  await settle(1_000);
  expect(program.events).toEqual([at(1), at(2)]);
  expect(box.state).toEqual({ kind: "saved" });
  expect(keeping.entries).toEqual([]);
});

it("records an entry once when its answer was lost", async () => {
  const { box, program } = outbox(["answer lost"]);
  box.push([at(1)]);
  await settle(1_000);
  expect(program.asked.map(({ expected }) => expected)).toEqual([0, 0]);
  expect(program.events).toEqual([at(1)]);
});

it("sends unsaved entries after a reload with their own revision", async () => {
  const before = outbox(["answer lost"]);
  const { program, keeping } = before;
  before.box.push([at(1)]);
  before.box.push([at(2)]);
  await settle();
  before.box.close();
  expect(keeping.entries).toHaveLength(2);
  // The page is loaded again and finds the first event recorded.
  const after = outbox([], program, keeping);
  expect(after.box.pending).toEqual([at(1), at(2)]);
  await settle(1_000);
  expect(program.events).toEqual([at(1), at(2)]);
  expect(after.told.lost).toEqual([]);
});

it("returns all entries that depended on a refused change", async () => {
  const { box, told, program, keeping } = outbox();
  program.events.push(at(99));
  box.push([at(1)]);
  box.push([at(2)]);
  await settle();
  expect(told.lost).toEqual([at(1), at(2)]);
  // Kept until the person decides: the program has the first of them only.
  expect(keeping.lost).toEqual([at(1), at(2)]);
  expect(keeping.entries).toEqual([]);
  expect(program.events).toEqual([at(99)]);
  expect(box.state).toEqual({ kind: "saved" });
  // New changes are based on the changes of others.
  box.push([at(3)]);
  await settle();
  expect(program.events).toEqual([at(99), at(3)]);
});

it("drops a refused entry and continues with the others", async () => {
  const { box, told, program } = outbox([refusal(422, "refused")]);
  box.push([at(1), at(2)]);
  box.push([at(3)]);
  await settle();
  expect(told.refused).toEqual([at(1), at(2)]);
  expect(program.events).toEqual([at(3)]);
});

it("waits until the person signs in again", async () => {
  const { box, program } = outbox([refusal(401, "not_signed_in")]);
  box.push([at(1)]);
  await settle(10_000);
  expect(box.state).toEqual({ kind: "signed_out", count: 1 });
  box.retry();
  await settle();
  expect(program.events).toEqual([at(1)]);
});

it("combines nudges into one event after the last key", async () => {
  const { box, program, keeping } = outbox();
  for (const column of [1.1, 1.2, 1.3]) {
    box.push([at(column)], "nudge");
    await settle(200);
  }
  expect(program.asked).toEqual([]);
  // Not sent, but stored: a reload does not lose it.
  expect(keeping.entries).toEqual([{ events: [at(1.3)], expected: 0, coalesce: "nudge" }]);
  await settle(300);
  expect(program.events).toEqual([at(1.3)]);
});

it("sends a nudge before the next event", async () => {
  const { box, program } = outbox();
  box.push([at(1)], "nudge a");
  box.push([at(2)], "nudge b");
  box.push([at(3)]);
  await settle();
  expect(program.events).toEqual([at(1), at(2), at(3)]);
});

it("does not change a nudge that is being sent", async () => {
  const { box, program } = outbox();
  box.push([at(1)], "nudge");
  box.flush();
  box.push([at(2)], "nudge");
  await settle(1_000);
  expect(program.events).toEqual([at(1), at(2)]);
});

it("keeps its entries for the next load when it is closed, for any answer", async () => {
  for (const fault of [undefined, "answer lost", refusal(422, "refused"), "others"] as const) {
    const { box, told, program, keeping } = outbox();
    if (fault === "others") program.events.push(at(99));
    else if (fault) program.faults = [fault];
    box.push([at(1)]);
    box.push([at(2)]);
    box.close();
    const { entries, saves } = structuredClone({ ...keeping, load: 0, save: 0, lose: 0 });
    expect(entries.map(({ events }) => events)).toEqual([[at(1)], [at(2)]]);
    await settle(5_000);
    expect({ ...keeping }).toMatchObject({ entries, saves, lost: [] });
    expect(told).toMatchObject({ saved: [], lost: [], refused: [] });
    expect(program.asked).toHaveLength(1);
  }
});

it("keeps a waiting nudge for the next load", async () => {
  const before = outbox();
  const { program, keeping } = before;
  before.box.push([at(1)], "nudge");
  before.box.close();
  await settle(1_000);
  expect(program.asked).toEqual([]);
  outbox([], program, keeping);
  await settle();
  expect(program.events).toEqual([at(1)]);
});

it("does not change a nudge whose answer was lost", async () => {
  const { box, told, program, keeping } = outbox(["answer lost"]);
  box.push([at(1)], "nudge");
  box.flush();
  await settle();
  expect(keeping.entries).toMatchObject([{ events: [at(1)], attempted: true }]);
  box.push([at(2)], "nudge");
  await settle(1_000);
  expect(program.events).toEqual([at(1), at(2)]);
  expect(told.lost).toEqual([]);
});

it.each([400, 403, 404, 409, 413, 415, 421])(
  "stops sending after a response of %i",
  async (status) => {
    const { box, told, program, keeping } = outbox([refusal(status, "held")]);
    box.push([at(1)]);
    box.push([at(2)]);
    await settle(10_000);
    expect(box.state).toEqual({ kind: "held", count: 2, why: "refused as held" });
    expect(keeping.entries).toHaveLength(2);
    expect(told.refused).toEqual([]);
    box.retry();
    await settle();
    expect(program.events).toEqual([at(1), at(2)]);
  },
);

it.each([408, 429, 500, 503])("repeats the request after a response of %i", async (status) => {
  const { box, program } = outbox([refusal(status, "later")]);
  box.push([at(1)]);
  await settle();
  expect(box.state).toEqual({ kind: "waiting", count: 1, why: "refused as later" });
  await settle(1_000);
  expect(program.events).toEqual([at(1)]);
});

it("returns all entries for a finished reading", async () => {
  const { box, told, program, keeping } = outbox([refusal(409, "finished")]);
  box.push([at(1)]);
  box.push([at(2)]);
  await settle(1_000);
  expect(told.refused).toEqual([at(1), at(2)]);
  expect(keeping.entries).toEqual([]);
  expect(program.asked).toHaveLength(1);
});

it("ignores revisions older than the known one", async () => {
  const { box, program } = outbox();
  box.push([at(1)]);
  await settle();
  box.rebase(0);
  expect(box.known).toBe(1);
  box.push([at(2)]);
  await settle();
  expect(program.events).toEqual([at(1), at(2)]);
});
