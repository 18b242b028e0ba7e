import { expect, it } from "vitest";

import { Latest, type LatestOptions } from "./latest";

/** A service that answers on command. */
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

it("sends one request at a time and then the newest", async () => {
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

it("aborts the running request on cancel without a report", async () => {
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

it("reports a failure and sends the waiting request", async () => {
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

it("aborts a slow request for a newer one", async () => {
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
