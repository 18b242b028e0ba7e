import type { PointerMode } from "./gestures";
import { landmarkAt, placeOfProposed, proposedAt } from "./hit";
import type { Marking } from "./marking.svelte";
import { cranialFirst, placeOf, type Landmark } from "./landmarks";
import type { Viewer } from "./viewer.svelte";
import { cssOf, filmOf, type CssPoint, type FilmPoint } from "./viewport";

/** Distance within which a press grabs a landmark. */
const REACH_CSS = { mouse: 10, touch: 24 };
/** The same while another landmark is requested: on a film that fits the screen, discs are five pixels high. */
const ASKED_REACH_CSS = { mouse: 6, touch: 16 };
/** Distance within which a click then selects that landmark. */
const ASKED_CLICK_CSS = { mouse: 3, touch: 10 };

/** Actions of the left button or a finger on the film during a reading. */
export class Marker implements PointerMode {
  /** Whether a finger or a button is down. */
  #isDown = $state(false);
  #held: Landmark | null = null;
  /** Offset from the pointer to the grabbed landmark. */
  #grip: CssPoint = [0, 0];
  #reach: "mouse" | "touch" = "mouse";

  constructor(
    readonly viewer: Viewer,
    readonly marking: Marking,
  ) {}

  get magnifies(): boolean {
    const { marking, viewer } = this;
    if (!marking.changeable || viewer.tool !== "mark") return false;
    return this.#isDown || (viewer.loupe && marking.target !== null);
  }

  /** The current vertebra. */
  readonly level = $derived.by(() => {
    const { selected, target } = this.marking;
    if (selected && selected.kind !== "crest") return selected.level;
    return target && "level" in target ? target.level : null;
  });

  /** Middle of the current vertebra as placed or proposed, or of the uppermost one. */
  readonly middle = $derived.by((): FilmPoint | null => {
    const { vertebrae, proposals } = this.marking.reading;
    const outlined = vertebrae
      .filter(({ corners }) => corners.length > 1)
      .toSorted((a, b) => cranialFirst(a.level, b.level));
    const here = [...proposals, ...outlined].find(({ level }) => level === this.level);
    const corners = (here ?? outlined[0])?.corners;
    if (!corners) return null;
    const mean = (axis: 0 | 1): number =>
      corners.reduce((sum, { px }) => sum + px[axis]!, 0) / corners.length;
    return [mean(0), mean(1)];
  });

  press(at: CssPoint, touch: boolean): void {
    const { viewer, marking } = this;
    this.#isDown = true;
    this.#reach = touch ? "touch" : "mouse";
    viewer.crosshair = null;
    this.#held = null;
    if (!marking.changeable) return;
    const reach = (marking.target ? ASKED_REACH_CSS : REACH_CSS)[this.#reach];
    const placed = landmarkAt(marking.reading, viewer.view, at, reach, this.level);
    this.#held = placed ?? proposedAt(marking.proposals, viewer.view, at, reach);
    const place =
      this.#held &&
      (placeOf(marking.reading, this.#held) ?? placeOfProposed(marking.proposals, this.#held));
    const [x, y] = place ? cssOf(viewer.view, place) : at;
    this.#grip = [x - at[0], y - at[1]];
  }

  drag(at: CssPoint, far: boolean): void {
    if (!far || !this.#held) return;
    this.marking.drag(this.#held, this.#under(at));
  }

  release(at: CssPoint, far: boolean): void {
    this.#isDown = false;
    const held = this.#held;
    this.#held = null;
    if (far && held) {
      this.marking.drop();
      this.marking.select(held);
    } else this.#click(at);
  }

  abandon(): void {
    this.#isDown = false;
    this.#held = null;
    this.marking.abandonDrag();
  }

  /** Places the requested landmark, if the place is on the film. */
  placeAt(at: FilmPoint): Landmark | null {
    const { columns, rows } = this.viewer.film;
    const isOn = at[0] >= -0.5 && at[0] <= columns - 0.5 && at[1] >= -0.5 && at[1] <= rows - 0.5;
    if (isOn) return this.marking.place(at);
    this.marking.said = "this place is outside of the film";
    return null;
  }

  #click(at: CssPoint): void {
    const { viewer, marking } = this;
    const reach = (marking.target ? ASKED_CLICK_CSS : REACH_CSS)[this.#reach];
    const near = landmarkAt(marking.reading, viewer.view, at, reach, this.level);
    if (near) marking.select(near);
    else if (marking.target) marking.select(this.placeAt(filmOf(viewer.view, at)));
    else marking.select(null);
  }

  #under(at: CssPoint): FilmPoint {
    return filmOf(this.viewer.view, [at[0] + this.#grip[0], at[1] + this.#grip[1]]);
  }
}
