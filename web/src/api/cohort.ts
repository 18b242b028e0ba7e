import { ask } from "./client";
import type { Api } from "./types";

export const readCohort = (): Promise<Api<"CohortView">> => ask("GET", "/api/cohort");
