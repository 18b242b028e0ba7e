import { beforeEach, expect, it, vi } from "vitest";

import { uploadFile } from "../api/client";
import { discardUpload } from "../api/studies";
import type { Api } from "../api/types";
import { Uploads } from "./uploads.svelte";

vi.mock("../api/client", () => ({ uploadFile: vi.fn() }));
vi.mock("../api/studies", () => ({ discardUpload: vi.fn(() => Promise.resolve()) }));

beforeEach(() => {
  vi.mocked(discardUpload).mockClear();
  let count = 0;
  vi.mocked(uploadFile).mockImplementation(() =>
    Promise.resolve({ upload: `u${(count += 1)}` } as Api<"UploadView">),
  );
});

async function sent(count: number): Promise<Uploads> {
  const uploads = new Uploads();
  uploads.add(Array.from({ length: count }, (_, at) => new File(["film"], `${at}.dcm`)));
  await vi.waitFor(() => expect(uploads.all.every(({ view }) => view)).toBe(true));
  return uploads;
}

it("gives back the room of a film that is removed", async () => {
  const uploads = await sent(2);
  uploads.remove(uploads.all[0]!);
  expect(vi.mocked(discardUpload).mock.calls).toEqual([["u1"]]);
});

it("gives back the room of what no study has when the page is left", async () => {
  const uploads = await sent(2);
  uploads.used(["u1"]);
  uploads.close();
  expect(uploads.all).toEqual([]);
  expect(vi.mocked(discardUpload).mock.calls).toEqual([["u2"]]);
});
