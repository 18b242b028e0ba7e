import { askBytes } from "../api/client";
import { limited, type GreyWindow } from "./grey";
import { Pyramid, inSlices } from "./pyramid";

/** A film's picture, ready to be painted. */
export interface FilmPicture {
  readonly columns: number;
  readonly rows: number;
  readonly aspect: number;
  /** Greatest brightness. */
  readonly max: number;
  /** The window that its file asks for. */
  readonly window: GreyWindow;
  readonly pyramid: Pyramid;
}

/** Films that were seen last stay in memory, so that going back to one needs no second download. */
const KEPT_FILMS = 3;
const kept = new Map<string, FilmPicture>();

/** Loads a picture, or takes the one that is here. Its smaller sizes are built on while it is on the screen. */
export async function loadFilm(
  address: string,
  signal: AbortSignal,
  grown: () => void,
): Promise<FilmPicture> {
  const found = kept.get(address);
  if (found) {
    kept.delete(address);
    kept.set(address, found);
    return found;
  }
  const response = await askBytes(address, signal);
  const picture = pictureOf(response.headers, await response.arrayBuffer());
  void inSlices(picture.pyramid.build(), signal).then(() => {
    if (signal.aborted) return;
    kept.set(address, picture);
    for (const oldest of kept.keys()) {
      if (kept.size <= KEPT_FILMS) break;
      kept.delete(oldest);
    }
    grown();
  });
  return picture;
}

export function pictureOf(headers: Headers, bytes: ArrayBuffer): FilmPicture {
  const number = (name: string): number => {
    const value = Number(headers.get(`x-spineline-${name}`) ?? Number.NaN);
    if (!Number.isFinite(value)) throw new Error(`the picture comes without its ${name}`);
    return value;
  };
  const [columns, rows] = [number("columns"), number("rows")];
  if (columns < 1 || rows < 1 || bytes.byteLength !== 2 * columns * rows) {
    throw new Error(
      `the picture of ${columns} × ${rows} pixels has ${bytes.byteLength} bytes instead of ${2 * columns * rows}; reload the page`,
    );
  }
  const values = new Uint16Array(bytes);
  // A value beyond the stated greatest one would have no grey.
  const max = Math.min(65_535, Math.max(1, number("max"), greatest(values)));
  const window = { centre: number("window-center"), width: number("window-width") };
  return {
    columns,
    rows,
    aspect: number("pixel-aspect"),
    max,
    window: limited(window, max),
    pyramid: new Pyramid({ columns, rows, values }),
  };
}

function greatest(values: Uint16Array): number {
  let most = 0;
  for (let i = 0; i < values.length; i += 1) if (values[i]! > most) most = values[i]!;
  return most;
}
