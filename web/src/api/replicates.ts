import { answerOf, api } from "./client";

const of = (study: string) => ({ params: { path: { study } } });

/** The replicates of the current results of a study. */
export const readReplicates = (study: string) =>
  answerOf(api.GET("/api/studies/{study}/replicates", of(study)));

/** Computes replicates in the background. */
export const computeReplicates = (study: string, count: number) =>
  answerOf(api.POST("/api/studies/{study}/replicates", { ...of(study), body: { count } }));

export const cancelReplicates = (study: string) =>
  answerOf(api.DELETE("/api/studies/{study}/replicates", of(study)));
