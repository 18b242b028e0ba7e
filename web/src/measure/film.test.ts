import { expect, it, vi } from "vitest";

import { loadFilm } from "./film";

/** The answer with a picture whose values begin at a maximum and fall. */
function answer(max: number, values: Uint8Array | Uint16Array<ArrayBuffer>): Response {
  const numbers = {
    columns: 2,
    rows: 2,
    max,
    "pixel-aspect": 1,
    "window-center": 9,
    "window-width": 18,
  };
  const headers = Object.entries(numbers).map(([name, number]): [string, string] => [
    `x-spineline-${name}`,
    String(number),
  ]);
  return new Response(new Uint8Array(values.buffer as ArrayBuffer), { headers });
}

const load = (address: string, arrived?: (part: number) => void) =>
  loadFilm(address, new AbortController().signal, {
    grown: () => undefined,
    ...(arrived ? { arrived } : {}),
  });

it("reads films of one and of two bytes per pixel, with progress", async () => {
  vi.stubGlobal("fetch", async ({ url }: Request) =>
    url.endsWith("/8")
      ? answer(200, Uint8Array.of(200, 3, 2, 1))
      : answer(4000, Uint16Array.of(4000, 3, 2, 1)),
  );
  const parts: number[] = [];
  const small = await load("/8", (part) => parts.push(part));
  expect([...small.pyramid.levels[0]!.values]).toEqual([200, 3, 2, 1]);
  expect(parts.at(-1)).toBe(1);
  expect([...(await load("/16")).pyramid.levels[0]!.values]).toEqual([4000, 3, 2, 1]);
});

it("refuses a picture that is cut", async () => {
  vi.stubGlobal("fetch", async () => answer(200, Uint8Array.of(200, 3)));
  await expect(load("/cut")).rejects.toThrow("has 2 bytes instead of 4");
});
