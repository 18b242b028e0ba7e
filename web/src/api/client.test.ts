import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

import { listAccounts, putAccount } from "./accounts";
import { Refusal, Unreachable, listen, useSession, type Listener } from "./client";
import { recordEvents } from "./readings";
import { beginSession, endSession } from "./session";
import { listStudies } from "./studies";

const heard = {
  answered: vi.fn(),
  unreachable: vi.fn(),
  expired: vi.fn(),
  changed: vi.fn(),
} satisfies Listener;
const request = vi.fn<typeof fetch>();

beforeEach(() => {
  vi.stubGlobal("fetch", request);
  listen(heard);
});

afterEach(() => vi.resetAllMocks());

const sent = (): Request[] => request.mock.calls.map(([asked]) => asked as Request);

function answer(status: number, body: unknown): void {
  request.mockResolvedValueOnce(Response.json(body, { status }));
}

async function refusalOf(asked: Promise<unknown>): Promise<Refusal> {
  const error = await asked.then(
    () => null,
    (caught: unknown) => caught,
  );
  expect(error).toBeInstanceOf(Refusal);
  return error as Refusal;
}

const PROBLEM = { code: "not_yours", message: "only ab may change it", help: "begin your own" };

describe("a refusal", () => {
  it("has the program's message", async () => {
    answer(403, PROBLEM);
    const refusal = await refusalOf(listStudies());
    expect(refusal.status).toBe(403);
    expect(refusal.message).toBe(PROBLEM.message);
    expect(refusal.problem.help).toBe(PROBLEM.help);
  });

  it("keeps the whole body of a conflict", async () => {
    const body = { problem: PROBLEM, reading: { revision: 7 } };
    answer(409, body);
    const refusal = await refusalOf(recordEvents(1, { expected_revision: 0, events: [] }));
    expect(refusal.problem).toEqual(PROBLEM);
    expect(refusal.body).toEqual(body);
  });

  it("has a message where the answer has none", async () => {
    request.mockResolvedValueOnce(new Response("<html>", { status: 502 }));
    expect((await refusalOf(listStudies())).message).toContain("502");
  });

  it("with status 401 is reported, except for a sign-in", async () => {
    answer(401, PROBLEM);
    await refusalOf(beginSession({ kind: "token", observer: "ab", token: "t" }));
    expect(heard.expired).not.toHaveBeenCalled();
    answer(401, PROBLEM);
    await refusalOf(listStudies());
    expect(heard.expired).toHaveBeenCalledOnce();
  });
});

describe("a request", () => {
  it("without an answer is unreachable", async () => {
    request.mockRejectedValueOnce(new TypeError("Failed to fetch"));
    await expect(listStudies()).rejects.toBeInstanceOf(Unreachable);
    expect(heard.unreachable).toHaveBeenCalledOnce();
    expect(heard.answered).not.toHaveBeenCalled();
  });

  it("that was aborted is neither refused nor unreachable", async () => {
    request.mockRejectedValueOnce(new DOMException("stopped", "AbortError"));
    await expect(listStudies()).rejects.toThrow("stopped");
    expect(heard.unreachable).not.toHaveBeenCalled();
  });

  it("that changes something has the session's token, and one that reads has not", async () => {
    useSession({ csrf: "c5f" } as Parameters<typeof useSession>[0]);
    answer(200, {});
    answer(200, {});
    await putAccount("ab", { enabled: true });
    await listAccounts();
    const [changing, asking] = sent().map(({ headers }) => headers);
    expect(changing?.get("X-Spineline-Csrf")).toBe("c5f");
    expect(asking?.get("X-Spineline-Csrf")).toBeNull();
  });

  it("is sent again after a change of session if the person is the same", async () => {
    const stale = { code: "csrf", message: "not the token of its session" };
    answer(403, stale);
    answer(200, { done: true });
    heard.changed.mockResolvedValueOnce(true);
    expect(await putAccount("ab", { enabled: true })).toEqual({ done: true });
    answer(403, stale);
    heard.changed.mockResolvedValueOnce(false);
    await refusalOf(putAccount("ab", { enabled: true }));
    expect(request).toHaveBeenCalledTimes(3);
    const bodies = await Promise.all(sent().map((one) => one.json()));
    expect(bodies).toEqual([{ enabled: true }, { enabled: true }, { enabled: true }]);
  });

  it("without content gives no value", async () => {
    request.mockResolvedValueOnce(new Response(null, { status: 204 }));
    expect(await endSession()).toBeUndefined();
  });

  it("escapes the parameters of its path and sends its body as JSON", async () => {
    answer(200, { name: "a/b" });
    await putAccount("a/b", { enabled: true });
    const [one] = sent();
    expect(one?.method).toBe("PUT");
    expect(new URL(one!.url).pathname).toBe("/api/accounts/a%2Fb");
    expect(one?.headers.get("Content-Type")).toContain("application/json");
    expect(await one?.json()).toEqual({ enabled: true });
  });
});
