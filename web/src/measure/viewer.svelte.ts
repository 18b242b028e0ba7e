import type { FilmPicture } from "./film";
import { adjusted, greyTable, limited, windowOfPicture, type GreyWindow } from "./grey";
import {
  filmOf,
  fit,
  pan,
  reveal,
  zoom,
  type CssPoint,
  type FilmPoint,
  type FilmSize,
  type Size,
  type Viewport,
} from "./viewport";

/** Tool of the left button. */
export type Tool = "mark" | "pan" | "window" | "scale";

/** View of a film. It is not part of a reading. */
export class Viewer {
  picture = $state.raw<FilmPicture | null>(null);
  size = $state.raw<Size>({ width: 0, height: 0 });
  devicePixelRatio = $state(1);
  view = $state.raw<Viewport>({ scale: 1, aspect: 1, left: 0, top: 0 });
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

  get film(): FilmSize {
    const { columns, rows, aspect } = this.picture ?? { columns: 1, rows: 1, aspect: 1 };
    return { columns, rows, aspect };
  }

  show(picture: FilmPicture): void {
    this.picture = picture;
    this.window = picture.window;
    this.fit();
  }

  resize(size: Size, devicePixelRatio: number): void {
    this.size = size;
    this.devicePixelRatio = devicePixelRatio;
    if (this.#fitted) this.fit();
  }

  fit(): void {
    this.#fitted = true;
    this.view = fit(this.film, this.size);
  }

  get middle(): CssPoint {
    return [this.size.width / 2, this.size.height / 2];
  }

  zoomBy(factor: number, at: CssPoint = this.middle): void {
    this.#fitted = false;
    this.view = zoom(this.view, factor, at, this.film, this.size);
  }

  panBy(by: CssPoint): void {
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

  windowAsFilmed(): void {
    if (this.picture) this.window = this.picture.window;
  }

  windowFull(): void {
    if (!this.picture) return;
    const { max } = this.picture;
    this.window = limited({ centre: max / 2, width: max }, max);
  }

  windowOfPicture(): void {
    if (!this.picture) return;
    const { levels } = this.picture.pyramid;
    this.window = windowOfPicture(levels.at(-1)!, this.picture.max);
  }

  toggleCrosshair(at: FilmPoint | null = null): void {
    this.crosshair = this.crosshair ? null : (at ?? filmOf(this.view, this.middle));
    if (this.crosshair) this.reveal(this.crosshair, 120);
  }

  /** Moves the crosshair by CSS pixels. */
  moveCrosshair([x, y]: CssPoint): void {
    if (!this.crosshair) return;
    const { columns, rows } = this.film;
    const column = this.crosshair[0] + x / this.view.scale;
    const row = this.crosshair[1] + y / (this.view.scale * this.view.aspect);
    this.crosshair = [
      Math.min(columns - 0.5, Math.max(-0.5, column)),
      Math.min(rows - 0.5, Math.max(-0.5, row)),
    ];
    this.reveal(this.crosshair, 60);
  }
}
