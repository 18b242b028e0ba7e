import { beforeAll, describe, expect, it, vi } from "vitest";

import type { Page } from "./router.svelte";

let router: typeof import("./router.svelte");

beforeAll(async () => {
  vi.stubGlobal("window", { location: { hash: "" }, addEventListener: () => undefined });
  router = await import("./router.svelte");
});

describe("addresses", () => {
  const pages: Page[] = [
    { name: "studies" },
    { name: "new-study" },
    { name: "import" },
    { name: "cohort" },
    { name: "access" },
    { name: "measure", study: "S-017" },
    { name: "measure", study: "S-017", film: 3 },
    { name: "films", study: "S-017" },
    { name: "model", study: "a.b_c-1" },
    { name: "evidence", study: "S-017" },
    { name: "plan", study: "a.b_c-1" },
    { name: "read", study: "S-017" },
  ];

  it.each(pages)("are parsed back to %o", (page) => {
    expect(router.pageOf(router.addressOf(page))).toEqual(page);
  });

  it("show the studies for unknown addresses", () => {
    for (const hash of ["", "#", "#/", "#/nowhere", "#/studies", "#/studies/"])
      expect(router.pageOf(hash)).toEqual({ name: "studies" });
  });

  it("show the studies for addresses that cannot be decoded", () => {
    expect(router.pageOf("#/studies/%E0%A4%A/measure")).toEqual({ name: "studies" });
  });

  it("ignore a film that is not an integer", () => {
    expect(router.pageOf("#/studies/A/measure/x1")).toEqual({ name: "measure", study: "A" });
  });
});
