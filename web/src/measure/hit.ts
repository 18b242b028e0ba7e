import {
  CORNERS,
  cornersAt,
  landmarksOf,
  placeOf,
  type Landmark,
  type ReadingView,
} from "./landmarks";
import { proposedPlace, type Proposal } from "./proposals";
import { cssOf, type CssPoint, type FilmPoint, type Viewport } from "./viewport";

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
  return nearest(candidates, at, reach, (landmark) => {
    const place = placeOf(reading, landmark);
    return place && cssOf(view, place);
  });
}

/** The corner of a proposal nearest to a place on the screen, if it is within reach. */
export function proposedAt(
  proposals: readonly Proposal[],
  view: Viewport,
  at: CssPoint,
  reach: number,
): Landmark | null {
  const candidates = proposals.flatMap(({ level }) => cornersAt(level, CORNERS));
  return nearest(candidates, at, reach, (landmark) => {
    const place = placeOfProposed(proposals, landmark);
    return place && cssOf(view, place);
  });
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

function nearest(
  candidates: readonly Landmark[],
  at: CssPoint,
  reach: number,
  placed: (landmark: Landmark) => CssPoint | null,
): Landmark | null {
  let best: Landmark | null = null;
  let closest = reach;
  for (const landmark of candidates) {
    const place = placed(landmark);
    if (!place) continue;
    const distance = Math.hypot(place[0] - at[0], place[1] - at[1]);
    if (distance > closest) continue;
    closest = distance;
    best = landmark;
  }
  return best;
}
