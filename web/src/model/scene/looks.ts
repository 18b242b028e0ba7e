import { Vector3, type OrthographicCamera } from "three";

/** Where the picture is looked at from. */
export type Preset = "front" | "back" | "left" | "right" | "top";

/** From the spine to who looks, in the patient's axes. From above, a little to the back keeps the front at the top. */
export const PRESETS: Record<Preset, Vector3> = {
  front: new Vector3(1, 0, 0),
  back: new Vector3(-1, 0, 0),
  left: new Vector3(0, 1, 0),
  right: new Vector3(0, -1, 0),
  top: new Vector3(-1e-3, 0, 1),
};

const FROM: { axis: Vector3; words: string; letter: string }[] = [
  { axis: new Vector3(1, 0, 0), words: "the front", letter: "A" },
  { axis: new Vector3(-1, 0, 0), words: "behind", letter: "P" },
  { axis: new Vector3(0, 1, 0), words: "the patient’s left", letter: "L" },
  { axis: new Vector3(0, -1, 0), words: "the patient’s right", letter: "R" },
  { axis: new Vector3(0, 0, 1), words: "above", letter: "H" },
  { axis: new Vector3(0, 0, -1), words: "below", letter: "F" },
];

/** What somebody has to know to read the picture. */
export interface Look {
  /** Such as `from behind`. */
  words: string;
  /** The patient's side at each edge of the picture: L, R, A (front), P (back), H (head), F (feet). */
  edges: { left: string; right: string; top: string; bottom: string };
  /** CSS pixels of a millimetre in the plane of the screen. */
  pixelsPerMm: number;
}

export function lookOf(camera: OrthographicCamera, pixelsPerMm: number): Look {
  const [right, up, toward] = [new Vector3(), new Vector3(), new Vector3()];
  camera.matrixWorld.extractBasis(right, up, toward);
  const facing = nearest(toward);
  const exact = facing.axis.dot(toward) > 0.985;
  const letter = (direction: Vector3): string => nearest(direction).letter;
  return {
    words: exact ? `from ${facing.words}` : `turned, mostly from ${facing.words}`,
    edges: {
      right: letter(right),
      left: letter(right.clone().negate()),
      top: letter(up),
      bottom: letter(up.clone().negate()),
    },
    pixelsPerMm,
  };
}

function nearest(direction: Vector3): (typeof FROM)[number] {
  return FROM.reduce((best, next) =>
    next.axis.dot(direction) > best.axis.dot(direction) ? next : best,
  );
}
