import type { Page } from "@playwright/test";

import type { Api } from "../src/api/types";

/** Records the program's answers to a page: hidden values must not be in them. */
export interface Answers {
  readonly texts: Promise<{ address: string; text: string }>[];
  readonly kinds: Set<string>;
  read(): Promise<{ address: string; text: string }[]>;
}

/** Records all answers of the interface to a page from now on. */
export function answers(page: Page): Answers {
  const texts: Answers["texts"] = [];
  const kinds = new Set<string>();
  page.on("response", (response) => {
    const { pathname } = new URL(response.url());
    if (!pathname.startsWith("/api/")) return;
    const kind = response.headers()["content-type"] ?? "";
    kinds.add(kind);
    const headers = JSON.stringify(response.headers());
    // Streams never end, and pictures contain no text.
    const body = /json/.test(kind) ? response.text().catch(() => "") : Promise.resolve("");
    texts.push(body.then((text) => ({ address: pathname, text: headers + text })));
  });
  return { texts, kinds, read: () => Promise.all(texts) };
}

export interface Answer<T> {
  status: number;
  body: T;
}

/** Sends a request like the page. */
export function get<T = unknown>(page: Page, address: string): Promise<Answer<T>> {
  return page.evaluate(async (address) => {
    const response = await fetch(address);
    const text = await response.text();
    let body: unknown = text;
    if (/json/.test(response.headers.get("content-type") ?? "")) body = JSON.parse(text);
    return { status: response.status, body } as Answer<T>;
  }, address);
}

/** Sends a change in the name of the signed-in person. */
export async function send<T = unknown>(
  page: Page,
  method: "POST" | "PUT",
  address: string,
  json: unknown,
): Promise<Answer<T>> {
  const { csrf } = (await get<Api<"SessionView">>(page, "/api/session")).body;
  return page.evaluate(
    async ([method, address, json, csrf]) => {
      const headers = { "content-type": "application/json", "x-spineline-csrf": csrf };
      const response = await fetch(address, { method, headers, body: JSON.stringify(json) });
      return { status: response.status, body: (await response.json()) as T };
    },
    [method, address, json, csrf] as const,
  );
}

/** Records requests to other hosts, and requests with the token, from now on. */
export function requestsElsewhere(page: Page, address: string): string[] {
  const elsewhere: string[] = [];
  page.on("request", (request) => {
    const url = new URL(request.url());
    const isHere = url.origin === new URL(address).origin;
    if (!isHere && !["data:", "blob:"].includes(url.protocol)) elsewhere.push(url.href);
    if (url.href.includes("token=")) elsewhere.push("the token was sent with a request");
  });
  return elsewhere;
}
