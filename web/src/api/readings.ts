import { answerOf, api } from "./client";
import type { Api } from "./types";

const of = (reading: number) => ({ params: { path: { reading } } });

export const readReading = (reading: number, signal?: AbortSignal) =>
  answerOf(api.GET("/api/readings/{reading}", { ...of(reading), signal }));

export const beginReading = (film: number, body: Api<"NewReading">) =>
  answerOf(api.POST("/api/films/{film}/readings", { params: { path: { film } }, body }));

/** Begins a blinded reading by the film's code. */
export const beginBlindedReading = (code: string) =>
  answerOf(api.POST("/api/codes/{code}/readings", { params: { path: { code } } }));

export const recordEvents = (reading: number, body: Api<"NewEvent">) =>
  answerOf(api.POST("/api/readings/{reading}/events", { ...of(reading), body }));

/** Vertebrae that the program finds in the picture. */
export const detectVertebrae = (reading: number) =>
  answerOf(api.POST("/api/readings/{reading}/detection", of(reading)));

/** The sure proposals that the picture contradicts. */
export const findMisfits = (reading: number) =>
  answerOf(api.POST("/api/readings/{reading}/misfits", of(reading)));

/** In a plan the answer lacks the reading: a plan hides the landmarks of finished readings. */
export const finishReading = (reading: number, body: Api<"Finish">) =>
  answerOf(api.POST("/api/readings/{reading}/finish", { ...of(reading), body }));

/** A copy of a finished reading, which replaces it when it is finished. */
export const correctReading = (reading: number) =>
  answerOf(api.POST("/api/readings/{reading}/correction", of(reading)));

export const withdrawReading = (reading: number, body: Api<"NewWithdrawal">) =>
  answerOf(api.POST("/api/readings/{reading}/withdrawal", { ...of(reading), body }));

export const readLive = (reading: number, signal: AbortSignal) =>
  answerOf(api.GET("/api/readings/{reading}/live", { ...of(reading), signal }));

export const previewReading = (reading: number, body: Api<"PreviewRequest">, signal: AbortSignal) =>
  answerOf(api.POST("/api/readings/{reading}/preview", { ...of(reading), body, signal }));
