import type { Wanted } from "../understand/apart";
import type { VertebraView } from "./landmarks";
import { cssOf, filmPoint, type CssPoint, type Viewport } from "./viewport";

/** Size of the names of vertebrae on the film. */
export const NAME_PX = 12;

/** The right side of a body on the screen, beside which its name stands. */
export function besideBody(corners: VertebraView["corners"], view: Viewport): CssPoint {
  const places = corners.map(({ px }) => cssOf(view, filmPoint(px)));
  const x = Math.max(...places.map((place) => place[0]));
  const y = places.reduce((sum, place) => sum + place[1], 0) / places.length;
  return [x, y];
}

/** The names of marked vertebrae, as texts that others must not cover. */
export const levelNames = (vertebrae: readonly VertebraView[], view: Viewport): Wanted[] =>
  vertebrae
    .filter(({ corners }) => corners.length > 0)
    .map(({ level, corners }) => ({
      text: level,
      at: besideBody(corners, view),
      size_px: NAME_PX,
      side: "right",
    }));
