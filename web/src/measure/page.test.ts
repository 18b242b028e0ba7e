import { afterEach, expect, it, vi } from "vitest";

import type { Api } from "../api/types";
import { connection } from "../shell/connection.svelte";
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

it("never overwrites a study that another person changed after the dialog opened", async () => {
  let revision = 3;
  const expected: number[] = [];
  vi.stubGlobal("fetch", async (request: Request) => {
    if (request.method === "POST") {
      const body = (await request.json()) as Api<"StudyChange">;
      expected.push(body.expected_revision);
      revision += 1;
    }
    return Response.json({ summary: { films: [], revision } });
  });
  const page = new StudyPage("S-1");
  await page.refresh();
  const edit = page.studyEditor();
  revision = 8;
  await page.refresh();
  await edit({ kind: "label", label: "before brace" });
  await edit({ kind: "archived", archived: true });
  expect(expected, "as opened, then after the own change").toEqual([3, 9]);
});

it("waits for the program without a message, and shows what it refuses", async () => {
  const page = new StudyPage("S-1");
  vi.stubGlobal("fetch", () => Promise.reject(new TypeError("no connection")));
  const loaded = page.refresh();
  await vi.waitFor(() => expect(connection.lost).toBe(true));
  expect(page.problem).toBeNull();
  vi.stubGlobal("fetch", () => Promise.resolve(Response.json({ summary: { films: [] } })));
  await connection.retry();
  await loaded;
  expect(page.problem).toBeNull();
  expect(page.films).toEqual([]);

  const refusal = { code: "not_found", message: "the study does not exist" };
  vi.stubGlobal("fetch", () => Promise.resolve(Response.json(refusal, { status: 404 })));
  await page.refresh();
  expect(page.problem?.what).toBe("The study could not be loaded");
});
