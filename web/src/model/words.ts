import type { Api } from "../api/types";
import { fixed, withUnit } from "../shell/number";

type Identified = Api<"Identified">;

/** The word of a verdict, and the class of its colour. */
const IDENTIFIED: Record<Identified, [string, string]> = {
  absolute: ["Fitted", "good"],
  ratio_only: ["Ratio only", "note"],
  bound: ["At a bound", "warning"],
  contradicted: ["Contradicted", "contradiction"],
  not_converged: ["Not converged", "error"],
};

const LINE_TOKENS: Record<Api<"LineKindName">, string> = {
  inflection_line: "--inflection-line",
  iliac_line: "--iliac-line",
  estimated_line: "--estimated-line",
  given_line: "--given-line",
};

export const identifiedWord = (identified: Identified): string => IDENTIFIED[identified][0];

export const identifiedTone = (identified: Identified): string => IDENTIFIED[identified][1];

/** Token of the colour of a line. */
export const lineToken = (line: Api<"LineKindName">): string => LINE_TOKENS[line];

/** A length in the unit of the study; the reason for an absent one is shown beside it. */
export const lengthText = (value_mm: number | null | undefined, unit: string): string =>
  value_mm === null || value_mm === undefined ? "none" : withUnit(fixed(value_mm, 1), unit);

export const factorText = (factor: number): string => `× ${fixed(factor, 2)}`;
