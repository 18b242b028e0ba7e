import type { Api } from "../api/types";

export const ROLES: Api<"RoleName">[] = ["reader", "editor", "admin"];

export const ROLE_HELP: Record<Api<"RoleName">, string> = {
  reader: "Views granted studies.",
  editor: "Places landmarks in granted studies and creates studies.",
  admin: "Manages accounts, grants, blinded plans and all studies.",
};
