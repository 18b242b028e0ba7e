import type { Api } from "../api/types";
import { at, type Point } from "../model/shapes";

/** Length of the strongest arrow. */
const ARROW_MM = 55;
const HEAD_MM = 6;
/** Distance of a number from the free end of its arrow. */
const NUMBER_MM = 9;

/** An arrow in space; a pad's arrow ends at its vertebra. Null for moments and without a force. */
export function endsOf(
  arrow: Api<"LoadArrow">,
  isPad: boolean,
): { from: Point; tip: Point } | null {
  const size = Math.hypot(...arrow.vector);
  if (arrow.is_moment || size === 0) return null;
  const part = (isPad ? -1 : 1) * arrow.part * ARROW_MM;
  const free = arrow.point_mm.map(
    (value, i) => value + (part * at(arrow.vector, i)) / size,
  ) as Point;
  const point = arrow.point_mm as Point;
  return isPad ? { from: free, tip: point } : { from: point, tip: free };
}

/** The same in a frontal picture, with its head and the place of its number; null if it is seen end on. */
export function arrowOf(arrow: Api<"LoadArrow">, isPad: boolean, sign: 1 | -1) {
  const ends = endsOf(arrow, isPad);
  if (!ends) return null;
  const [x1, y1, x2, y2] = [
    sign * ends.from[1],
    -ends.from[2],
    sign * ends.tip[1],
    -ends.tip[2],
  ] as const;
  const flat = Math.hypot(x2 - x1, y2 - y1);
  if (flat < 0.5) return null;
  const [ux, uy] = [(x2 - x1) / flat, (y2 - y1) / flat];
  const side = (s: number): string =>
    `${x2 - HEAD_MM * ux - (s * HEAD_MM * uy) / 2},${y2 - HEAD_MM * uy + (s * HEAD_MM * ux) / 2}`;
  const free = isPad
    ? { x: x1 - NUMBER_MM * ux, y: y1 - NUMBER_MM * uy }
    : { x: x2 + NUMBER_MM * ux, y: y2 + NUMBER_MM * uy };
  return { x1, y1, x2, y2, head: `${x2},${y2} ${side(1)} ${side(-1)}`, free };
}
