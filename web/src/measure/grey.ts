import type { Plane } from "./pyramid";

/** Displayed range of brightness: from black at `centre - width / 2` to white at `centre + width / 2`. */
export interface GreyWindow {
  readonly centre: number;
  readonly width: number;
}

const OPAQUE = 0xff000000;

/** Colour of every brightness up to `max` in the byte order of the canvas (red in the lowest byte). */
export function greyTable(window: GreyWindow, inverted: boolean, max: number): Uint32Array {
  const table = new Uint32Array(max + 1);
  const lowest = window.centre - window.width / 2;
  for (let value = 0; value <= max; value += 1) {
    const share = Math.min(1, Math.max(0, (value - lowest) / window.width));
    const grey = Math.round(255 * (inverted ? 1 - share : share));
    table[value] = (OPAQUE | (grey << 16) | (grey << 8) | grey) >>> 0;
  }
  return table;
}

/** Limits a window: at least one percent of the range wide, and with its centre inside the range. */
export function limited(window: GreyWindow, max: number): GreyWindow {
  const width = Math.min(2 * max, Math.max(max / 100, 1, window.width));
  return { width, centre: Math.min(max, Math.max(0, window.centre)) };
}

/** Moves and widens a window by fractions of the film's range. */
export function adjusted(
  window: GreyWindow,
  change: { brighter: number; wider: number },
  max: number,
): GreyWindow {
  return limited(
    {
      centre: window.centre - change.brighter * max,
      width: window.width + change.wider * max,
    },
    max,
  );
}

/** The window from the darkest to the brightest percent of the picture. */
export const windowOfPicture = (plane: Plane, max: number): GreyWindow =>
  windowOfShares(plane, [0.01, 0.99], max);

/** The window between two parts of the pixels, in the order of their brightness. */
export function windowOfShares(
  { values }: Plane,
  [darker, brighter]: readonly [number, number],
  max: number,
): GreyWindow {
  const counts = new Uint32Array(max + 1);
  for (const value of values) counts[Math.min(max, value)]! += 1;
  const darkest = valueAt(counts, darker * values.length);
  const brightest = valueAt(counts, brighter * values.length);
  return limited({ centre: (darkest + brightest) / 2, width: brightest - darkest }, max);
}

/**
 * The window of a square part of a picture, which shows details that are hardly visible in the window of the whole; at
 * least an eighth as wide as that one, so that it does not show only noise.
 */
export function windowOfPart(
  { columns, rows, values }: Plane,
  [column, row]: readonly [number, number],
  reach: number,
  whole: GreyWindow,
  max: number,
): GreyWindow {
  const bound = (at: number, last: number): number => Math.min(last, Math.max(0, Math.round(at)));
  const [left, right] = [bound(column - reach, columns - 1), bound(column + reach, columns - 1)];
  const [top, bottom] = [bound(row - reach, rows - 1), bound(row + reach, rows - 1)];
  const wide = right - left + 1;
  const part = new Uint16Array(wide * (bottom - top + 1));
  for (let y = top; y <= bottom; y += 1)
    part.set(values.subarray(y * columns + left, y * columns + right + 1), (y - top) * wide);
  const { centre, width } = windowOfPicture({ columns: part.length, rows: 1, values: part }, max);
  return { centre, width: Math.max(width, whole.width / 8) };
}

/** The value that `below` pixels do not reach. */
function valueAt(counts: Uint32Array, below: number): number {
  let seen = 0;
  for (let value = 0; value < counts.length; value += 1) {
    seen += counts[value]!;
    if (seen > below) return value;
  }
  return counts.length - 1;
}
