import { answerOf, api } from "./client";
import type { Api } from "./types";

/** Names of the archives that the program was started with. */
export const listArchives = () => answerOf(api.GET("/api/archives"));

export const searchArchive = (body: Api<"ArchiveSearch">) =>
  answerOf(api.POST("/api/archives/search", { body }));

export const listArchiveFilms = (body: Api<"ArchiveSeriesChoice">) =>
  answerOf(api.POST("/api/archives/films", { body }));

/** Opens a film, which becomes an upload. */
export const openArchiveFilm = (body: Api<"ArchiveFilmChoice">, signal: AbortSignal) =>
  answerOf(api.POST("/api/archives/open", { body, signal }));
