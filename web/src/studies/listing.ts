import type { Api } from "../api/types";
import { statusWord, statuses } from "../shell/words";

export type Study = Api<"StudySummary">;

export const ORDERS = {
  changed: "Last change",
  id: "Identifier",
  cobb: "Largest curve",
  status: "Status",
  trouble: "Contradictions and warnings",
} as const;

export type Order = keyof typeof ORDERS;

export interface Choice {
  /** Words that must all occur. */
  search: string;
  status: Api<"StudyStatus"> | "all";
  order: Order;
  /** Whether archived studies are shown, and no others. */
  archived: boolean;
}

/** Texts of a study that the search uses. */
function textOf(study: Study): string {
  return [
    study.id,
    study.label,
    study.curve?.text,
    statusWord(study.status),
    study.status_text,
    study.synthetic ? "synthetic" : "",
  ]
    .join(" ")
    .toLowerCase();
}

const byId = (a: Study, b: Study): number =>
  a.id.localeCompare(b.id, "en", { numeric: true, sensitivity: "base" });

const BY: Record<Order, (a: Study, b: Study) => number> = {
  changed: (a, b) => b.changed_ms - a.changed_ms,
  id: byId,
  cobb: (a, b) => (b.curve?.size_deg ?? -1) - (a.curve?.size_deg ?? -1),
  status: (a, b) => statuses.indexOf(a.status) - statuses.indexOf(b.status),
  trouble: (a, b) => b.contradictions - a.contradictions || b.warnings - a.warnings,
};

/** The studies to show, in their order. */
export function chosen(studies: Study[], choice: Choice): Study[] {
  const words = choice.search.toLowerCase().split(/\s+/).filter(Boolean);
  return studies
    .filter((study) => study.archived === choice.archived)
    .filter((study) => choice.status === "all" || study.status === choice.status)
    .filter((study) => {
      const text = textOf(study);
      return words.every((word) => text.includes(word));
    })
    .toSorted((a, b) => BY[choice.order](a, b) || byId(a, b));
}

/** Text on films without a reliable scale; null if every film has one. */
export function scaleTrouble(study: Study): string | null {
  const without = study.films.filter(({ image }) => image.plane === "pixels").length;
  // The plane of a lateral film does not matter: its scale is found beside the erect film.
  const frontal = study.films.filter((film) => film.posture !== "lateral");
  const unknown = frontal.filter(({ image }) => image.plane === "unknown").length;
  const parts = [
    without ? `no scale on ${without} of ${study.films.length}: angles only` : null,
    unknown ? `scale of an unknown plane on ${unknown} of ${frontal.length}` : null,
  ].filter(Boolean);
  return parts.length ? parts.join("; ") : null;
}

/** Whether results use a reading. */
export const counts = ({ finished, withdrawn }: Api<"ReadingSummary">): boolean =>
  finished && !withdrawn;

/** Whether a study with this status has results, and so a model and a report. */
export const hasResults = (status: Api<"StudyStatus">): boolean =>
  ["modelled", "unsupported", "not_converged", "measured"].includes(status);
