import {
  AmbientLight,
  Color,
  ConeGeometry,
  CylinderGeometry,
  DirectionalLight,
  HemisphereLight,
  OrthographicCamera,
  Plane,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import type { Palette } from "../colour";
import { at, type BodySize, type Point, type Shape } from "../shapes";
import { Arrow, Rod } from "./arrow";
import { Figure, Parts, placement, type FigureStyle, type Tone } from "./figure";
import { Ground } from "./ground";
import { Labels, type Label } from "./labels";
import { PRESETS, lookOf, type Look, type Preset } from "./looks";
import { Sketch, type Sketched, type Window } from "./sketch";

/** A line of action. */
export interface LineDrawn {
  point: Point;
  direction: Point;
  colour: string;
  /** Thick, with the arrow of its force. */
  isChosen: boolean;
}

/** Content of the picture. */
export interface Picture extends Omit<FigureStyle, "tone" | "faint"> {
  layout: "one" | "overlay" | "beside";
  main: { shape: Shape; tone: Tone };
  other: { shape: Shape; tone: Tone } | null;
  lines: readonly LineDrawn[];
  /** Text of the force along the chosen line; no arrow without it. */
  force: string | null;
  /** A load by hand, from its point of action to the tip of its arrow. */
  load: { from: Point; tip: Point } | null;
}

/** Events of the stage. */
interface StageListener {
  picked(target: { joint: number } | { level: number }): void;
  /** After every picture. */
  drawn(look: Look): void;
  /** Place of the tip of the load on the screen. */
  tipped(tip: [number, number] | null): void;
  /** The browser took the 3D view away; the page removes the stage. */
  lost(): void;
}

const DISTANCE_MM = 3000;
const FORCE_ARROW_MM = 55;
/** Room above the arrow for its label. */
const FORCE_LABEL_MM = 24;
/** Distance from the lowest body to the grid. */
const GROUND_MM = 12;
const MARGIN_MM = 26;
const MIN_LINE_MM = 160;
/** Pixels of the picture per CSS pixel: more than on the screen, for smooth edges. */
const PIXEL_RATIO = 2;
/** Time without changes after which a slow machine draws the full picture. */
const REST_MS = 250;
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Spines in a part of the picture. */
interface Seen {
  main: boolean;
  other: boolean;
}

const NO_STYLE = { contradicted: [], chosenJoint: null, chosenLevel: null, discs: null } as const;

/** The 3D view: drawn only when something changes. */
export class Stage {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new OrthographicCamera();
  readonly #controls: OrbitControls;
  readonly #parts: Parts;
  readonly #main: Figure;
  readonly #other: Figure;
  readonly #ground: Ground;
  readonly #rod = new CylinderGeometry(1, 1, 1, 10);
  readonly #head = new ConeGeometry(1, 1, 20);
  readonly #force: Arrow;
  readonly #load: Arrow;
  readonly #lines: Rod[] = [];
  readonly #labels: Labels;
  readonly #light = new DirectionalLight(0xffffff, 2.1);
  readonly #observer: ResizeObserver;
  readonly #centre: Vector3;
  readonly #reach: [number, number];
  #picture: Picture | null = null;
  #frame = 0;
  #pressed: Vector2 | null = null;
  #isSettling = false;
  #isHeld = false;
  /** For machines without a graphics card. */
  readonly #sketch: Sketch | null;
  #posed: Picture | null = null;
  #fine: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    layer: HTMLElement,
    private readonly sizes: readonly BodySize[],
    private readonly palette: Palette,
    { erect, range }: { erect: Shape; range: [Point, Point] },
    private readonly listener: StageListener,
  ) {
    this.#renderer = new WebGLRenderer({ canvas });
    this.#renderer.setPixelRatio(PIXEL_RATIO);
    const isSlow = SOFTWARE.test(rendererName(this.#renderer));
    this.#sketch = isSlow ? new Sketch(canvas, sizes, palette) : null;
    this.#renderer.setScissorTest(true);
    this.#scene.background = new Color(palette.background);
    const [low, high] = [new Vector3(...range[0]), new Vector3(...range[1])];
    high.z += FORCE_ARROW_MM + FORCE_LABEL_MM;
    low.z -= GROUND_MM;
    this.#centre = low.clone().add(high).multiplyScalar(0.5);
    const wide = Math.max(high.x - this.#centre.x, high.y - this.#centre.y);
    this.#reach = [wide + MARGIN_MM, (high.z - low.z) / 2 + MARGIN_MM];
    this.#parts = new Parts(sizes);
    this.#main = new Figure(this.#parts, palette);
    this.#other = new Figure(this.#parts, palette);
    this.#ground = new Ground(at(sizes, 0), placement(erect, 0), {
      line: palette.line,
      quiet: palette.quiet,
    });
    this.#force = new Arrow(this.#rod, this.#head);
    this.#load = new Arrow(this.#rod, this.#head, { isOnTop: true });
    this.#labels = new Labels(layer);
    this.#scene.add(this.#main.group, this.#other.group, this.#ground.group);
    this.#scene.add(this.#force.group, this.#load.group);
    this.#addLights();

    this.#camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.minZoom = 0.4;
    this.#controls.maxZoom = 12;
    this.#controls.addEventListener("change", () => this.draw());
    this.#controls.addEventListener("start", () => this.hold(true));
    this.#controls.addEventListener("end", () => this.hold(false));
    this.look("back");
    this.#observer = new ResizeObserver(() => this.draw());
    this.#observer.observe(canvas.parentElement ?? canvas);
    canvas.addEventListener("pointerdown", this.#press);
    canvas.addEventListener("pointerup", this.#release);
    canvas.addEventListener("webglcontextlost", this.#lose);
  }

  show(picture: Picture): void {
    const last = this.#picture;
    this.#picture = picture;
    // The answer follows soon, and a slow machine can draw only one of both pictures.
    if (this.#sketch && this.#isHeld && picture.load && last?.main.shape === picture.main.shape) {
      this.#tellTip();
      return;
    }
    this.#showLines(picture);
    this.#load.group.visible = picture.load !== null;
    if (picture.load) this.#load.set(picture.load.from, picture.load.tip, this.palette.force);
    this.draw();
  }

  /** Draws at the next frame; several changes make one picture. */
  draw(): void {
    if (this.#frame || this.#isSettling) return;
    clearTimeout(this.#fine);
    this.#frame = requestAnimationFrame(() => {
      this.#frame = 0;
      this.#render(this.#sketch);
      if (this.#sketch && !this.#isHeld) this.#fine = setTimeout(() => this.#render(null), REST_MS);
    });
  }

  /** During a drag, a slow machine draws outlines only. */
  hold(isHeld: boolean): void {
    this.#isHeld = isHeld;
    this.draw();
  }

  look(preset: Preset): void {
    this.#camera.zoom = 1;
    this.#controls.target.copy(this.#centre);
    this.#camera.position.copy(this.#centre).addScaledVector(PRESETS[preset], DISTANCE_MM);
    this.#settle();
  }

  /** Rotates the view around the spine: to the right and up, in rad. */
  orbit(right: number, up: number): void {
    const offset = this.#camera.position.clone().sub(this.#controls.target);
    const radius = offset.length();
    const azimuth = Math.atan2(offset.y, offset.x) + right;
    const limit = Math.PI / 2 - 1e-3;
    const elevation = Math.min(Math.max(Math.asin(offset.z / radius) + up, -limit), limit);
    offset.set(
      radius * Math.cos(elevation) * Math.cos(azimuth),
      radius * Math.cos(elevation) * Math.sin(azimuth),
      radius * Math.sin(elevation),
    );
    this.#camera.position.copy(this.#controls.target).add(offset);
    this.#settle();
  }

  zoom(factor: number): void {
    const { minZoom, maxZoom } = this.#controls;
    this.#camera.zoom = Math.min(Math.max(this.#camera.zoom * factor, minZoom), maxZoom);
    this.#settle();
  }

  /** The point at a place of the page, in the plane through `near` parallel to the screen. */
  pointAt(clientX: number, clientY: number, near: Point): Point {
    const ray = this.#ray(clientX, clientY);
    const toward = this.#camera.getWorldDirection(new Vector3());
    const plane = new Plane().setFromNormalAndCoplanarPoint(toward, new Vector3(...near));
    const met = ray.ray.intersectPlane(plane, new Vector3()) ?? new Vector3(...near);
    return met.toArray();
  }

  /** A point moved along the screen, to the right and up, in mm. */
  moved(point: Point, right_mm: number, up_mm: number): Point {
    const [right, up] = [new Vector3(), new Vector3()];
    this.#camera.matrixWorld.extractBasis(right, up, new Vector3());
    return new Vector3(...point)
      .addScaledVector(right, right_mm)
      .addScaledVector(up, up_mm)
      .toArray();
  }

  dispose(): void {
    cancelAnimationFrame(this.#frame);
    clearTimeout(this.#fine);
    this.#observer.disconnect();
    this.canvas.removeEventListener("webglcontextlost", this.#lose);
    this.#controls.dispose();
    for (const part of [
      this.#main,
      this.#other,
      this.#ground,
      this.#force,
      this.#load,
      this.#parts,
    ])
      part.dispose();
    for (const line of this.#lines) line.dispose();
    this.#sketch?.dispose();
    this.#rod.dispose();
    this.#head.dispose();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss();
  }

  #addLights(): void {
    this.#scene.add(new AmbientLight(0xffffff, 0.25));
    const sky = new HemisphereLight(0xf2f6ff, 0x2a2420, 0.9);
    sky.position.set(0, 0, 1);
    this.#scene.add(sky, this.#light, this.#light.target);
  }

  #showLines(picture: Picture): void {
    while (this.#lines.length < picture.lines.length) {
      const rod = new Rod(this.#rod);
      rod.shineThrough();
      this.#lines.push(rod);
      this.#scene.add(rod.mesh);
    }
    const { midpoints_mm } = picture.main.shape;
    const [low, high] = [at(midpoints_mm, 0), at(midpoints_mm, midpoints_mm.length - 1)];
    let force: [Point, Point] | null = null;
    this.#lines.forEach((rod, index) => {
      const line = picture.lines[index];
      rod.mesh.visible = line !== undefined;
      if (!line) return;
      const upward = line.direction[2] < 0 ? -1 : 1;
      const [foot, head] = [footOn(line, low as Point), footOn(line, high as Point)];
      const along = new Vector3(...line.direction).multiplyScalar(upward);
      rod.paint(line.colour);
      // A line across the spine meets both ends at the same place and is still visible.
      const short = Math.max(0, MIN_LINE_MM - foot.distanceTo(head)) / 2;
      rod.set(
        foot.clone().addScaledVector(along, -20 - short),
        head.clone().addScaledVector(along, 25 + short),
        line.isChosen ? 0.9 : 0.45,
      );
      if (line.isChosen && picture.force) force = forceArrow(head, along, upward);
    });
    this.#force.group.visible = force !== null;
    const labels: Label[] = levelLabels(picture, this.sizes);
    if (force) {
      const [from, tip] = force as [Point, Point];
      this.#force.set(from, tip, this.palette.force);
      const top = from[2] > tip[2] ? from : tip;
      if (picture.force) labels.push({ text: picture.force, at: top, kind: "force" });
    }
    this.#staticLabels = labels;
  }

  #staticLabels: readonly Label[] = [];

  #settle(): void {
    this.#isSettling = true;
    this.#controls.update();
    this.#camera.updateMatrixWorld();
    this.#isSettling = false;
    this.draw();
  }

  /** Puts the spines of a picture into the scene. */
  #pose(picture: Picture): void {
    if (this.#posed === picture) return;
    this.#posed = picture;
    const { layout } = picture;
    this.#main.dress({ ...picture, tone: picture.main.tone, faint: false });
    this.#main.pose(picture.main.shape);
    if (picture.other) {
      this.#other.dress({ ...NO_STYLE, tone: picture.other.tone, faint: layout === "overlay" });
      this.#other.pose(picture.other.shape);
    }
  }

  /** Draws the scene, or its outlines. */
  #render(sketch: Sketch | null): void {
    const picture = this.#picture;
    const { clientWidth, clientHeight } = this.canvas.parentElement ?? this.canvas;
    if (!picture || clientWidth === 0 || clientHeight === 0) return;
    const size = new Vector2(clientWidth, clientHeight);
    // A new size clears the canvas, so it is set only if it has changed.
    if (!size.equals(this.#renderer.getSize(new Vector2()))) {
      this.#renderer.setSize(clientWidth, clientHeight);
    }
    if (sketch) sketch.begin(clientWidth, clientHeight);
    else {
      this.#pose(picture);
      this.#sketch?.hide();
    }
    const isBeside = picture.layout === "beside" && picture.other !== null;
    const width = isBeside ? size.x / 2 : size.x;
    const scale = this.#fit(width, size.y);
    // The light comes from behind the viewer.
    this.#light.target.position.copy(this.#centre);
    this.#light.position.fromArray(this.moved(this.#camera.position.toArray(), -1400, 1800));
    this.#light.target.updateMatrixWorld();
    const half = sketch
      ? (left: number, seen: Seen) =>
          this.#sketchHalf(sketch, { left, width, height: size.y, pixelsPerMm: scale }, seen)
      : (left: number, seen: Seen) => this.#half(left, width, size.y, seen);
    if (isBeside) {
      half(0, { main: false, other: true });
      half(width, { main: true, other: false });
    } else half(0, { main: true, other: picture.layout === "overlay" && picture.other !== null });
    const left = isBeside ? width : 0;
    const toward = this.#camera.position.clone().sub(this.#controls.target).normalize().toArray();
    this.#labels.set([...this.#staticLabels, ...(isBeside ? [] : this.#ground.labels(toward))]);
    this.#labels.place(this.#camera, left, width, size.y, scale);
    this.listener.drawn(lookOf(this.#camera, scale));
    this.#tellTip();
  }

  #tellTip(): void {
    const load = this.#picture?.load;
    this.listener.tipped(load ? this.#onScreen(load.tip) : null);
  }

  #sketchHalf(sketch: Sketch, window: Window, seen: Seen): void {
    const picture = this.#picture;
    if (!picture) return;
    const spines: Sketched[] = [];
    if (seen.main) spines.push({ ...picture, ...picture.main, faint: false });
    if (seen.other && picture.other) {
      spines.push({ ...NO_STYLE, ...picture.other, faint: picture.layout === "overlay" });
    }
    sketch.draw(window, this.#camera, spines, {
      lines: this.#lines,
      arrows: [this.#force, this.#load],
    });
  }

  #half(left: number, width: number, height: number, seen: Seen): void {
    this.#main.group.visible = seen.main;
    this.#other.group.visible = seen.other;
    this.#renderer.setViewport(left, 0, width, height);
    this.#renderer.setScissor(left, 0, width, height);
    this.#renderer.render(this.#scene, this.#camera);
  }

  /** Fits the whole range in the picture at zoom 1; gives CSS pixels per mm. */
  #fit(width: number, height: number): number {
    const [wide, high] = this.#reach;
    const perMm = Math.min(width / (2 * wide), height / (2 * high));
    this.#camera.left = -width / 2 / perMm;
    this.#camera.right = width / 2 / perMm;
    this.#camera.top = height / 2 / perMm;
    this.#camera.bottom = -height / 2 / perMm;
    this.#camera.near = 10;
    this.#camera.far = 2 * DISTANCE_MM;
    this.#camera.updateProjectionMatrix();
    this.#camera.updateMatrixWorld();
    return perMm * this.#camera.zoom;
  }

  /** A place in a picture that is not divided into halves. */
  #onScreen(point: Point): [number, number] {
    const { width, height } = this.#renderer.getSize(new Vector2());
    const seen = new Vector3(...point).project(this.#camera);
    return [((seen.x + 1) / 2) * width, ((1 - seen.y) / 2) * height];
  }

  #ray(clientX: number, clientY: number): Raycaster {
    const box = this.canvas.getBoundingClientRect();
    const isBeside = this.#picture?.layout === "beside" && this.#picture.other !== null;
    const width = isBeside ? box.width / 2 : box.width;
    const x = (clientX - box.left) % width;
    const ray = new Raycaster();
    const place = new Vector2((x / width) * 2 - 1, 1 - ((clientY - box.top) / box.height) * 2);
    ray.setFromCamera(place, this.#camera);
    return ray;
  }

  #press = (event: PointerEvent): void => {
    this.#pressed = new Vector2(event.clientX, event.clientY);
  };

  /** A press without a move selects the object under the pointer. */
  #release = (event: PointerEvent): void => {
    const moved = this.#pressed?.distanceTo(new Vector2(event.clientX, event.clientY)) ?? Infinity;
    this.#pressed = null;
    if (moved > 4) return;
    const [met] = this.#ray(event.clientX, event.clientY).intersectObjects(
      this.#main.targets,
      false,
    );
    const { joint, level } = met?.object.userData ?? {};
    if (typeof joint === "number") this.listener.picked({ joint });
    else if (typeof level === "number") this.listener.picked({ level });
  };

  #lose = (): void => this.listener.lost();
}

function rendererName(renderer: WebGLRenderer): string {
  const gl = renderer.getContext();
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  return names ? String(gl.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
}

function footOn(line: LineDrawn, point: Point): Vector3 {
  const [origin, direction] = [new Vector3(...line.point), new Vector3(...line.direction)];
  const along = new Vector3(...point).sub(origin).dot(direction);
  return origin.addScaledVector(direction, along);
}

/** Above the spine: points away from it for a pull and towards it for a push. */
function forceArrow(head: Vector3, along: Vector3, upward: number): [Point, Point] {
  const near = head.clone().addScaledVector(along, 12).toArray();
  const far = head
    .clone()
    .addScaledVector(along, 12 + FORCE_ARROW_MM)
    .toArray();
  return upward > 0 ? [near, far] : [far, near];
}

function levelLabels(picture: Picture, sizes: readonly BodySize[]): Label[] {
  return picture.main.shape.midpoints_mm.map((midpoint, index) => ({
    text: index === 0 ? `${at(sizes, index).level} fixed` : at(sizes, index).level,
    at: midpoint as Point,
    kind: "level",
    aside_mm: 0.95 * at(sizes, index).width_mm + 4,
  }));
}
