import type { Api } from "../api/types";
import { helpOf, messageOf } from "../shell/errors";

/** A message beside the film: one line of text, and the rest on request. */
export interface Message {
  severity: Api<"Severity">;
  text: string;
  /** The remedy. */
  help?: string | null;
  /** Its button, such as `Try again`. */
  action?: { label: string; run: () => void };
}

/** An action that failed, such as `The study could not be loaded`. */
export function failed(what: string, error: unknown, onretry?: () => void): Message {
  return {
    severity: "error",
    text: `${what}: ${messageOf(error)}`,
    help: helpOf(error),
    ...(onretry ? { action: { label: "Try again", run: onretry } } : {}),
  };
}

/** An error of the landmarks, with its vertebra where the text does not begin with it. */
export const faulty = ({ severity, level, text }: Api<"Notice">): Message => ({
  severity,
  text: level && !text.startsWith(level) ? `${level}: ${text}` : text,
});
