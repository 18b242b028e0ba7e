import { answerOf, api } from "./client";

export const readCohort = () => answerOf(api.GET("/api/cohort"));
