import type { FilmPicture } from "./film";
import { adjusted, greyTable, type GreyWindow } from "./grey";
import { presetsOf, sameWindow } from "./presets";
import { UPRIGHT, clockwise, flipped, type Turn } from "./turn";
import {
  alongFilm,
  cssOf,
  filmOf,
  filmPoint,
  fit,
  pan,
  reveal,
  turned,
  zoom,
  type CssPoint,
  type FilmPoint,
  type FilmSize,
  type Size,
  type Viewport,
} from "./viewport";

/** Tool of the left button. */
export type Tool = "mark" | "pan" | "window" | "scale" | "length" | "angle";

/** View of a film. It is not part of a reading. */
export class Viewer {
  picture = $state.raw<FilmPicture | null>(null);
  size = $state.raw<Size>({ width: 0, height: 0 });
  devicePixelRatio = $state(1);
  view = $state.raw<Viewport>({ scale: 1, aspect: 1, left: 0, top: 0, turn: UPRIGHT });
  window = $state.raw<GreyWindow>({ centre: 0.5, width: 1 });
  inverted = $state(false);
  tool = $state<Tool>("mark");
  /** Whether the loupe is shown while the mouse moves. */
  loupe = $state(true);
  /** Place of the mouse or finger. */
  pointer = $state.raw<CssPoint | null>(null);
  /** Place of the crosshair of the keys, if it is on. */
  crosshair = $state.raw<FilmPoint | null>(null);
  /** Incremented when more sizes of the picture exist. */
  grown = $state(0);

  readonly table = $derived(
    this.picture ? greyTable(this.window, this.inverted, this.picture.max) : new Uint32Array(1),
  );
  #fitted = true;
  /** Another film that is moved and zoomed with this one. */
  #linked: Viewer | null = null;

  get film(): FilmSize {
    return this.picture ?? { columns: 1, rows: 1, aspect: 1 };
  }

  show(picture: FilmPicture): void {
    this.picture = picture;
    this.window = picture.window;
    this.view = { ...this.view, turn: UPRIGHT };
    this.#fit();
  }

  resize(size: Size, devicePixelRatio: number): void {
    this.size = size;
    this.devicePixelRatio = devicePixelRatio;
    if (this.#fitted) this.#fit();
  }

  /** Moves and zooms another film with this one from now on, or none. */
  link(other: Viewer | null): void {
    this.#linked = other;
  }

  /** The views that a person moves here. */
  get #moved(): Viewer[] {
    return this.#linked ? [this, this.#linked] : [this];
  }

  fit(): void {
    for (const viewer of this.#moved) viewer.#fit();
  }

  #fit(): void {
    this.#fitted = true;
    this.view = fit(this.film, this.size, this.view.turn);
  }

  /** Turns a quarter clockwise, for display only. */
  turn(): void {
    this.#turn(clockwise(this.view.turn));
  }

  /** Exchanges left and right of the screen, for display only. */
  mirror(): void {
    this.#turn(flipped(this.view.turn));
  }

  /** Shows the film as it is stored. */
  upright(): void {
    this.#turn(UPRIGHT);
  }

  #turn(turn: Turn): void {
    this.view = turned(this.view, turn, this.film, this.size);
    if (this.#fitted) this.#fit();
  }

  get middle(): CssPoint {
    return [this.size.width / 2, this.size.height / 2];
  }

  zoomBy(factor: number, at: CssPoint = this.middle): void {
    for (const viewer of this.#moved) viewer.#zoomBy(factor, at);
  }

  #zoomBy(factor: number, at: CssPoint): void {
    this.#fitted = false;
    this.view = zoom(this.view, factor, at, this.film, this.size);
  }

  panBy(by: CssPoint): void {
    for (const viewer of this.#moved) viewer.#panBy(by);
  }

  #panBy(by: CssPoint): void {
    this.#fitted = false;
    this.view = pan(this.view, by, this.film, this.size);
  }

  /** Moves the view to a place. */
  reveal(point: FilmPoint, margin = 80): void {
    const view = reveal(this.view, point, margin, this.film, this.size);
    if (view === this.view) return;
    this.#fitted = false;
    this.view = view;
  }

  /** Changes window and level by the pointer's move: across for contrast, down for darkness. */
  drawGrey([x, y]: CssPoint): void {
    if (!this.picture) return;
    const change = { wider: x / 600, brighter: -y / 600 };
    this.window = adjusted(this.window, change, this.picture.max);
  }

  /** The place on the screen of a point of the film. */
  at(px: readonly number[]): CssPoint {
    return cssOf(this.view, filmPoint(px));
  }

  /** A step on the screen as a step along columns and rows. */
  alongFilm(step: CssPoint): CssPoint {
    return alongFilm(this.view.turn, step);
  }

  /** Presets of window and level for this film. */
  readonly presets = $derived.by(() => {
    void this.grown;
    return this.picture ? presetsOf(this.picture) : [];
  });

  /** The next preset after the current one. */
  nextPreset(): void {
    const now = this.presets.findIndex(({ window }) => sameWindow(window, this.window));
    const next = this.presets[(now + 1) % Math.max(1, this.presets.length)];
    if (next) this.window = next.window;
  }

  toggleCrosshair(at: FilmPoint | null = null): void {
    this.crosshair = this.crosshair ? null : (at ?? filmOf(this.view, this.middle));
    if (this.crosshair) this.reveal(this.crosshair, 120);
  }

  /** Moves the crosshair by CSS pixels. */
  moveCrosshair([x, y]: CssPoint): void {
    if (!this.crosshair) return;
    const { columns, rows } = this.film;
    const [nowX, nowY] = cssOf(this.view, this.crosshair);
    const [column, row] = filmOf(this.view, [nowX + x, nowY + y]);
    this.crosshair = [
      Math.min(columns - 0.5, Math.max(-0.5, column)),
      Math.min(rows - 0.5, Math.max(-0.5, row)),
    ];
    this.reveal(this.crosshair, 60);
  }
}
