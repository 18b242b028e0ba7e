import type { Drawing } from "./drawing.svelte";
import type { Marking } from "./marking.svelte";
import { placeOf, type Landmark } from "./landmarks";
import { proposalOf, proposedPlace } from "./proposals";
import type { Viewer } from "./viewer.svelte";
import type { CssPoint, FilmPoint } from "./viewport";

/** Actions of keys outside of the film. */
export interface KeyTargets {
  viewer: Viewer;
  marking: Marking | null;
  /** The length or the angle that is being drawn. */
  drawing: Drawing | null;
  /** Places a landmark at the crosshair. */
  placeAt(at: FilmPoint): void;
  invert(): void;
  toggleLayer(number: number): void;
  /** Whether lengths and angles can be measured: not in a blinded reading. */
  canDraw: boolean;
}

const ARROWS: Record<string, CssPoint> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

const NUDGE = 0.1;
const LARGE_NUDGE = 1;
const PAN_CSS = 60;
const CROSSHAIR_CSS = 4;
const LARGE_CROSSHAIR_CSS = 40;
const ZOOM = 1.25;
const GREY_CSS = 12;

/** All keys of the film; the help page lists them. */
export const KEYS: readonly { keys: string; text: string }[] = [
  { keys: "Click, or C then Enter", text: "place the requested corner" },
  { keys: "C", text: "crosshair for placing landmarks: arrows move it, Shift in large steps" },
  { keys: "T", text: "two clicks per vertebra, on the middle of its walls; or four corners" },
  { keys: "P", text: "propose all vertebrae, from what is marked or from the picture" },
  {
    keys: "A, or Enter after two clicks",
    text: "accept the proposed corners of the next vertebra, or of all that have both clicks",
  },
  {
    keys: "E",
    text: "mark the pedicles of vertebrae, which give their axial rotation; or corners",
  },
  { keys: "N", text: "skip the optional vertebrae and go to the iliac crests" },
  { keys: "[ ]  Tab", text: "select the previous or next landmark" },
  {
    keys: "Arrows",
    text: "move the selected landmark 0.1 px, rotate an axis 0.1°; with Shift 1 px, 1°",
  },
  { keys: "Delete", text: "remove the vertebra of the selected landmark" },
  { keys: "R", text: "compute the axis from the corners again" },
  { keys: "Ctrl Z  Ctrl Y", text: "undo, redo" },
  { keys: "+  −  F", text: "zoom in, zoom out, fit" },
  { keys: "Space and drag, H", text: "move the film" },
  { keys: "Right button, W", text: "window and level" },
  { keys: "V", text: "the next preset of window and level" },
  { keys: "Q  M", text: "turn the picture 90° clockwise, mirror it; for display only" },
  {
    keys: "D  G",
    text: "measure a length, an angle: click, or C then Enter; Esc begins anew. Nothing is stored",
  },
  { keys: "I", text: "invert the grey levels" },
  { keys: "L", text: "loupe" },
  { keys: "1 – 7", text: "show or hide a layer" },
  { keys: "Esc", text: "clear the selection" },
];

/** Runs the action of a key; returns whether the key has one. */
export function onKey(event: KeyboardEvent, targets: KeyTargets): boolean {
  const arrow = ARROWS[event.key];
  if (event.ctrlKey || event.metaKey) return withControl(event, targets);
  if (event.altKey) return false;
  if (arrow) return onArrow(arrow, event.shiftKey, targets);
  if (event.key === "Tab") return onTab(event.shiftKey ? -1 : 1, targets);
  if (event.repeat) return event.key === " ";
  return onLetter(event.key.length === 1 ? event.key.toLowerCase() : event.key, targets);
}

function withControl(event: KeyboardEvent, { marking }: KeyTargets): boolean {
  const key = event.key.toLowerCase();
  if (!marking || (key !== "z" && key !== "y")) return false;
  if (key === "y" || event.shiftKey) marking.redo();
  else marking.undo();
  return true;
}

function onArrow([x, y]: CssPoint, large: boolean, targets: KeyTargets): boolean {
  const { viewer, marking, drawing } = targets;
  const by = (step: number): CssPoint => [x * step, y * step];
  if (viewer.tool === "window") viewer.drawGrey(by(GREY_CSS));
  else if (marking?.selected && !drawing) nudge(viewer, marking, by(large ? LARGE_NUDGE : NUDGE));
  else if (viewer.crosshair) {
    viewer.moveCrosshair(by(large ? LARGE_CROSSHAIR_CSS : CROSSHAIR_CSS));
  } else viewer.panBy(by(-PAN_CSS));
  return true;
}

/** Moves the selected landmark, or rotates its axis, in the directions of the screen. */
function nudge(viewer: Viewer, marking: Marking, [x, y]: CssPoint): void {
  const { mirrored } = viewer.view.turn;
  if (marking.selected?.kind !== "axis") marking.nudge(viewer.alongFilm([x, y]));
  // On a mirrored picture, clockwise on the screen is anticlockwise on the film.
  else marking.nudge(mirrored ? [-x, -y] : [x, y]);
}

/** Goes through the landmarks of one vertebra; after the last one, the Tab key leaves the film. */
function onTab(by: 1 | -1, { viewer, marking, drawing }: KeyTargets): boolean {
  const before = marking?.selected;
  if (!marking || drawing || !before || before.kind === "crest") return false;
  const moved = marking.step(by);
  const after = marking.selected;
  const stays = moved && after !== null && after.kind !== "crest" && after.level === before.level;
  if (!stays) marking.select(null);
  else show(viewer, marking);
  return stays;
}

function onLetter(key: string, targets: KeyTargets): boolean {
  const { viewer, marking } = targets;
  if (/^[1-7]$/.test(key)) {
    targets.toggleLayer(Number(key));
    return true;
  }
  const { drawing } = targets;
  const ofTool = drawing
    ? drawKeys(viewer, drawing)
    : marking && markKeys(viewer, marking, targets);
  const ofView = viewKeys(viewer, targets);
  const action = ofView[key] ?? ofTool?.[key];
  action?.();
  return action !== undefined;
}

type Actions = Partial<Record<string, () => void>>;

function viewKeys(viewer: Viewer, targets: KeyTargets): Actions {
  const toggle = (tool: "pan" | "window" | "length" | "angle") => () => {
    viewer.tool = viewer.tool === tool ? "mark" : tool;
  };
  const measures = targets.canDraw ? { d: toggle("length"), g: toggle("angle") } : {};
  return {
    "+": () => viewer.zoomBy(ZOOM),
    "=": () => viewer.zoomBy(ZOOM),
    "-": () => viewer.zoomBy(1 / ZOOM),
    f: () => viewer.fit(),
    h: toggle("pan"),
    w: toggle("window"),
    v: () => viewer.nextPreset(),
    q: () => viewer.turn(),
    m: () => viewer.mirror(),
    ...measures,
    i: () => targets.invert(),
    l: () => (viewer.loupe = !viewer.loupe),
  };
}

function drawKeys(viewer: Viewer, drawing: Drawing): Actions {
  const place = (): void => {
    if (viewer.crosshair) drawing.placeAt(viewer.crosshair);
    else viewer.toggleCrosshair();
  };
  return {
    c: () => viewer.toggleCrosshair(),
    Enter: place,
    " ": () => viewer.crosshair && place(),
    Delete: () => drawing.clear(),
    Escape: () => {
      if (drawing.ends.length > 0) drawing.clear();
      else if (viewer.crosshair) viewer.crosshair = null;
      else viewer.tool = "mark";
    },
  };
}

function markKeys(viewer: Viewer, marking: Marking, targets: KeyTargets): Actions {
  const level = marking.selected && "level" in marking.selected ? marking.selected.level : null;
  const place = (): void => {
    if (viewer.crosshair) targets.placeAt(viewer.crosshair);
    else if (marking.way === "walls" && marking.acceptable.length > 0) marking.acceptProposals();
    else viewer.toggleCrosshair(expected(marking));
  };
  const step = (by: 1 | -1) => () => {
    if (marking.step(by)) show(viewer, marking);
  };
  return {
    c: () => {
      marking.select(null);
      viewer.toggleCrosshair(expected(marking));
    },
    Enter: place,
    " ": () => viewer.crosshair && place(),
    a: () => marking.acceptProposals(),
    t: () => marking.toggleWay(),
    p: () => void marking.togglePropose(),
    e: () => marking.toggleWay("pedicles"),
    n: () => marking.jumpToCrests(),
    "[": step(-1),
    "]": step(1),
    r: () => level && marking.resetAxis(level),
    Delete: () => level && marking.removeVertebra(level),
    Escape: () => {
      if (marking.dragging) marking.abandonDrag();
      else if (marking.selected) marking.select(null);
      else viewer.crosshair = null;
    },
  };
}

/** Expected place of the next landmark, if the program proposes one. */
export function expected(marking: Marking): FilmPoint | null {
  const landmark: Landmark | null = marking.target;
  if (!landmark || !("level" in landmark)) return null;
  const proposal = proposalOf(marking.reading, landmark.level);
  if (!proposal || landmark.kind === "axis" || landmark.kind === "pedicle") return null;
  if (landmark.kind === "corner") return proposedPlace(proposal, landmark.corner);
  const above = proposedPlace(proposal, `superior_${landmark.side}`);
  const below = proposedPlace(proposal, `inferior_${landmark.side}`);
  return above && below && [(above[0] + below[0]) / 2, (above[1] + below[1]) / 2];
}

function show(viewer: Viewer, marking: Marking): void {
  const place = marking.selected && placeOf(marking.reading, marking.selected);
  if (place) viewer.reveal(place);
}
