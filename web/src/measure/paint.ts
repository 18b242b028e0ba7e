import type { Plane, Pyramid } from "./pyramid";
import { axesOf } from "./turn";
import type { Viewport } from "./viewport";

/** Colour beside the film. */
const BESIDE = 0xff000000;

/** Interpolation along one direction of the screen: the place of the lower pixel, and the weight of the next one. */
interface Taps {
  readonly first: Int32Array;
  readonly share: Float32Array;
  /** From a pixel to the next one. */
  readonly next: number;
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
  const factor = 2 ** level;
  const { columns, rows } = axesOf(view.turn);
  const step = view.scale * devicePixelRatio;
  const alongColumns = {
    pixels: full.columns,
    kept: plane.columns,
    factor,
    stride: 1,
    step: step * (columns[0] + columns[1]),
  };
  const alongRows = {
    pixels: full.rows,
    kept: plane.rows,
    factor,
    stride: plane.columns,
    step: step * view.aspect * (rows[0] + rows[1]),
  };
  const [across, down] = columns[0] === 0 ? [alongRows, alongColumns] : [alongColumns, alongRows];
  const over = taps(target.width, { ...across, start: view.left * devicePixelRatio });
  const below = taps(target.height, { ...down, start: view.top * devicePixelRatio });
  const pixels = new Uint32Array(target.data.buffer);
  pixels.fill(BESIDE);
  for (let y = below.from; y < below.until; y += 1) {
    const row = pixels.subarray(y * target.width, (y + 1) * target.width);
    paintRow(
      row,
      plane,
      over,
      { upper: below.first[y]!, next: below.next, share: below.share[y]! },
      table,
    );
  }
}

interface Axis {
  /** Device pixel at which the film begins. */
  readonly start: number;
  /** Device pixels per film pixel; negative where the film grows to the left or upwards. */
  readonly step: number;
  /** Film pixels in this direction. */
  readonly pixels: number;
  /** Pixels of the size of the picture that is read. */
  readonly kept: number;
  /** Film pixels per such pixel. */
  readonly factor: number;
  /** From a pixel to the next one in this direction. */
  readonly stride: number;
}

function taps(length: number, axis: Axis): Taps {
  const first = new Int32Array(length);
  const share = new Float32Array(length);
  const end = axis.start + axis.pixels * axis.step;
  const from = Math.max(0, Math.ceil(Math.min(axis.start, end) - 0.5));
  const until = Math.min(length, Math.ceil(Math.max(axis.start, end) - 0.5));
  const last = axis.kept - 1;
  for (let i = from; i < until; i += 1) {
    const at = (i + 0.5 - axis.start) / (axis.step * axis.factor) - 0.5;
    const inside = Math.min(last, Math.max(0, at));
    const below = Math.min(Math.floor(inside), Math.max(0, last - 1));
    first[i] = below * axis.stride;
    share[i] = last === 0 ? 0 : inside - below;
  }
  return { first, share, next: last === 0 ? 0 : axis.stride, from, until };
}

function paintRow(
  into: Uint32Array,
  { values }: Plane,
  across: Taps,
  down: { upper: number; next: number; share: number },
  table: Uint32Array,
): void {
  const { upper, next: under, share: weight } = down;
  const { first, share, next, from, until } = across;
  for (let x = from; x < until; x += 1) {
    const at = upper + first[x]!;
    const along = share[x]!;
    const a = values[at]!;
    const b = values[at + next]!;
    const c = values[at + under]!;
    const d = values[at + under + next]!;
    const above = a + (b - a) * along;
    const below = c + (d - c) * along;
    into[x] = table[(above + (below - above) * weight + 0.5) | 0]!;
  }
}
