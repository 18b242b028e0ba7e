import { askBytes } from "../api/client";
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

/** The last films stay in memory, so that they need no second download: six films of 60 million pixels. */
const KEPT_BYTES = 1e9;
const kept = new Map<string, FilmPicture>();

/** With its smaller sizes, a third more. */
const bytesOf = ({ columns, rows }: FilmPicture): number => (8 / 3) * columns * rows;

interface FilmProgress {
  /** The picture has another size to draw. */
  grown: () => void;
  /** Part of the picture that has arrived, from 0 to 1. */
  arrived?: (part: number) => void;
}

/** Loads a picture or returns the one in memory. Its smaller sizes are built while it is shown. */
export async function loadFilm(
  address: string,
  signal: AbortSignal,
  { grown, arrived }: FilmProgress,
): Promise<FilmPicture> {
  const found = kept.get(address);
  if (found) {
    kept.delete(address);
    kept.set(address, found);
    return found;
  }
  const response = await askBytes(address, signal);
  const picture = pictureOf(response.headers, await received(response, arrived));
  void inSlices(picture.pyramid.build(), signal).then(() => {
    if (signal.aborted) return;
    kept.set(address, picture);
    let bytes = [...kept.values()].reduce((sum, one) => sum + bytesOf(one), 0);
    for (const [oldest, film] of kept) {
      if (bytes <= KEPT_BYTES || film === picture) break;
      kept.delete(oldest);
      bytes -= bytesOf(film);
    }
    grown();
  });
  return picture;
}

function numberIn(headers: Headers, name: string): number {
  const value = Number(headers.get(`x-spineline-${name}`) ?? Number.NaN);
  if (!Number.isFinite(value))
    throw new Error(`the response with the picture lacks ${name}; reload the page`);
  return value;
}

/** Bytes of a picture: one for each pixel where its values need no more, else two. */
const sizeOf = (headers: Headers): number =>
  (numberIn(headers, "max") > 255 ? 2 : 1) *
  numberIn(headers, "columns") *
  numberIn(headers, "rows");

/** The bytes of a picture, as they arrive. */
async function received(response: Response, arrived?: (part: number) => void): Promise<Uint8Array> {
  const bytes = new Uint8Array(sizeOf(response.headers));
  let length = 0;
  const reader = response.body?.getReader();
  for (;;) {
    const { value } = (await reader?.read()) ?? {};
    if (!value) return bytes.subarray(0, length);
    if (length + value.length > bytes.length) throw new Error("the picture has too many bytes");
    bytes.set(value, length);
    length += value.length;
    arrived?.(length / bytes.length);
  }
}

function pictureOf(headers: Headers, bytes: Uint8Array): FilmPicture {
  const number = (name: string): number => numberIn(headers, name);
  const [columns, rows, size] = [number("columns"), number("rows"), sizeOf(headers)];
  if (columns < 1 || rows < 1 || bytes.length !== size) {
    throw new Error(
      `the picture of ${columns} × ${rows} pixels has ${bytes.length} bytes instead of ${size}; reload the page`,
    );
  }
  const values = size > columns * rows ? new Uint16Array(bytes.buffer) : Uint16Array.from(bytes);
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
