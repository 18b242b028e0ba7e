import { answerOf, api } from "./client";
import type { Api } from "./types";

type Name = Api<"ComputationName">;

const of = (study: string, computation: Name) => ({ params: { path: { study, computation } } });

/** A computation of the current results of a study. */
export const readComputation = (study: string, name: Name) =>
  answerOf(api.GET("/api/studies/{study}/computations/{computation}", of(study, name)));

/** Computes in the background. */
export const compute = (study: string, name: Name, body: Api<"ComputationRequest">) =>
  answerOf(
    api.POST("/api/studies/{study}/computations/{computation}", { ...of(study, name), body }),
  );

export const cancelComputation = (study: string, name: Name) =>
  answerOf(api.DELETE("/api/studies/{study}/computations/{computation}", of(study, name)));

/** The lines of action beside predictions without mechanics, and lines of best fit, as in the report. */
export const readLines = (study: string, signal?: AbortSignal) =>
  answerOf(
    api.GET("/api/studies/{study}/lines", { params: { path: { study } }, signal: signal ?? null }),
  );
