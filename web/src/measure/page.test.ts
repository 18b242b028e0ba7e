import { afterEach, expect, it, vi } from "vitest";

import { StudyPage } from "./page.svelte";
import { reading } from "./reading.fixture";

afterEach(() => void vi.unstubAllGlobals());

it("loads the study and the reading again after a lost connection", async () => {
  const kept = { getItem: () => null, setItem: () => undefined, removeItem: () => undefined };
  vi.stubGlobal("localStorage", kept);
  vi.stubGlobal("sessionStorage", kept);
  vi.stubGlobal("navigator", {});
  let revision = 0;
  const asked: string[] = [];
  vi.stubGlobal("fetch", async (request: Request) => {
    asked.push(new URL(request.url).pathname);
    return new Response(JSON.stringify({ ...reading(), revision, notes: [`${revision}`] }));
  });
  const page = new StudyPage("S-1");
  await page.openReading(7);
  expect(page.marking?.reading.notes).toEqual(["0"]);

  // Others changed the reading without a connection from here.
  revision = 4;
  asked.length = 0;
  await page.catchUp();
  expect(asked).toContain("/api/studies/S-1");
  expect(page.marking?.reading.notes).toEqual(["4"]);
  expect(page.marking?.revision).toBe(4);
  page.close();
});
