import { answerOf, api } from "./client";

/** With statistics over synthetic and real studies together, or over the real ones alone. */
export const readCohort = (pools: boolean, signal: AbortSignal) =>
  answerOf(pools ? api.GET("/api/cohort/pooled", { signal }) : api.GET("/api/cohort", { signal }));
