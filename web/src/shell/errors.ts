import { Refusal } from "../api/client";

/** The message of a caught value. */
export const messageOf = (error: unknown): string =>
  error instanceof Error ? error.message : String(error);

/** The program's advice after a refusal; null for other errors. */
export const helpOf = (error: unknown): string | null =>
  error instanceof Refusal ? (error.problem.help ?? null) : null;
