import type { Api } from "../api/types";

/** A person who may be chosen as an observer. */
export interface Candidate {
  name: string;
  /** Why the person cannot read in the study; null for permission. */
  trouble: string | null;
}

/** Accounts as observers of a study with these grants: an observer must be able to place landmarks. */
export function candidates(
  accounts: readonly Api<"AccountView">[],
  grants: readonly Api<"Grant">[],
): Candidate[] {
  const roleOf = ({ name, role }: Api<"AccountView">): Api<"RoleName"> | null => {
    if (role !== "editor") return role;
    return grants.find((grant) => grant.name === name)?.role ?? null;
  };
  return accounts
    .filter(({ enabled }) => enabled)
    .map((account) => {
      const role = roleOf(account);
      const canRead = role === "admin" || role === "editor";
      return {
        name: account.name,
        trouble: canRead ? null : "needs the role editor in this study",
      };
    });
}

/** Names separated by commas or spaces, each once. */
export const namesIn = (text: string): string[] => [
  ...new Set(text.split(/[\s,;]+/).filter((name) => name !== "")),
];

/** A whole number of at least `least` as people write it; null for everything else. */
export function wholeNumber(text: string, least: number): number | null {
  const written = text.trim();
  if (!/^\d{1,10}$/.test(written)) return null;
  const number = Number(written);
  return number >= least ? number : null;
}
