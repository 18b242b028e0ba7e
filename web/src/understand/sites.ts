/** Largest distance of a click that still picks a place. */
const REACH_CSS = 40;

interface Place {
  site: string;
  at: readonly [number, number];
}

/** The place nearest to a point of the screen; null if all are far. */
export function nearestSite(places: Place[], [x, y]: readonly [number, number]): string | null {
  let found: string | null = null;
  let least = REACH_CSS;
  for (const { site, at } of places) {
    const far = Math.hypot(at[0] - x, at[1] - y);
    if (far < least) [found, least] = [site, far];
  }
  return found;
}
