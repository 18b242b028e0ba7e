import type { Api } from "../api/types";

export const ROLES: Api<"RoleName">[] = ["reader", "editor", "admin"];

export const ROLE_HELP: Record<Api<"RoleName">, string> = {
  reader: "Looks at the studies that were granted.",
  editor: "Marks films of studies that were granted, and makes new ones.",
  admin: "Leads: accounts, grants, blinded plans, and every study.",
};
