import { act, changeKeys, type Actions } from "../shell/keys.svelte";
import { LAYERS, layers } from "../understand/layers.svelte";
import type { Drawing } from "./drawing.svelte";
import type { Marking } from "./marking.svelte";
import { placeOf, type Landmark } from "./landmarks";
import { proposedPlace } from "./proposals";
import type { Viewer } from "./viewer.svelte";
import type { CssPoint, FilmPoint } from "./viewport";

/** Actions of keys outside of the film. */
interface KeyTargets {
  viewer: Viewer;
  marking: Marking | null;
  /** The length or the angle that is being drawn. */
  drawing: Drawing | null;
  /** Places a landmark at the crosshair. */
  placeAt(at: FilmPoint): void;
  invert(): void;
  /** Whether lengths and angles can be measured: not in a blinded reading. */
  canDraw: boolean;
  /** Keys of the page around the film. */
  more: Actions;
}

const NUDGE = 0.1;
const LARGE_NUDGE = 1;
const PAN_CSS = 60;
const CROSSHAIR_CSS = 4;
const LARGE_CROSSHAIR_CSS = 40;
const ZOOM = 1.25;
const GREY_CSS = 12;

/** Digits show and hide the layers over the film, in their order. */
const LAYER_KEYS: Actions = Object.fromEntries(
  LAYERS.map(({ name }, index) => [
    index + 1,
    () => void (layers.shown[name] = !layers.shown[name]),
  ]),
);

/** Runs the action of a key; returns whether the key has one. */
export function onKey(event: KeyboardEvent, targets: KeyTargets): boolean {
  const { viewer, marking, drawing } = targets;
  const arrow = (step: CssPoint) => () => onArrow(step, event.shiftKey, targets);
  const moves: Actions = {
    ArrowLeft: arrow([-1, 0]),
    ArrowRight: arrow([1, 0]),
    ArrowUp: arrow([0, -1]),
    ArrowDown: arrow([0, 1]),
    Tab: () => onTab(event.shiftKey ? -1 : 1, targets),
    ...changeKeys(marking),
  };
  // The browser would scroll while the bar is down.
  if (event.repeat) return act(event, { ...moves, " ": () => {} });
  const ofTool = drawing
    ? drawKeys(viewer, drawing)
    : marking && markKeys(viewer, marking, targets);
  return act(event, { ...ofTool, ...viewKeys(viewer, targets), ...moves });
}

function onArrow([x, y]: CssPoint, large: boolean, targets: KeyTargets): void {
  const { viewer, marking, drawing } = targets;
  const by = (step: number): CssPoint => [x * step, y * step];
  if (viewer.tool === "window") viewer.drawGrey(by(GREY_CSS));
  else if (marking?.selected && !drawing) nudge(viewer, marking, by(large ? LARGE_NUDGE : NUDGE));
  else if (viewer.crosshair) {
    viewer.moveCrosshair(by(large ? LARGE_CROSSHAIR_CSS : CROSSHAIR_CSS));
  } else viewer.panBy(by(-PAN_CSS));
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
    ...LAYER_KEYS,
    ...targets.more,
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
    else if (marking.way === "walls" && marking.acceptable.length > 0)
      void marking.acceptProposals();
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
    a: () => void marking.acceptProposals(),
    t: () => marking.toggleWay(),
    p: () => void marking.togglePropose(),
    e: () => marking.toggleWay("pedicles"),
    n: () => marking.jumpToCrests(),
    u: () => marking.shiftLevels(true),
    j: () => marking.shiftLevels(false),
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
  const all = [...marking.proposals, ...marking.reading.proposals];
  const proposal = all.find(({ level }) => level === landmark.level);
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
