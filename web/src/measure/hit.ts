import { CORNERS, landmarksOf, placeOf, type Landmark, type ReadingView } from "./landmarks";
import { cssOf, filmPoint, type CssPoint, type Viewport } from "./viewport";

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

/** The corner of the proposal nearest to a place on the screen, if it is within reach. */
export function proposedAt(
  reading: ReadingView,
  view: Viewport,
  at: CssPoint,
  reach: number,
): Landmark | null {
  const { proposal } = reading;
  if (!proposal) return null;
  const candidates = CORNERS.map((corner): Landmark => ({
    kind: "corner",
    level: proposal.level,
    corner,
  }));
  return nearest(candidates, at, reach, (landmark) => {
    const px = proposal.corners.find(
      ({ corner }) => landmark.kind === "corner" && corner === landmark.corner,
    )?.px;
    return px ? cssOf(view, filmPoint(px)) : null;
  });
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
