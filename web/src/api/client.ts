import createClient from "openapi-fetch";

import type { paths } from "./schema";
import type { Api } from "./types";

const TOKEN_HEADER = "X-Spineline-Csrf";

/** A refused request with the program's message. */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly problem: Api<"Problem">,
    /** The whole body: for a conflict it contains the current reading. */
    readonly body: unknown,
  ) {
    super(problem.message);
  }
}

/** The program did not answer. Whether it received the request is unknown. */
export class Unreachable extends Error {
  constructor() {
    super("the program does not answer");
  }
}

/** Callbacks of the shell for every request. */
export interface Listener {
  answered(): void;
  unreachable(): void;
  /** The session has ended. */
  expired(): void;
  /** The session has changed, as after a sign-in in another tab; returns whether the person is the same. */
  changed(): Promise<boolean>;
}

let listener: Listener | null = null;
let csrf = "";

/** Sets the listener. */
export function listen(to: Listener): void {
  listener = to;
}

/** Sets the session: requests that change something send its token. */
export function useSession(session: Api<"SessionView">): void {
  csrf = session.csrf;
}

async function send(request: Request): Promise<Response> {
  const again = request.clone();
  try {
    return await sendOnce(request);
  } catch (error) {
    const isStale = error instanceof Refusal && error.problem.code === "csrf";
    // A change of one person is never sent in the name of another.
    if (isStale && (await listener?.changed())) return sendOnce(again);
    throw error;
  }
}

async function sendOnce(request: Request): Promise<Response> {
  if (request.method !== "GET") request.headers.set(TOKEN_HEADER, csrf);
  let response: Response;
  try {
    response = await fetch(request);
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    listener?.unreachable();
    throw new Unreachable();
  }
  listener?.answered();
  if (response.ok) return response;
  const { pathname } = new URL(request.url);
  throw refused(pathname, response.status, await response.json().catch(() => null));
}

function refused(path: string, status: number, body: unknown): Refusal {
  // A sign-in with a wrong password does not end a session.
  if (status === 401 && path !== "/api/session") listener?.expired();
  const problem = problemOf(body) ?? {
    code: "unknown",
    message: `the program answered ${status}`,
  };
  return new Refusal(status, problem, body);
}

/** The problem in a refusal: the body or a part of it. */
function problemOf(body: unknown): Api<"Problem"> | null {
  if (typeof body !== "object" || body === null) return null;
  if ("problem" in body) return problemOf(body.problem);
  return "code" in body && "message" in body ? (body as Api<"Problem">) : null;
}

/** The routes of the program, with the types of its interface. A refusal is thrown. */
export const api = createClient<paths>({ baseUrl: location.origin, fetch: send });

/** The data of a response; errors have been thrown before. */
export async function answerOf<T>(asked: Promise<{ data?: T }>): Promise<T> {
  return (await asked).data as T;
}

/** Requests the bytes at an address. */
export function askBytes(
  address: string,
  signal: AbortSignal,
  how: RequestInit = {},
): Promise<Response> {
  return send(new Request(new URL(address, location.origin), { ...how, signal }));
}

/** Uploads a file and reports the fraction sent, from 0 to 1. `fetch` reports no progress. */
export function uploadFile(
  file: Blob,
  onsent: (fraction: number) => void,
  signal: AbortSignal,
): Promise<Api<"UploadView">> {
  const path: keyof paths = "/api/uploads";
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", path);
    request.setRequestHeader(TOKEN_HEADER, csrf);
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
      if (request.status >= 200 && request.status < 300) resolve(body as Api<"UploadView">);
      else reject(refused(path, request.status, body));
    };
    signal.addEventListener("abort", () => request.abort());
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
