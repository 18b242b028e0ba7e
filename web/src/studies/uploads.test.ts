import { beforeEach, expect, it, vi } from "vitest";

import { openArchiveFilm } from "../api/archives";
import { uploadFile } from "../api/client";
import { discardUpload } from "../api/studies";
import type { Api } from "../api/types";
import { Uploads } from "./uploads.svelte";

vi.mock("../api/archives", () => ({ openArchiveFilm: vi.fn() }));
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

it("treats a film of an archive as an upload, and says why it was not opened", async () => {
  const film = { archive: "clinic", study: "1.2", series: "1.2.3", instance: "1.2.3.4" };
  const view = { upload: "u9" } as Api<"UploadView">;
  vi.mocked(openArchiveFilm).mockRejectedValueOnce(new Error("no")).mockResolvedValueOnce(view);
  const uploads = new Uploads();
  uploads.open("clinic, film 1", film);
  const [opened] = uploads.all;
  await vi.waitFor(() => expect(opened?.error).toBeInstanceOf(Error));
  expect(opened?.what).toBe("This film was not opened");
  uploads.again(opened!);
  await vi.waitFor(() => expect(opened?.view).toBe(view));
  uploads.remove(opened!);
  expect(vi.mocked(discardUpload).mock.calls).toEqual([["u9"]]);
});
