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

/** What the shell wants to hear of every request. */
export interface Listener {
  answered(): void;
  unreachable(): void;
  /** Nobody is signed in any more. */
  expired(): void;
  /** The session is another one, as after signing in in another tab; answers whether it is the same person's. */
  changed(): Promise<boolean>;
}

let listener: Listener | null = null;
let csrf = "";

/** Lets the shell know how requests end. */
export function listen(to: Listener): void {
  listener = to;
}

/** To be called with every session: requests that change something carry its token. */
export function useSession(session: Api<"SessionView">): void {
  csrf = session.csrf;
}

export type Method = "GET" | "POST" | "PUT" | "PATCH" | "DELETE";

export interface Sending {
  /** Sent as JSON. */
  json?: unknown;
  /** Sent as they are. */
  bytes?: Blob | ArrayBuffer;
  signal?: AbortSignal;
}

async function send(method: Method, path: string, sending: Sending = {}): Promise<Response> {
  try {
    return await sendOnce(method, path, sending);
  } catch (error) {
    const isStale = error instanceof Refusal && error.problem.code === "csrf";
    // What one person did is never sent in the name of another.
    if (isStale && (await listener?.changed())) return sendOnce(method, path, sending);
    throw error;
  }
}

async function sendOnce(method: Method, path: string, sending: Sending): Promise<Response> {
  const headers = headersOf(method);
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
    listener?.unreachable();
    throw new Unreachable();
  }
  listener?.answered();
  if (response.ok) return response;
  throw refused(path, response.status, await response.json().catch(() => null));
}

function headersOf(method: Method): Record<string, string> {
  return method === "GET" ? {} : { "X-Spineline-Csrf": csrf };
}

function refused(path: string, status: number, body: unknown): Refusal {
  // Signing in with a wrong password ends nobody's session.
  if (status === 401 && path !== "/api/session") listener?.expired();
  const problem = problemOf(body) ?? {
    code: "unknown",
    message: `the program answered ${status}`,
  };
  return new Refusal(status, problem, body);
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

/** Sends a file and tells how much of it has gone, from 0 to 1; `fetch` cannot tell. */
export function sendFile<T>(
  path: string,
  file: Blob,
  onsent: (fraction: number) => void,
  signal?: AbortSignal,
): Promise<T> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", path);
    for (const [name, value] of Object.entries(headersOf("POST")))
      request.setRequestHeader(name, value);
    request.setRequestHeader("Content-Type", "application/octet-stream");
    request.upload.onprogress = (event) => {
      if (event.lengthComputable) onsent(event.loaded / event.total);
    };
    request.onerror = () => {
      listener?.unreachable();
      reject(new Unreachable());
    };
    request.onabort = () => reject(new DOMException("stopped", "AbortError"));
    request.onload = () => {
      listener?.answered();
      const body = jsonOf(request.responseText);
      if (request.status >= 200 && request.status < 300) resolve(body as T);
      else reject(refused(path, request.status, body));
    };
    signal?.addEventListener("abort", () => request.abort());
    request.send(file);
  });
}

function jsonOf(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}
