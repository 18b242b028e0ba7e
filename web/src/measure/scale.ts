/** Lengths that a scale bar may stand for. */
const ROUND_MM: readonly number[] = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
const LONGEST_CSS = 160;

/** The longest round length whose bar is not too long for the screen; the shortest one where all are. */
export function barLength_mm(cssPerMm: number): number {
  return ROUND_MM.findLast((length) => length * cssPerMm <= LONGEST_CSS) ?? 1;
}
