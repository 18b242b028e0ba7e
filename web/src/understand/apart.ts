import type { CssPoint, Size } from "../measure/viewport";

/** A text beside its object on the film. */
export interface Wanted {
  text: string;
  /** The object. */
  at: CssPoint;
  size_px: number;
  /** Side of the object on which the text stands, if there is room. */
  side: "left" | "right";
}

/** Where a text is drawn: its end and its base line. */
interface Placed {
  x: number;
  y: number;
  anchor: "start" | "end";
}

interface Box {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

const GAP_PX = 9;
/** Mean width of a letter, as a part of the size of the font. */
const LETTER = 0.6;
/** Rows that are tried, the nearest to the object first. */
const ROWS = [0, 1, -1, 2, -2, 3, -3];

/**
 * Places of texts so that none covers an earlier one: the first texts have the first choice. If all places are taken, a
 * text stands at its first one. Some texts are drawn already, at their first place.
 */
export function apart(
  wanted: readonly Wanted[],
  view: Size,
  drawn: readonly Wanted[] = [],
): Placed[] {
  const taken: Box[] = drawn.map((one) => placesOf(one)[0]!.box);
  return wanted.map((one) => {
    const choices = placesOf(one);
    const best =
      choices.find(({ box }) => isInside(box, view) && !taken.some((other) => meet(box, other))) ??
      choices.find(({ box }) => isInside(box, view)) ??
      choices[0]!;
    taken.push(best.box);
    return best.placed;
  });
}

function placesOf({ text, at: [x, y], size_px, side }: Wanted): { placed: Placed; box: Box }[] {
  const width = text.length * LETTER * size_px;
  const sides = side === "right" ? (["start", "end"] as const) : (["end", "start"] as const);
  return ROWS.flatMap((row) =>
    sides.map((anchor) => {
      const end = anchor === "start" ? x + GAP_PX : x - GAP_PX;
      const middle = y + row * 1.25 * size_px;
      const left = anchor === "start" ? end : end - width;
      return {
        placed: { x: end, y: middle + size_px / 3, anchor },
        box: {
          left,
          right: left + width,
          top: middle - 0.6 * size_px,
          bottom: middle + 0.6 * size_px,
        },
      };
    }),
  );
}

const isInside = (box: Box, view: Size): boolean => box.left >= 0 && box.right <= view.width;

const meet = (a: Box, b: Box): boolean =>
  a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
