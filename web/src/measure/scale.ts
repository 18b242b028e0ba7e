/** Lengths of a scale bar. */
const ROUND_MM: readonly number[] = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
const MAX_CSS = 160;

/** The longest round length whose bar fits the screen; the shortest one if none fits. */
export function barLength_mm(cssPerMm: number): number {
  return ROUND_MM.findLast((length) => length * cssPerMm <= MAX_CSS) ?? 1;
}
