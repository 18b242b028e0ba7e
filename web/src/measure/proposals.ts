import { detectVertebrae, findMisfits } from "../api/readings";
import type { Api } from "../api/types";
import { lasting } from "../shell/storage.svelte";
import { clarity, leftWords } from "./found";
import {
  levelBeside,
  placing,
  withEvents,
  type Corner,
  type Event,
  type Landmark,
  type ReadingView,
} from "./landmarks";
import type { Trouble } from "./lost";
import type { Marking } from "./marking.svelte";
import type { Message } from "./messages";
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

/** The last way in this browser; at first two clicks where the erect film completes the vertebrae. */
export function lastWay({ erect }: ReadingView): Way {
  const last = lasting.get(WAY);
  return last === "walls" || (last === null && erect != null) ? "walls" : "corners";
}

export function keepWay(way: Way): void {
  if (way !== "pedicles") lasting.set(WAY, way);
}

/** Whether vertebrae may be proposed: not where a plan forbids it, nor on the lateral film. */
export const canPropose = ({ proposals_allowed, image }: ReadingView): boolean =>
  proposals_allowed && !image.is_lateral;

/** Place of a proposed corner. */
export function proposedPlace(proposal: Proposal, corner: Corner): FilmPoint | null {
  const px = proposal.corners.find((one) => one.corner === corner)?.px;
  return px ? filmPoint(px) : null;
}

/** The proposals of vertebrae without a corner: from the picture or from landmarks, where both exist the surer one. */
export function openProposals(reading: ReadingView, found: readonly Proposal[]): Proposal[] {
  const of = (level: string) => reading.vertebrae.find((one) => one.level === level);
  const isOpen = ({ level }: Proposal): boolean => (of(level)?.corners.length ?? 0) === 0;
  // A click on a vertebra replaces the one found there.
  const isUnclicked = ({ level }: Proposal): boolean => {
    const walls = of(level)?.walls;
    return walls?.left_px == null && walls?.right_px == null;
  };
  const all = [...found.filter(isUnclicked), ...reading.proposals].filter(isOpen);
  const surestFirst = all.toSorted((a, b) => a.sd_percent - b.sd_percent);
  return all.filter((one) => surestFirst.find(({ level }) => level === one.level) === one);
}

/**
 * The proposals that one key accepts: the sure ones, the clearly found ones and all whose walls the reader has marked,
 * else only the proposal of the next vertebra. Without its walls a vertebra is proposed for two clicks only on request.
 */
export function acceptable(
  reading: ReadingView,
  open: readonly Proposal[],
  target: Landmark | null,
  { way, onRequest }: { way: Way; onRequest: boolean },
): Proposal[] {
  const ready = open.filter((proposal) => {
    const walls = reading.vertebrae.find(({ level }) => level === proposal.level)?.walls;
    return (
      proposal.is_sure || (way === "walls" && walls?.left_px != null && walls.right_px != null)
    );
  });
  if (ready.length > 0 || (way === "walls" && !onRequest)) return ready;
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

/** A landmark dragged to a place: a corner of a proposal accepts its other three corners too. */
export function dragged(
  recorded: ReadingView,
  drawn: ReadingView,
  open: readonly Proposal[],
  landmark: Landmark,
  at: FilmPoint,
): Event[] {
  const proposal = "level" in landmark && open.find(({ level }) => level === landmark.level);
  if (landmark.kind !== "corner" || !proposal) return [placing(drawn, landmark, at)];
  const accepted = accepting([proposal]);
  return [accepted, placing(withEvents(recorded, [accepted]), landmark, at)];
}

/** Vertebrae in the picture, and how sure their levels are. */
type Detected = Readonly<Omit<Api<"DetectionView">, "refused"> & { trouble: Trouble | null }>;

export const UNSEEN: Detected = {
  proposals: [],
  levels: "",
  are_levels_doubtful: false,
  remarks: [],
  trouble: null,
};

/** The vertebrae that the program finds in the picture. */
export async function detected(reading: number): Promise<Detected> {
  const what = "No vertebrae found in the picture";
  try {
    const { refused, ...view } = await detectVertebrae(reading);
    return { ...view, trouble: refused ? { what, error: refused } : null };
  } catch (error) {
    return { ...UNSEEN, trouble: { what, error } };
  }
}

/** The sure proposals that the picture contradicts; without an answer their stated deviation counts. */
export async function misfits(reading: number, proposals: readonly Proposal[]): Promise<string[]> {
  if (!proposals.some((proposal) => proposal.is_sure && clarity(proposal) === null)) return [];
  return findMisfits(reading).then(
    ({ levels }) => levels,
    () => [],
  );
}

/** Messages on proposals, while they are drawn. */
export function aboutProposals(
  marking: Pick<Marking, "detection" | "offer" | "proposals" | "misfits">,
): Message[] {
  const { detection, offer, proposals, misfits } = marking;
  const { levels, are_levels_doubtful, remarks } = detection;
  // If the levels are doubtful, outlines and list alone show what to check.
  const left = offer || are_levels_doubtful ? "" : leftWords(proposals);
  const help = "U names all vertebrae one level up, J one level down.";
  const told: (Message | false)[] = [
    misfits.length > 0 && {
      severity: "warning",
      text: `${misfits.join(", ")}: the picture has other edges; click the walls`,
    },
    levels !== "" &&
      (are_levels_doubtful && !offer?.isSlow
        ? { severity: "warning", text: `Check the levels first (U, J): ${levels}`, help }
        : { severity: "note", text: `Levels: ${levels}` }),
    left !== "" && { severity: "note", text: left },
    ...remarks.map((text): Message => ({ severity: "note", text })),
  ];
  return told.filter((one) => one !== false);
}
