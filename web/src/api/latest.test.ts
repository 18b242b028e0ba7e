import { expect, it } from "vitest";

import { Latest, type LatestOptions } from "./latest";

/** Answers when it is told to. */
function desk(options: LatestOptions = {}) {
  const asked: {
    request: string;
    signal: AbortSignal;
    answer: (text: string) => void;
    fail: () => void;
  }[] = [];
  const answers: string[] = [];
  const failures: unknown[] = [];
  const latest = new Latest<string, string>(
    (request, signal) =>
      new Promise((resolve, reject) => {
        asked.push({ request, signal, answer: resolve, fail: () => reject(new Error("no")) });
        signal.addEventListener("abort", () => reject(new DOMException("gone", "AbortError")));
      }),
    (answer, request) => answers.push(`${request}: ${answer}`),
    { failed: (error) => failures.push(error), ...options },
  );
  return { asked, answers, failures, latest };
}

const settled = (): Promise<void> => new Promise((resolve) => setTimeout(resolve));

it("has one request under way, and then asks with the newest", async () => {
  const { asked, answers, latest } = desk();
  latest.send("1");
  latest.send("2");
  latest.send("3");
  expect(asked.map((one) => one.request)).toEqual(["1"]);
  asked[0]?.answer("a");
  await settled();
  expect(asked.map((one) => one.request)).toEqual(["1", "3"]);
  asked[1]?.answer("b");
  await settled();
  expect(answers).toEqual(["1: a", "3: b"]);
});

it("gives up what is under way when it is cancelled, and tells nobody", async () => {
  const { asked, answers, failures, latest } = desk();
  latest.send("1");
  latest.send("2");
  latest.cancel();
  await settled();
  expect(asked[0]?.signal.aborted).toBe(true);
  expect(asked).toHaveLength(1);
  latest.send("3");
  asked[1]?.answer("c");
  await settled();
  expect(answers).toEqual(["3: c"]);
  expect(failures).toEqual([]);
});

it("tells of a failure and goes on with what waits", async () => {
  const { asked, answers, failures, latest } = desk();
  latest.send("1");
  latest.send("2");
  asked[0]?.fail();
  await settled();
  asked[1]?.answer("b");
  await settled();
  expect(failures).toHaveLength(1);
  expect(answers).toEqual(["2: b"]);
});

it("gives up a request that takes too long once there is a newer one", async () => {
  const { asked, answers, failures, latest } = desk({ patienceMs: -1 });
  latest.send("1");
  latest.send("2");
  expect(asked[0]?.signal.aborted).toBe(true);
  await settled();
  asked[1]?.answer("b");
  await settled();
  expect(answers).toEqual(["2: b"]);
  expect(failures).toEqual([]);
});
