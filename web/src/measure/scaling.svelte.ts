import type { PointerMode } from "./gestures";
import type { Viewer } from "./viewer.svelte";
import { filmOf, type CssPoint, type FilmPoint } from "./viewport";

/** Clicks on the two ends of an object of known size. */
export class Scaling implements PointerMode {
  ends = $state.raw<readonly FilmPoint[]>([]);
  #isDown = $state(false);

  constructor(readonly viewer: Viewer) {}

  get magnifies(): boolean {
    return this.#isDown || this.viewer.loupe;
  }

  press(): void {
    this.#isDown = true;
    this.viewer.crosshair = null;
  }

  drag(): void {}

  release(at: CssPoint): void {
    this.#isDown = false;
    this.placeAt(filmOf(this.viewer.view, at));
  }

  abandon(): void {
    this.#isDown = false;
  }

  placeAt(at: FilmPoint): void {
    this.ends = this.ends.length === 2 ? [at] : [...this.ends, at];
  }
}
