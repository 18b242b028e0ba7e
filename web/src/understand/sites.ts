import { nearest, type CssPoint } from "../measure/viewport";

/** Largest distance of a click that still picks a place. */
const REACH_CSS = 40;

interface Place {
  site: string;
  at: CssPoint;
}

/** The place nearest to a point of the screen; null if all are far. */
export const nearestSite = (places: readonly Place[], point: CssPoint): string | null =>
  nearest(places, ({ at }) => at, point, REACH_CSS)?.site ?? null;
