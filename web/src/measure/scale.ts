import type { Api } from "../api/types";
import { fixed } from "../shell/number";

/** The properties of a film that a scale changes. */
type Film = Pick<Api<"FilmSummary">, "row_mm"> & {
  image: Pick<Api<"FilmImage">, "rows" | "pixel_aspect">;
};

/** Mean width of the bodies with four corners, between the middles of their walls; null without any. */
export function meanWidth_mm(
  { row_mm, image }: Film,
  vertebrae: readonly Pick<Api<"VertebraView">, "corners">[],
): number | null {
  if (!row_mm) return null;
  const widths = vertebrae.flatMap(({ corners }) => {
    if (corners.length !== 4) return [];
    const middle = (side: string): [number, number] => {
      const wall = corners.filter(({ corner }) => corner.endsWith(side));
      const mean = (axis: 0 | 1): number =>
        wall.reduce((sum, { px }) => sum + (px[axis] ?? 0), 0) / wall.length;
      return [mean(0), mean(1)];
    };
    const [left, right] = [middle("left"), middle("right")];
    const column_mm = row_mm / image.pixel_aspect;
    return [Math.hypot((right[0] - left[0]) * column_mm, (right[1] - left[1]) * row_mm)];
  });
  if (widths.length === 0) return null;
  return widths.reduce((sum, width) => sum + width, 0) / widths.length;
}

/** The effect of a new scale on a film, such as `0.143 → 0.125 mm per row; film 572 → 500 mm high`. */
export function movedText(
  before: Film,
  after: Film,
  vertebrae: readonly Pick<Api<"VertebraView">, "corners">[],
): string {
  const moved = (was: number | null, is: number | null, digits: number): string => {
    const [from, to] = [was, is].map((mm) => (mm === null ? "unknown" : fixed(mm, digits)));
    return `${from} → ${to} mm`;
  };
  const height = ({ image, row_mm }: Film): number | null => (row_mm ? image.rows * row_mm : null);
  const width = meanWidth_mm(after, vertebrae);
  return [
    `Scale: ${moved(before.row_mm ?? null, after.row_mm ?? null, 4)} per row`,
    `film ${moved(height(before), height(after), 0)} high`,
    ...(width === null
      ? []
      : [`mean body ${moved(meanWidth_mm(before, vertebrae), width, 1)} wide`]),
  ].join("; ");
}

/** Lengths of a scale bar. */
const ROUND_MM: readonly number[] = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
const MAX_CSS = 160;

/** The longest round length whose bar fits the screen; the shortest one if none fits. */
export function barLength_mm(cssPerMm: number): number {
  return ROUND_MM.findLast((length) => length * cssPerMm <= MAX_CSS) ?? 1;
}
