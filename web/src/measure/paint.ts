import type { Plane, Pyramid } from "./pyramid";
import type { Viewport } from "./viewport";

/** Colour beside the film. */
const BESIDE = 0xff000000;

/** Interpolation along one direction: the lower pixel and the weight of the next one. */
interface Taps {
  readonly first: Int32Array;
  readonly share: Float32Array;
  /** The first device pixel on the film, and the first one after it. */
  readonly from: number;
  readonly until: number;
}

/** Paints the visible part of a film: bilinear interpolation of brightness, then the table of colours. */
export function paint(
  target: ImageData,
  pyramid: Pyramid,
  view: Viewport,
  devicePixelRatio: number,
  table: Uint32Array,
): void {
  const finest = view.scale * devicePixelRatio * Math.max(1, view.aspect);
  const level = pyramid.level(finest);
  const plane = pyramid.levels[level]!;
  const full = pyramid.levels[0]!;
  const across = taps(target.width, {
    start: view.left * devicePixelRatio,
    step: view.scale * devicePixelRatio,
    pixels: full.columns,
    kept: plane.columns,
    factor: 2 ** level,
  });
  const down = taps(target.height, {
    start: view.top * devicePixelRatio,
    step: view.scale * view.aspect * devicePixelRatio,
    pixels: full.rows,
    kept: plane.rows,
    factor: 2 ** level,
  });
  const pixels = new Uint32Array(target.data.buffer);
  pixels.fill(BESIDE);
  for (let y = down.from; y < down.until; y += 1) {
    const row = pixels.subarray(y * target.width, (y + 1) * target.width);
    paintRow(row, plane, across, down.first[y]!, down.share[y]!, table);
  }
}

interface Axis {
  /** Device pixel at which the film begins. */
  readonly start: number;
  /** Device pixels per film pixel. */
  readonly step: number;
  /** Film pixels in this direction. */
  readonly pixels: number;
  /** Pixels of the size of the picture that is read. */
  readonly kept: number;
  /** Film pixels per such pixel. */
  readonly factor: number;
}

function taps(length: number, axis: Axis): Taps {
  const first = new Int32Array(length);
  const share = new Float32Array(length);
  const from = Math.max(0, Math.ceil(axis.start - 0.5));
  const until = Math.min(length, Math.ceil(axis.start + axis.pixels * axis.step - 0.5));
  const last = axis.kept - 1;
  for (let i = from; i < until; i += 1) {
    const at = (i + 0.5 - axis.start) / (axis.step * axis.factor) - 0.5;
    const inside = Math.min(last, Math.max(0, at));
    const below = Math.min(Math.floor(inside), Math.max(0, last - 1));
    first[i] = below;
    share[i] = last === 0 ? 0 : inside - below;
  }
  return { first, share, from, until };
}

function paintRow(
  into: Uint32Array,
  plane: Plane,
  across: Taps,
  row: number,
  down: number,
  table: Uint32Array,
): void {
  const { values, columns } = plane;
  const upper = row * columns;
  const lower = Math.min(row + 1, plane.rows - 1) * columns;
  const right = columns > 1 ? 1 : 0;
  const { first, share, from, until } = across;
  for (let x = from; x < until; x += 1) {
    const column = first[x]!;
    const along = share[x]!;
    const a = values[upper + column]!;
    const b = values[upper + column + right]!;
    const c = values[lower + column]!;
    const d = values[lower + column + right]!;
    const above = a + (b - a) * along;
    const below = c + (d - c) * along;
    into[x] = table[(above + (below - above) * down + 0.5) | 0]!;
  }
}
