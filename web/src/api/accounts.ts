import { ask } from "./client";
import type { Api } from "./types";

const accountPath = (name: string): string => `/api/accounts/${encodeURIComponent(name)}`;

const grantsPath = (study: string): string => `/api/studies/${encodeURIComponent(study)}/grants`;

export const listAccounts = (): Promise<Api<"AccountView">[]> => ask("GET", "/api/accounts");

/** Adds an account, or changes one: what is absent stays. */
export const putAccount = (name: string, edit: Api<"AccountEdit">): Promise<Api<"AccountView">> =>
  ask("PUT", accountPath(name), { json: edit });

export const listGrants = (study: string): Promise<Api<"Grant">[]> => ask("GET", grantsPath(study));

export const putGrants = (study: string, grants: Api<"Grant">[]): Promise<Api<"Grant">[]> =>
  ask("PUT", grantsPath(study), { json: grants });
