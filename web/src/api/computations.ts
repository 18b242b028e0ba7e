import { answerOf, api } from "./client";
import type { Api } from "./types";

type Name = Api<"ComputationName">;

const of = (study: string, computation: Name) => ({ params: { path: { study, computation } } });

/** State of a computation in the background. */
export type Progress = Pick<Api<"ComputationView">, "state" | "done" | "asked" | "texts">;

/** A computation in the background: its state and results, its start and its cancel. */
export interface Background<View extends Progress> {
  read: () => Promise<View>;
  begin: () => Promise<View>;
  cancel: () => Promise<View>;
}

/** A computation of the current results of a study, with this number of replicates. */
export function computationOf(
  study: string,
  name: Name,
  count?: number,
): Background<Api<"ComputationView">> {
  const address = "/api/studies/{study}/computations/{computation}";
  const body = count === undefined ? {} : { count };
  return {
    read: () => answerOf(api.GET(address, of(study, name))),
    begin: () => answerOf(api.POST(address, { ...of(study, name), body })),
    cancel: () => answerOf(api.DELETE(address, of(study, name))),
  };
}

/** The erect and the lateral film together, as in the report. */
export const readSpace = (study: string, signal: AbortSignal) =>
  answerOf(api.GET("/api/studies/{study}/space", { params: { path: { study } }, signal }));

/** The lines of action beside predictions without mechanics, and lines of best fit, as in the report. */
export const readLines = (study: string, signal: AbortSignal) =>
  answerOf(api.GET("/api/studies/{study}/lines", { params: { path: { study } }, signal }));
