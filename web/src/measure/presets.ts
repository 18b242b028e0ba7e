import type { FilmPicture } from "./film";
import { limited, windowOfPicture, windowOfShares, type GreyWindow } from "./grey";

/** A window that is set by its name. */
export interface Preset {
  readonly label: string;
  readonly window: GreyWindow;
}

/**
 * Limits of bone and soft tissue on a film of a whole spine, as parts of the pixels by brightness (assumption): the
 * darker half is air, lungs and soft tissue; the brightest pixels are bone, markers and metal.
 */
const BONE = [0.5, 0.998] as const;
const SOFT = [0.05, 0.8] as const;

/** The file's windows, and windows for bone, for soft tissue and for everything. */
export function presetsOf({ max, fileWindows, pyramid }: FilmPicture): Preset[] {
  // The smallest size has the same brightness, and is counted at once.
  const plane = pyramid.levels.at(-1)!;
  return [
    ...fileWindows.map((window, index) => ({
      label: fileWindows.length === 1 ? "As filmed" : `As filmed ${index + 1}`,
      window,
    })),
    { label: "Bone", window: windowOfShares(plane, BONE, max) },
    { label: "Soft tissue", window: windowOfShares(plane, SOFT, max) },
    { label: "Darkest to brightest 1 %", window: windowOfPicture(plane, max) },
    { label: "Full range", window: limited({ centre: max / 2, width: max }, max) },
  ];
}

export const sameWindow = (a: GreyWindow, b: GreyWindow): boolean =>
  a.centre === b.centre && a.width === b.width;
