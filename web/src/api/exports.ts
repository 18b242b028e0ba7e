import { answerOf, api, askBytes } from "./client";
import type { Api } from "./types";

const of = (study: string): string => `/api/studies/${encodeURIComponent(study)}`;

/** The export formats of a study. */
export const listExports = (signal: AbortSignal) => answerOf(api.GET("/api/exports", { signal }));

export const exportPath = (study: string, name: Api<"ExportName">): string =>
  `${of(study)}/exports/${name}`;

export const modelPath = (
  study: string,
  line: Api<"LineKindName">,
  format: Api<"ExportFormatName">,
): string => `${of(study)}/models/${line}/${format}`;

/** Saves the file at an address under the name from the program; a refusal is thrown. */
export async function save(address: string, signal: AbortSignal): Promise<void> {
  await saveAnswer(await askBytes(address, signal));
}

/** Saves a response under the name from the program. */
export async function saveAnswer(response: Response): Promise<void> {
  const stated = response.headers.get("content-disposition") ?? "";
  saveBlob(await response.blob(), /filename="([^"]+)"/.exec(stated)?.[1] ?? "");
}

/** Saves a file. */
export function saveBlob(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.download = name;
  link.href = URL.createObjectURL(blob);
  link.click();
  // The browser has the bytes after it has handled the click.
  setTimeout(() => URL.revokeObjectURL(link.href), 0);
}
