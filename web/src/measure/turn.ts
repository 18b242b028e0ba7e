/** Number of clockwise quarter turns. */
type Quarters = 0 | 1 | 2 | 3;

/** How a film is turned on the screen, for display only: first mirrored left to right, then turned. */
export interface Turn {
  readonly mirrored: boolean;
  readonly quarters: Quarters;
}

/** A direction along an axis of the screen. */
export type Direction = readonly [x: number, y: number];

/** As the film is stored. */
export const UPRIGHT: Turn = { mirrored: false, quarters: 0 };

const quartersOf = (count: number): Quarters => (((count % 4) + 4) % 4) as Quarters;

/** A quarter of a turn clockwise, on the screen. */
export const clockwise = ({ mirrored, quarters }: Turn): Turn => ({
  mirrored,
  quarters: quartersOf(quarters + 1),
});

/** Left and right of the screen exchanged. */
export const flipped = ({ mirrored, quarters }: Turn): Turn => ({
  mirrored: !mirrored,
  quarters: quartersOf(-quarters),
});

/** Where growing columns and growing rows lead on the screen. */
export function axesOf({ mirrored, quarters }: Turn): { columns: Direction; rows: Direction } {
  const turned = (direction: Direction): Direction => {
    let [x, y] = direction;
    // Positive zero: tests distinguish a negative one.
    for (let i = 0; i < quarters; i += 1) [x, y] = [0 - y, x];
    return [x, y];
  };
  return { columns: turned([mirrored ? -1 : 1, 0]), rows: turned([0, 1]) };
}

/** Whether rows of the film are columns of the screen. */
export const isOnItsSide = ({ quarters }: Turn): boolean => quarters % 2 === 1;

/** A text about a film that is not shown as stored; else null. */
export function turnText({ mirrored, quarters }: Turn): string | null {
  const turned = ["", "turned 90° clockwise", "turned 180°", "turned 90° anticlockwise"][quarters];
  const words = [mirrored ? "mirrored" : "", turned].filter(Boolean).join(", then ");
  return words === "" ? null : `Shown ${words}. Left, right and landmarks stay the patient’s.`;
}
