import type { Api } from "./types";

/** A request that was refused, in the program's own words. */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly problem: Api<"Problem">,
    /** The whole body: a conflict brings the reading as it stands. */
    readonly body: unknown,
  ) {
    super(problem.message);
  }
}

/** The program did not answer: it was stopped, or the machine sleeps. Nothing is known of the request. */
export class Unreachable extends Error {
  constructor() {
    super("the program does not answer");
  }
}

let csrf = "";

/** To be called with every session: requests that change something carry its token. */
export function useSession(session: Api<"SessionView">): void {
  csrf = session.csrf;
}

type Method = "GET" | "POST" | "PUT" | "PATCH" | "DELETE";

export interface Sending {
  /** Sent as JSON. */
  json?: unknown;
  /** Sent as they are. */
  bytes?: Blob | ArrayBuffer;
  signal?: AbortSignal;
}

async function send(method: Method, path: string, sending: Sending = {}): Promise<Response> {
  const headers: Record<string, string> = {};
  if (method !== "GET") headers["X-Spineline-Csrf"] = csrf;
  let body: BodyInit | undefined;
  if (sending.json !== undefined) {
    headers["Content-Type"] = "application/json";
    body = JSON.stringify(sending.json);
  } else if (sending.bytes !== undefined) {
    headers["Content-Type"] = "application/octet-stream";
    body = sending.bytes;
  }
  let response: Response;
  try {
    response = await fetch(path, {
      method,
      headers,
      body: body ?? null,
      signal: sending.signal ?? null,
      credentials: "same-origin",
    });
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw new Unreachable();
  }
  if (response.ok) return response;
  throw await refusal(response);
}

async function refusal(response: Response): Promise<Refusal> {
  const body: unknown = await response.json().catch(() => null);
  const problem = problemOf(body) ?? {
    code: "unknown",
    message: `the program answered ${response.status}`,
  };
  return new Refusal(response.status, problem, body);
}

/** The problem of a refusal: the body itself, or a part of it. */
function problemOf(body: unknown): Api<"Problem"> | null {
  if (typeof body !== "object" || body === null) return null;
  if ("problem" in body) return problemOf(body.problem);
  return "code" in body && "message" in body ? (body as Api<"Problem">) : null;
}

/** Asks, and reads the answer as JSON. */
export async function ask<T>(method: Method, path: string, sending?: Sending): Promise<T> {
  const response = await send(method, path, sending);
  return response.status === 204 ? (undefined as T) : ((await response.json()) as T);
}

/** Asks, and reads the answer as bytes. */
export async function askBytes(path: string, signal?: AbortSignal): Promise<Response> {
  return send("GET", path, signal ? { signal } : {});
}
