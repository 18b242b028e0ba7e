import { answerOf, api } from "./client";
import type { Api } from "./types";

const of = (study: string) => ({ params: { path: { study } } });

/** The model options of a study. */
export const readOptions = (study: string, signal?: AbortSignal) =>
  answerOf(api.GET("/api/studies/{study}/options", { ...of(study), signal }));

/** Changes model options; an empty value resets one. */
export const changeOptions = (study: string, body: Api<"OptionsChange">) =>
  answerOf(api.PUT("/api/studies/{study}/options", { ...of(study), body }));
