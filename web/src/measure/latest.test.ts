import { expect, it } from "vitest";

import { LatestOnly } from "./latest";

interface Open {
  request: number;
  signal: AbortSignal;
  answer: (value: number) => void;
}

function program(): {
  open: Open[];
  ask: (request: number, signal: AbortSignal) => Promise<number>;
} {
  const open: Open[] = [];
  const ask = (request: number, signal: AbortSignal): Promise<number> =>
    new Promise((resolve, reject) => {
      open.push({ request, signal, answer: resolve });
      signal.addEventListener("abort", () => reject(new DOMException("", "AbortError")));
    });
  return { open, ask };
}

const turn = (): Promise<void> => new Promise((resolve) => setTimeout(resolve));

it("has one request on its way, and then the newest", async () => {
  const { open, ask } = program();
  const answers: number[] = [];
  const latest = new LatestOnly<number, number>(ask, (answer) => answers.push(answer), 1e6);
  for (const request of [1, 2, 3, 4]) latest.want(request);
  expect(open.map(({ request }) => request)).toEqual([1]);
  open[0]!.answer(10);
  await turn();
  expect(open.map(({ request }) => request)).toEqual([1, 4]);
  open[1]!.answer(40);
  await turn();
  expect(answers).toEqual([10, 40]);
});

it("gives up a request that takes too long once there is a newer one", async () => {
  const { open, ask } = program();
  const answers: number[] = [];
  const latest = new LatestOnly<number, number>(ask, (answer) => answers.push(answer), -1);
  latest.want(1);
  latest.want(2);
  expect(open[0]!.signal.aborted).toBe(true);
  await turn();
  open[1]!.answer(20);
  await turn();
  expect(answers).toEqual([20]);
});

it("answers nothing after it was cancelled", async () => {
  const { open, ask } = program();
  const answers: number[] = [];
  const latest = new LatestOnly<number, number>(ask, (answer) => answers.push(answer));
  latest.want(1);
  latest.want(2);
  latest.cancel();
  open[0]!.answer(10);
  await turn();
  expect(answers).toEqual([]);
  expect(open).toHaveLength(1);
});
