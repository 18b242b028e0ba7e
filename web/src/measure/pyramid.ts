/** Brightness of a picture by rows: larger is brighter. */
export interface Plane {
  readonly columns: number;
  readonly rows: number;
  readonly values: Uint16Array;
}

/** Rows that are averaged per step. */
const ROWS_AT_ONCE = 256;
/** Smaller levels are not worth keeping. */
const MIN_SIDE = 64;

/** Halves a picture: the mean of each 2 × 2 pixels; an odd last column or row is averaged with itself. */
export function* halved(plane: Plane): Generator<void, Plane> {
  const columns = Math.ceil(plane.columns / 2);
  const rows = Math.ceil(plane.rows / 2);
  const values = new Uint16Array(columns * rows);
  for (let row = 0; row < rows; row += 1) {
    halveRow(plane, row, values.subarray(row * columns, (row + 1) * columns));
    if (row % ROWS_AT_ONCE === ROWS_AT_ONCE - 1) yield;
  }
  return { columns, rows, values };
}

function halveRow(plane: Plane, row: number, into: Uint16Array): void {
  const { columns, rows, values } = plane;
  const upper = 2 * row * columns;
  const lower = Math.min(2 * row + 1, rows - 1) * columns;
  const last = columns - 1;
  for (let column = 0; column < into.length; column += 1) {
    const left = 2 * column;
    const right = Math.min(left + 1, last);
    const sum =
      values[upper + left]! +
      values[upper + right]! +
      values[lower + left]! +
      values[lower + right]!;
    into[column] = (sum + 2) >> 2;
  }
}

/** A picture in several sizes, each half as wide as the one before. Smaller sizes are added during use. */
export class Pyramid {
  readonly levels: Plane[];

  constructor(picture: Plane) {
    this.levels = [picture];
  }

  /** Builds the smaller sizes, step by step. */
  *build(): Generator<void, void> {
    let plane = this.levels[0]!;
    while (Math.min(plane.columns, plane.rows) > MIN_SIDE) {
      plane = yield* halved(plane);
      this.levels.push(plane);
      yield;
    }
  }

  /** The smallest existing size with at least one pixel per device pixel. */
  level(devicePixelsPerColumn: number): number {
    const wanted = Math.floor(Math.log2(1 / devicePixelsPerColumn));
    return Math.max(0, Math.min(this.levels.length - 1, wanted));
  }
}

/** Runs the steps of a generator in slices, so that the page stays responsive, until the signal is aborted. */
export async function inSlices(steps: Generator<void, void>, signal: AbortSignal): Promise<void> {
  const SLICE_MS = 12;
  for (;;) {
    const until = performance.now() + SLICE_MS;
    while (performance.now() < until) {
      if (signal.aborted || steps.next().done) return;
    }
    await new Promise((resolve) => setTimeout(resolve));
  }
}
