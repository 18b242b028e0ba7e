import { Vector3, type OrthographicCamera } from "three";

/** A direction of view. */
export type Preset = "front" | "back" | "left" | "right" | "top" | "bottom";

/** From the spine to the viewer in the patient's axes. Views from above or below are tilted slightly to the back, which makes their vertical axis unique. */
export const PRESETS: Record<Preset, Vector3> = {
  front: new Vector3(1, 0, 0),
  back: new Vector3(-1, 0, 0),
  left: new Vector3(0, 1, 0),
  right: new Vector3(0, -1, 0),
  top: new Vector3(-1e-3, 0, 1),
  bottom: new Vector3(-1e-3, 0, -1),
};

const FROM: { preset: Preset; words: string; letter: string }[] = [
  { preset: "front", words: "the front", letter: "A" },
  { preset: "back", words: "behind", letter: "P" },
  { preset: "left", words: "the patient’s left", letter: "L" },
  { preset: "right", words: "the patient’s right", letter: "R" },
  { preset: "top", words: "above", letter: "H" },
  { preset: "bottom", words: "below", letter: "F" },
];

/** Orientation and scale of the picture. */
export interface Look {
  /** The main view, if it is one. */
  preset: Preset | null;
  /** Such as `from behind`. */
  words: string;
  /** The patient's side at the edges of the picture: L, R, A (front), P (back), H (head), F (feet). */
  edges: { left: string; right: string };
  /** CSS pixels per millimetre in the plane of the screen. */
  pixelsPerMm: number;
}

export function lookOf(camera: OrthographicCamera, pixelsPerMm: number): Look {
  const [right, toward] = [new Vector3(), new Vector3()];
  camera.matrixWorld.extractBasis(right, new Vector3(), toward);
  const facing = nearest(toward);
  const isExact = PRESETS[facing.preset].dot(toward) > 0.999;
  return {
    preset: isExact ? facing.preset : null,
    words: isExact ? `from ${facing.words}` : `oblique, mainly from ${facing.words}`,
    edges: { right: nearest(right).letter, left: nearest(right.clone().negate()).letter },
    pixelsPerMm,
  };
}

function nearest(direction: Vector3): (typeof FROM)[number] {
  return FROM.reduce((best, next) =>
    PRESETS[next.preset].dot(direction) > PRESETS[best.preset].dot(direction) ? next : best,
  );
}
