import { Refusal } from "../api/client";

/** What a caught value says. */
export const messageOf = (error: unknown): string =>
  error instanceof Error ? error.message : String(error);

/** What the program advises after a refusal; null for other errors. */
export const helpOf = (error: unknown): string | null =>
  error instanceof Refusal ? (error.problem.help ?? null) : null;
