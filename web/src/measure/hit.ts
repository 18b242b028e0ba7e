import { CORNERS, marksOf, placeOf, type Mark, type ReadingView } from "./marks";
import { cssOf, filmPoint, type CssPoint, type Viewport } from "./viewport";

/** The landmark nearest to a place on the screen, if it is within reach; axes only of the current vertebra. */
export function markAt(
  reading: ReadingView,
  view: Viewport,
  at: CssPoint,
  reach: number,
  axisOf: string | null,
): Mark | null {
  const candidates = marksOf(reading).filter(
    (mark) => mark.kind !== "axis" || mark.level === axisOf,
  );
  return nearest(candidates, at, reach, (mark) => {
    const place = placeOf(reading, mark);
    return place && cssOf(view, place);
  });
}

/** The corner of the proposal nearest to a place on the screen, if it is within reach. */
export function proposedAt(
  reading: ReadingView,
  view: Viewport,
  at: CssPoint,
  reach: number,
): Mark | null {
  const { proposal } = reading;
  if (!proposal) return null;
  const candidates = CORNERS.map((corner): Mark => ({
    kind: "corner",
    level: proposal.level,
    corner,
  }));
  return nearest(candidates, at, reach, (mark) => {
    const px = proposal.corners.find(
      ({ corner }) => mark.kind === "corner" && corner === mark.corner,
    )?.px;
    return px ? cssOf(view, filmPoint(px)) : null;
  });
}

function nearest(
  candidates: readonly Mark[],
  at: CssPoint,
  reach: number,
  placed: (mark: Mark) => CssPoint | null,
): Mark | null {
  let best: Mark | null = null;
  let closest = reach;
  for (const mark of candidates) {
    const place = placed(mark);
    if (!place) continue;
    const distance = Math.hypot(place[0] - at[0], place[1] - at[1]);
    if (distance > closest) continue;
    closest = distance;
    best = mark;
  }
  return best;
}
