import {
  CORNERS,
  cornersAt,
  landmarksOf,
  placeOf,
  type Landmark,
  type ReadingView,
} from "./landmarks";
import { proposedPlace, type Proposal } from "./proposals";
import { cssOf, nearest, type CssPoint, type FilmPoint, type Viewport } from "./viewport";

/** The landmark nearest to a place on the screen, if it is within reach; axes only of the current vertebra. */
export function landmarkAt(
  reading: ReadingView,
  view: Viewport,
  at: CssPoint,
  reach: number,
  axisOf: string | null,
): Landmark | null {
  const candidates = landmarksOf(reading).filter(
    (landmark) => landmark.kind !== "axis" || landmark.level === axisOf,
  );
  const placed = (landmark: Landmark) => seen(view, placeOf(reading, landmark));
  return nearest(candidates, placed, at, reach);
}

/** The corner of a proposal nearest to a place on the screen, if it is within reach. */
export function proposedAt(
  proposals: readonly Proposal[],
  view: Viewport,
  at: CssPoint,
  reach: number,
): Landmark | null {
  const candidates = proposals.flatMap(({ level }) => cornersAt(level, CORNERS));
  const placed = (landmark: Landmark) => seen(view, placeOfProposed(proposals, landmark));
  return nearest(candidates, placed, at, reach);
}

/** Place of a proposed corner. */
export function placeOfProposed(
  proposals: readonly Proposal[],
  landmark: Landmark,
): FilmPoint | null {
  if (landmark.kind !== "corner") return null;
  const proposal = proposals.find(({ level }) => level === landmark.level);
  return proposal ? proposedPlace(proposal, landmark.corner) : null;
}

const seen = (view: Viewport, place: FilmPoint | null): CssPoint | null =>
  place && cssOf(view, place);
