import { ask, sendFile } from "./client";
import type { Api } from "./types";

export const listStudies = (): Promise<Api<"StudySummary">[]> => ask("GET", "/api/studies");

export const createStudy = (study: Api<"NewStudy">): Promise<Api<"StudyDetail">> =>
  ask("POST", "/api/studies", { json: study });

/** Renders five films of a phantom, which takes a while. */
export const createDemo = (): Promise<Api<"StudyDetail">> => ask("POST", "/api/studies/demo");

export const importCase = (case_: Api<"CaseImport">): Promise<Api<"StudyDetail">> =>
  ask("POST", "/api/studies/case", { json: case_ });

export const casePath = (study: string): string => `/api/studies/${encodeURIComponent(study)}/case`;

export const thumbnailPath = (film: number): string => `/api/films/${film}/thumbnail`;

export const upload = (
  file: Blob,
  onsent: (fraction: number) => void,
  signal: AbortSignal,
): Promise<Api<"UploadView">> => sendFile("/api/uploads", file, onsent, signal);

export const uploadThumbnailPath = (upload_: string): string =>
  `/api/uploads/${encodeURIComponent(upload_)}/thumbnail`;
