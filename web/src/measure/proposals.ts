import type { Api } from "../api/types";
import { lasting } from "../shell/storage.svelte";
import type { Corner, Event, Landmark, ReadingView } from "./landmarks";
import { filmPoint, type FilmPoint } from "./viewport";

export type Proposal = Api<"Proposal">;

/** How vertebrae are marked: by four corners, or by the midpoints of both walls. */
export type Way = "corners" | "walls";

const WAY = "spineline.marking-way";

/** The way that was taken last in this browser. */
export const lastWay = (): Way => (lasting.get(WAY) === "walls" ? "walls" : "corners");

export function keepWay(way: Way): void {
  lasting.set(WAY, way);
}

/** The program's proposal for a level. */
export function proposalOf(reading: ReadingView, level: string): Proposal | null {
  return reading.proposals.find((proposal) => proposal.level === level) ?? null;
}

/** Place of a proposed corner. */
export function proposedPlace(proposal: Proposal, corner: Corner): FilmPoint | null {
  const px = proposal.corners.find((one) => one.corner === corner)?.px;
  return px ? filmPoint(px) : null;
}

/**
 * The proposals to draw and to accept: those of vertebrae with both walls, and without walls that of the next vertebra.
 * A vertebra with a corner has none.
 */
export function shownProposals(
  reading: ReadingView,
  target: Landmark | null,
  way: Way,
): readonly Proposal[] {
  const shown = reading.proposals.filter(({ level }) => {
    const vertebra = reading.vertebrae.find((one) => one.level === level);
    if (vertebra && vertebra.corners.length > 0) return false;
    if (way === "walls") return vertebra?.walls.left_px != null && vertebra.walls.right_px != null;
    return target?.kind === "corner" && target.level === level;
  });
  return shown;
}

/** The event that accepts proposals. */
export function accepting(proposals: readonly Proposal[]): Event {
  const vertebrae = proposals.map(({ level, corners }) => ({
    level,
    corners: Object.fromEntries(
      corners.map(({ corner, px }): [string, [number, number]] => [corner, [px[0]!, px[1]!]]),
    ),
  }));
  return { kind: "accept_corners", vertebrae };
}
