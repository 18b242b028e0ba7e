import { answerOf, api } from "./client";
import type { Api } from "./types";

export const listAccounts = (signal?: AbortSignal) =>
  answerOf(api.GET("/api/accounts", { signal }));

/** Adds an account, or changes one: absent values are kept. */
export const putAccount = (name: string, body: Api<"AccountEdit">) =>
  answerOf(api.PUT("/api/accounts/{name}", { params: { path: { name } }, body }));

export const listGrants = (id: string) =>
  answerOf(api.GET("/api/studies/{id}/grants", { params: { path: { id } } }));

export const putGrants = (id: string, body: Api<"Grant">[]) =>
  answerOf(api.PUT("/api/studies/{id}/grants", { params: { path: { id } }, body }));
