import { afterEach, beforeEach, expect, it, vi } from "vitest";

import type { Api } from "../api/types";
import { HandLoad } from "./load.svelte";

const VIEW = {
  study: "S-1",
  bodies: [{ level: "T7" }],
  erect: { midpoints_mm: [[0, 0, 0]] },
} as unknown as Api<"ModelView">;

const replies: { status: number; body: unknown }[] = [];

beforeEach(() => {
  replies.length = 0;
  vi.stubGlobal("fetch", async () => {
    const reply = replies.shift();
    if (!reply) throw new TypeError("no network");
    return new Response(JSON.stringify(reply.body), { status: reply.status });
  });
});
afterEach(() => void vi.unstubAllGlobals());

const settled = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 5));
const ANSWER = { load_text: "Relative force 10", status_text: "found", texts: [] };

it("shows no earlier shape with a load that could not be applied", async () => {
  const load = new HandLoad(VIEW, () => "bodies" as Api<"LineKindName">);
  replies.push({ status: 200, body: ANSWER });
  load.set(0, 10);
  await settled();
  expect(load.answer).toEqual(ANSWER);
  load.set(0, 20);
  await settled();
  expect(load.answer).toBeNull();
  expect(load.problem).toBeInstanceOf(Error);
  replies.push({ status: 200, body: ANSWER });
  load.again();
  expect(load.problem).toBeNull();
  await settled();
  expect(load.answer).toEqual(ANSWER);
  load.leave();
});
