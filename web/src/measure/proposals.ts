import { detectVertebrae } from "../api/readings";
import type { Api } from "../api/types";
import { lasting } from "../shell/storage.svelte";
import { levelBeside, type Corner, type Event, type Landmark, type ReadingView } from "./landmarks";
import type { Trouble } from "./lost";
import { filmPoint, type FilmPoint } from "./viewport";

export type Proposal = Api<"Proposal">;

/** How vertebrae are marked: by four corners or by the midpoints of both walls; or their pedicles. */
export type Way = "corners" | "walls" | "pedicles";

export const WAY_WORDS: Record<Way, string> = {
  corners: "four clicks per vertebra",
  walls: "two clicks per vertebra",
  pedicles: "two pedicles per vertebra",
};

const WAY = "spineline.marking-way";

/** The last way in this browser. */
export const lastWay = (): Way => (lasting.get(WAY) === "walls" ? "walls" : "corners");

export function keepWay(way: Way): void {
  if (way !== "pedicles") lasting.set(WAY, way);
}

/** Whether vertebrae may be proposed: not where a plan forbids it, nor on the lateral film. */
export const canPropose = ({ proposals_allowed, image }: ReadingView): boolean =>
  proposals_allowed && !image.is_lateral;

/** The program's proposal for a level. */
export function proposalOf(reading: ReadingView, level: string): Proposal | null {
  return reading.proposals.find((proposal) => proposal.level === level) ?? null;
}

/** Place of a proposed corner. */
export function proposedPlace(proposal: Proposal, corner: Corner): FilmPoint | null {
  const px = proposal.corners.find((one) => one.corner === corner)?.px;
  return px ? filmPoint(px) : null;
}

/** The proposals of vertebrae without a corner. */
export function openProposals(reading: ReadingView, found: readonly Proposal[]): Proposal[] {
  const of = (level: string) => reading.vertebrae.find((one) => one.level === level);
  const hasWall = (level: string): boolean => {
    const walls = of(level)?.walls;
    return walls?.left_px != null || walls?.right_px != null;
  };
  // Proposals from the reader's landmarks are better than from the picture, whose levels may be
  // shifted: never both.
  const all =
    reading.proposals.length > 0 ? reading.proposals : found.filter(({ level }) => !hasWall(level));
  return all.filter(({ level }) => (of(level)?.corners.length ?? 0) === 0);
}

/**
 * The proposals that one key accepts: of all vertebrae whose walls the reader has marked, else only of the next
 * vertebra. Without its walls a vertebra is proposed for two clicks only on request.
 */
export function acceptable(
  reading: ReadingView,
  open: readonly Proposal[],
  target: Landmark | null,
  { way, onRequest }: { way: Way; onRequest: boolean },
): Proposal[] {
  if (way === "walls") {
    const walled = open.filter(({ level }) => {
      const walls = reading.vertebrae.find((one) => one.level === level)?.walls;
      return walls?.left_px != null && walls.right_px != null;
    });
    if (walled.length > 0 || !onRequest) return walled;
  }
  return open.filter(({ level }) => target && "level" in target && target.level === level);
}

/** The found vertebrae, each at the level above or below; those beyond the known levels are left out. */
export const shifted = (
  found: readonly Proposal[],
  reading: ReadingView,
  up: boolean,
): Proposal[] =>
  found.flatMap((proposal) => {
    const level = levelBeside(reading, proposal.level, up);
    return level ? [{ ...proposal, level }] : [];
  });

/** The event that accepts proposals. */
export function accepting(proposals: readonly Proposal[]): Event {
  const vertebrae = proposals.map(({ level, corners, sd_share }) => ({
    level,
    ...(sd_share == null ? {} : { sd_share }),
    corners: Object.fromEntries(
      corners.map(({ corner, px }): [string, [number, number]] => [corner, [px[0]!, px[1]!]]),
    ),
  }));
  return { kind: "accept_corners", vertebrae };
}

/** The vertebrae that the program finds in the picture, with its doubts. */
export async function detected(
  reading: number,
): Promise<{ found: Proposal[]; doubt: string | null; trouble: Trouble | null }> {
  const what = "No vertebrae found in the picture";
  try {
    const { proposals, refused, doubt } = await detectVertebrae(reading);
    const trouble = refused ? { what, error: refused } : null;
    return { found: proposals, doubt: doubt ?? null, trouble };
  } catch (error) {
    return { found: [], doubt: null, trouble: { what, error } };
  }
}
