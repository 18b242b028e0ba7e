import { answerOf, api } from "./client";
import type { Api } from "./types";

const of = (study: string) => ({ params: { path: { study } } });

export const listStudies = (signal?: AbortSignal) => answerOf(api.GET("/api/studies", { signal }));

export const readStudy = (study: string, signal?: AbortSignal) =>
  answerOf(api.GET("/api/studies/{study}", { ...of(study), signal }));

export const createStudy = (body: Api<"NewStudy">) => answerOf(api.POST("/api/studies", { body }));

export const addFilms = (study: string, body: Api<"MoreFilms">) =>
  answerOf(api.POST("/api/studies/{study}/films", { ...of(study), body }));

export const editStudy = (study: string, body: Api<"StudyChange">) =>
  answerOf(api.POST("/api/studies/{study}/edits", { ...of(study), body }));

/** Renders five films of a phantom; takes seconds. */
export const createDemo = () => answerOf(api.POST("/api/studies/demo"));

export const importCase = (body: Api<"CaseImport">) =>
  answerOf(api.POST("/api/studies/case", { body }));

/** Plans blinded readings. */
export const planReadings = (study: string, body: Api<"NewPlan">) =>
  answerOf(api.POST("/api/studies/{study}/plan", { ...of(study), body }));

export const editFilm = (film: number, body: Api<"FilmChange">) =>
  answerOf(api.POST("/api/films/{film}/edits", { params: { path: { film } }, body }));

/** Measures a length or an angle on a film; nothing is stored. */
export const measureDrawn = (film: number, body: Api<"DrawnRequest">, signal: AbortSignal) =>
  answerOf(api.POST("/api/films/{film}/drawn", { params: { path: { film } }, body, signal }));

/** The model options of a study. */
export const readOptions = (study: string, signal?: AbortSignal) =>
  answerOf(api.GET("/api/studies/{study}/options", { ...of(study), signal }));

/** Changes model options; an empty value resets one. */
export const changeOptions = (study: string, body: Api<"OptionsChange">) =>
  answerOf(api.PUT("/api/studies/{study}/options", { ...of(study), body }));

export const readFindings = (study: string, signal: AbortSignal) =>
  answerOf(api.GET("/api/studies/{study}/findings", { ...of(study), signal }));

export const readOverlay = (study: string, film: number, signal: AbortSignal) =>
  answerOf(
    api.GET("/api/studies/{study}/films/{film}/overlay", {
      params: { path: { study, film } },
      signal,
    }),
  );

/** Heights of the vertebrae of the other one of the erect and the lateral film. */
export const readHeights = (study: string, film: number, signal: AbortSignal) =>
  answerOf(
    api.GET("/api/studies/{study}/films/{film}/heights", {
      params: { path: { study, film } },
      signal,
    }),
  );

export const readModel = (study: string, signal: AbortSignal) =>
  answerOf(api.GET("/api/studies/{study}/model", { ...of(study), signal }));

export const loadModel = (study: string, body: Api<"LoadRequest">, signal: AbortSignal) =>
  answerOf(api.POST("/api/studies/{study}/load", { ...of(study), body, signal }));

export const casePath = (study: string): string => `/api/studies/${encodeURIComponent(study)}/case`;

export const thumbnailPath = (film: number): string => `/api/films/${film}/thumbnail`;

export const uploadThumbnailPath = (upload: string): string =>
  `/api/uploads/${encodeURIComponent(upload)}/thumbnail`;

/** Discards an upload that is not in a study. */
export const discardUpload = (upload: string) =>
  answerOf(api.DELETE("/api/uploads/{upload}", { params: { path: { upload } } }));
