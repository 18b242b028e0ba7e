/** A place on a film in its pixels: column and row, sub-pixel, the centre of the first pixel at zero. */
export type FilmPoint = readonly [column: number, row: number];
/** A place in the viewer in CSS pixels. */
export type CssPoint = readonly [x: number, y: number];

export interface Size {
  readonly width: number;
  readonly height: number;
}

/** The visible part of a film: `css = (film + 0.5) × scale + offset`, with rows stretched by the pixel's aspect. */
export interface Viewport {
  /** CSS pixels per film column. */
  readonly scale: number;
  /** Height of a film pixel over its width. */
  readonly aspect: number;
  /** Place of the film's left edge. */
  readonly left: number;
  /** Place of the film's upper edge. */
  readonly top: number;
}

export interface FilmSize {
  readonly columns: number;
  readonly rows: number;
  readonly aspect: number;
}

/** Margin around a fitted film. */
const MARGIN_CSS = 12;
/** Maximum width of a film pixel. */
const MAX_SCALE = 48;
/** Minimum part of the film in view. */
const KEPT_CSS = 48;

export function cssOf(view: Viewport, [column, row]: FilmPoint): CssPoint {
  return [
    (column + 0.5) * view.scale + view.left,
    (row + 0.5) * view.scale * view.aspect + view.top,
  ];
}

export function filmOf(view: Viewport, [x, y]: CssPoint): FilmPoint {
  return [(x - view.left) / view.scale - 0.5, (y - view.top) / (view.scale * view.aspect) - 0.5];
}

/** The whole film, in the middle. */
export function fit(film: FilmSize, size: Size): Viewport {
  const width = Math.max(1, size.width - 2 * MARGIN_CSS);
  const height = Math.max(1, size.height - 2 * MARGIN_CSS);
  const scale = Math.min(width / film.columns, height / (film.rows * film.aspect));
  return {
    scale,
    aspect: film.aspect,
    left: (size.width - film.columns * scale) / 2,
    top: (size.height - film.rows * film.aspect * scale) / 2,
  };
}

/** Enlarges by a factor; the film's place under `at` stays where it is. */
export function zoom(
  view: Viewport,
  factor: number,
  at: CssPoint,
  film: FilmSize,
  size: Size,
): Viewport {
  const smallest = fit(film, size).scale / 2;
  const scale = Math.min(MAX_SCALE, Math.max(smallest, view.scale * factor));
  const ratio = scale / view.scale;
  const moved = {
    ...view,
    scale,
    left: at[0] - (at[0] - view.left) * ratio,
    top: at[1] - (at[1] - view.top) * ratio,
  };
  return kept(moved, film, size);
}

export function pan(view: Viewport, by: CssPoint, film: FilmSize, size: Size): Viewport {
  return kept({ ...view, left: view.left + by[0], top: view.top + by[1] }, film, size);
}

/** Moves the view by the smallest amount that shows a place at least `margin` inside. */
export function reveal(
  view: Viewport,
  point: FilmPoint,
  margin: number,
  film: FilmSize,
  size: Size,
): Viewport {
  const [x, y] = cssOf(view, point);
  const by = [short(x, margin, size.width), short(y, margin, size.height)] as const;
  return by[0] === 0 && by[1] === 0 ? view : pan(view, by, film, size);
}

function short(at: number, margin: number, length: number): number {
  const room = Math.min(margin, length / 2);
  return Math.max(0, room - at) + Math.min(0, length - room - at);
}

/** Keeps part of the film in view. */
function kept(view: Viewport, film: FilmSize, size: Size): Viewport {
  const width = film.columns * view.scale;
  const height = film.rows * view.scale * view.aspect;
  return {
    ...view,
    left: Math.min(size.width - KEPT_CSS, Math.max(KEPT_CSS - width, view.left)),
    top: Math.min(size.height - KEPT_CSS, Math.max(KEPT_CSS - height, view.top)),
  };
}

/** The interface sends points as lists of two numbers. */
export function filmPoint(px: readonly number[]): FilmPoint {
  return [px[0] ?? Number.NaN, px[1] ?? Number.NaN];
}
