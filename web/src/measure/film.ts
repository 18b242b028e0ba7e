import { askBytes } from "../api/client";
import type { Api } from "../api/types";
import { limited, type GreyWindow } from "./grey";
import { Pyramid, inSlices } from "./pyramid";

/** Decoded picture of a film. */
export interface FilmPicture {
  readonly columns: number;
  readonly rows: number;
  readonly aspect: number;
  /** Maximum brightness. */
  readonly max: number;
  /** The first window: the file's first one, or the whole range without one. */
  readonly window: GreyWindow;
  /** All windows that a DICOM file has. */
  readonly fileWindows: readonly GreyWindow[];
  readonly pyramid: Pyramid;
}

/** The picture of a film without an open reading. */
export function imageOf(film: Api<"FilmSummary">): Api<"ReadingImage"> {
  const { columns, rows, pixel_aspect, patient_left, plane, spacing_text, inverted } = film;
  const is_lateral = film.posture === "lateral";
  return { columns, rows, pixel_aspect, is_lateral, patient_left, plane, spacing_text, inverted };
}

/** The last films stay in memory, so that they need no second download. */
const KEPT_FILMS = 3;
const kept = new Map<string, FilmPicture>();

/** Loads a picture or returns the one in memory. Its smaller sizes are built while it is shown. */
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
    if (!Number.isFinite(value))
      throw new Error(`the response with the picture lacks ${name}; reload the page`);
    return value;
  };
  const [columns, rows] = [number("columns"), number("rows")];
  if (columns < 1 || rows < 1 || bytes.byteLength !== 2 * columns * rows) {
    throw new Error(
      `the picture of ${columns} × ${rows} pixels has ${bytes.byteLength} bytes instead of ${2 * columns * rows}; reload the page`,
    );
  }
  const values = new Uint16Array(bytes);
  // A value above the stated maximum would lack a grey level.
  const max = Math.min(65_535, Math.max(1, number("max"), greatest(values)));
  const window = { centre: number("window-center"), width: number("window-width") };
  return {
    columns,
    rows,
    aspect: number("pixel-aspect"),
    max,
    window: limited(window, max),
    fileWindows: fileWindows(headers).map((one) => limited(one, max)),
    pyramid: new Pyramid({ columns, rows, values }),
  };
}

/** Centre and width of each window, such as `2048 4096, 2600 1200`. */
function fileWindows(headers: Headers): GreyWindow[] {
  const text = headers.get("x-spineline-file-windows") ?? "";
  return text.split(",").flatMap((window) => {
    const [centre, width] = window.trim().split(" ").map(Number);
    const isWindow = Number.isFinite(centre) && Number.isFinite(width);
    return isWindow ? [{ centre: centre!, width: width! }] : [];
  });
}

function greatest(values: Uint16Array): number {
  let most = 0;
  for (let i = 0; i < values.length; i += 1) if (values[i]! > most) most = values[i]!;
  return most;
}
