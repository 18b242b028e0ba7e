import { expect, it, vi } from "vitest";

import { Unreachable } from "../api/client";
import { connection } from "../shell/connection.svelte";
import { Job } from "./job.svelte";

it("asks for the progress again when the connection is back", async () => {
  const read = vi.fn(async () => ({ state: "done" }));
  const seen: string[] = [];
  const job = new Job("The map", read, ({ state }) => seen.push(state), 1);
  vi.spyOn(connection, "back").mockResolvedValue();
  await job.ask("The progress is unknown", () => Promise.reject(new Unreachable()));
  await vi.waitFor(() => expect(seen).toEqual(["done"]));
  expect(job.problem).toBeNull();
});
