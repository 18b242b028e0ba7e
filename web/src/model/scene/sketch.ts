import { Vector3, type Camera } from "three";

import type { Palette } from "../colour";
import { at, placed, type BodySize, type Point, type Shape } from "../shapes";
import { HEAD_GIRTH, HIDDEN, type Arrow, type Rod } from "./arrow";
import { boneColour, type FigureStyle } from "./figure";
import { hull, type Place } from "./hull";
import { rimPoints } from "./vertebra";

/** A spine to be drawn in outline; a faint one is not filled. */
export interface Sketched extends FigureStyle {
  shape: Shape;
}

/** A part of the canvas, in CSS pixels. */
export interface Window {
  left: number;
  width: number;
  height: number;
  pixelsPerMm: number;
}

/** Order of drawing: outlines are filled from the farthest to the nearest. */
interface Outline {
  places: Place[];
  depth: number;
  fill: string;
}

/** A factor of two fewer points of a rim is enough for an outline. */
const EVERY = 2;
const JOINT_PX = 3;
/** Distance of the stripes on shapes that are not results. */
const STRIPES_PX = 6;

/**
 * The picture in flat outlines from the camera's view. Without a graphics card it is faster than a single
 * picture in 3D.
 */
export class Sketch {
  readonly #canvas = document.createElement("canvas");
  readonly #pen: CanvasRenderingContext2D;
  readonly #stripes: CanvasPattern;

  constructor(
    over: HTMLCanvasElement,
    private readonly sizes: readonly BodySize[],
    private readonly palette: Palette,
  ) {
    const pen = this.#canvas.getContext("2d", { alpha: false });
    if (!pen) throw new Error("no canvas");
    this.#pen = pen;
    this.#stripes = stripes(pen, palette.background);
    this.#canvas.setAttribute("aria-hidden", "true");
    Object.assign(this.#canvas.style, { position: "absolute", inset: "0", pointerEvents: "none" });
    over.after(this.#canvas);
    this.hide();
  }

  hide(): void {
    this.#canvas.hidden = true;
    this.#canvas.style.display = "none";
  }

  /** Clears the whole picture. */
  begin(width: number, height: number): void {
    this.#canvas.hidden = false;
    this.#canvas.style.display = "block";
    if (this.#canvas.width !== width) this.#canvas.width = width;
    if (this.#canvas.height !== height) this.#canvas.height = height;
    this.#pen.fillStyle = this.palette.background;
    this.#pen.fillRect(0, 0, width, height);
  }

  draw(
    window: Window,
    camera: Camera,
    spines: readonly Sketched[],
    marks: { lines: readonly Rod[]; arrows: readonly Arrow[] },
  ): void {
    const pen = this.#pen;
    const project = (point: Point | Vector3): Vector3 => {
      const seen = point instanceof Vector3 ? point.clone() : new Vector3(...point);
      seen.project(camera);
      seen.x = window.left + ((seen.x + 1) / 2) * window.width;
      seen.y = ((1 - seen.y) / 2) * window.height;
      return seen;
    };
    pen.save();
    pen.beginPath();
    pen.rect(window.left, 0, window.width, window.height);
    pen.clip();
    pen.lineJoin = "round";
    const drawLines = (): void => {
      for (const line of marks.lines) if (line.mesh.visible) this.#rod(line, window, project);
    };
    drawLines();
    for (const spine of spines) this.#spine(spine, project);
    pen.globalAlpha = HIDDEN;
    drawLines();
    pen.globalAlpha = 1;
    for (const arrow of marks.arrows) if (arrow.group.visible) this.#arrow(arrow, window, project);
    pen.restore();
  }

  dispose(): void {
    this.#canvas.remove();
  }

  #spine(spine: Sketched, project: (point: Point) => Vector3): void {
    const pen = this.#pen;
    const bone = boneColour(this.palette, spine.tone);
    const edge = spine.faint ? this.palette.measured : this.palette.background;
    const outlines = this.#outlines(spine, bone.getStyle(), project);
    outlines.sort((a, b) => b.depth - a.depth);
    const paints = (fill: string): (string | CanvasPattern)[] => {
      if (spine.faint) return [];
      return spine.tone === "not_a_result" ? [fill, this.#stripes] : [fill];
    };
    pen.lineWidth = 1;
    pen.strokeStyle = edge;
    for (const { places, fill } of outlines) {
      pen.beginPath();
      places.forEach(([x, y], index) => (index === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
      pen.closePath();
      for (const paint of paints(fill)) {
        pen.fillStyle = paint;
        pen.fill();
      }
      pen.stroke();
    }
    if (spine.faint) return;
    spine.shape.joints_mm.forEach((joint, index) => {
      const seen = project(joint as Point);
      const isContradicted = spine.contradicted[index] ?? false;
      pen.beginPath();
      pen.arc(seen.x, seen.y, isContradicted ? 1.6 * JOINT_PX : JOINT_PX, 0, 2 * Math.PI);
      pen.fillStyle = isContradicted ? this.palette.contradiction : this.palette.measured;
      pen.fill();
    });
  }

  #outlines(spine: Sketched, bone: string, project: (point: Point) => Vector3): Outline[] {
    const { shape, discs, chosenLevel, tone } = spine;
    const rims = this.sizes.map((body, index) => {
      const rim = (side: 1 | -1): Vector3[] =>
        rimPoints(body)
          .filter((_, step) => step % EVERY === 0)
          .map(([x, y]) => project(placed(shape, index, [x, y, (side * body.height_mm) / 2])));
      return { low: rim(-1), high: rim(1) };
    });
    const outline = (points: Vector3[], fill: string): Outline => ({
      places: hull(points.map(({ x, y }) => [x, y])),
      depth: points.reduce((sum, { z }) => sum + z, 0) / points.length,
      fill,
    });
    const bodies = rims.map(({ low, high }, index) =>
      outline([...low, ...high], index === chosenLevel ? this.palette.force : bone),
    );
    if (spine.faint) return bodies;
    const grey = this.palette.quiet;
    const between = rims.slice(1).map(({ low }, index) => {
      const colour = tone === "not_a_result" ? grey : (discs?.[index] ?? grey);
      return outline([...at(rims, index).high, ...low], colour);
    });
    return [...bodies, ...between];
  }

  #rod(rod: Rod, window: Window, project: (point: Vector3) => Vector3): void {
    const [from, to] = rod.ends.map(project) as [Vector3, Vector3];
    this.#pen.strokeStyle = rod.mesh.material.color.getStyle();
    this.#pen.lineWidth = Math.max(1, 2 * rod.radius_mm * window.pixelsPerMm);
    this.#pen.beginPath();
    this.#pen.moveTo(from.x, from.y);
    this.#pen.lineTo(to.x, to.y);
    this.#pen.stroke();
  }

  #arrow(arrow: Arrow, window: Window, project: (point: Vector3) => Vector3): void {
    this.#rod(arrow.shaft, window, project);
    const [base, tip] = arrow.headEnds.map(project) as [Vector3, Vector3];
    const half = tip.clone().sub(base).multiplyScalar(HEAD_GIRTH);
    const pen = this.#pen;
    pen.fillStyle = arrow.shaft.mesh.material.color.getStyle();
    pen.beginPath();
    pen.moveTo(tip.x, tip.y);
    pen.lineTo(base.x - half.y, base.y + half.x);
    pen.lineTo(base.x + half.y, base.y - half.x);
    pen.fill();
  }
}

/** Stripes mark shapes that are not results, also in print and for colour-blind readers. */
function stripes(pen: CanvasRenderingContext2D, colour: string): CanvasPattern {
  const tile = new OffscreenCanvas(STRIPES_PX, STRIPES_PX);
  const paint = tile.getContext("2d");
  if (!paint) throw new Error("no canvas");
  paint.fillStyle = colour;
  for (let x = 0; x < STRIPES_PX; x += 1)
    for (let y = 0; y < STRIPES_PX; y += 1)
      if ((x + y) % STRIPES_PX < STRIPES_PX / 2) paint.fillRect(x, y, 1, 1);
  const pattern = pen.createPattern(tile, "repeat");
  if (!pattern) throw new Error("no canvas");
  return pattern;
}
