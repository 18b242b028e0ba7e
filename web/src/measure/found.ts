import { counted } from "../shell/words";
import type { Proposal } from "./proposals";

/*
 * Seconds of a practised reader. Two clicks on each of 17 vertebrae take 28 s. A look at an outline tells whether it is right. A
 * wrong one is chosen in the list of levels and clicked. Proposals begin with P, the answer, a look at the levels, and A.
 */
const TWO_CLICKS_S = 28 / 17;
const LOOK_S = 0.3;
const MEND_S = 3;
const BEGIN_S = 0.8 + 1.5 + 2 + 0.8;

/**
 * Share of clearly found vertebrae whose corners are on average wrong by more than a quarter of the height, on 54 validation films.
 * A look and the mending of wrong ones take as long as two clicks where 45 % are wrong.
 */
const WRONG_SHARE = 105 / 752;

/** Whether a vertebra was found in the picture clearly or is to be checked; null if it was not found there. */
export function clarity({ sd_share, is_sure }: Proposal): "clear" | "check" | null {
  if (sd_share == null) return null;
  return is_sure ? "clear" : "check";
}

const withClarity = (
  proposals: readonly Proposal[],
  wanted: "clear" | "check",
): readonly Proposal[] => proposals.filter((proposal) => clarity(proposal) === wanted);

/** Time that the clearly found vertebrae save against two clicks on every vertebra; the others are clicked in any case. */
export function secondsSaved(found: readonly Proposal[]): number {
  const each = TWO_CLICKS_S - LOOK_S - WRONG_SHARE * MEND_S;
  return withClarity(found, "clear").length * each - BEGIN_S;
}

/** What is said of the found vertebrae, in two parts: short, and the rest of the sentence. */
interface Offer {
  /** Whether two clicks on every vertebra are faster. */
  isSlow: boolean;
  words: readonly [string, string];
}

/** The offer to accept the clearly found vertebrae together; null without one, and once a person has begun with them. */
export function offerOf(found: readonly Proposal[], proposals: readonly Proposal[]): Offer | null {
  if (found.length === 0 || !found.every((one) => proposals.includes(one))) return null;
  const clear = withClarity(found, "clear").length;
  const count = `${clear} of ${counted(found.length, "vertebra", "vertebrae")}`;
  const isSlow = secondsSaved(found) <= 0;
  const words = isSlow
    ? (["Two clicks is faster", `on this film: ${count} were found clearly`] as const)
    : ([count, "were found clearly: look at each, then accept"] as const);
  return { isSlow, words };
}

/** What a person does with the proposals that are not clear; empty without one. */
export function leftWords(open: readonly Proposal[]): string {
  const levels = withClarity(open, "check").map(({ level }) => level);
  if (levels.length === 0) return "";
  return `To check: ${levels.join(", ")}. Two clicks replace a proposal; or drag its corners, or accept it`;
}
