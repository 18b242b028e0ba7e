import type { Api } from "../api/types";
import { at } from "./shapes";

/** Vertebrae and the sources of their pitch. */
export type Sources = Pick<Api<"ModelView">, "bodies" | "pitch_from">;

/** Whether a lateral film shows the pitch of any vertebra. */
export const isPitchMeasured = ({ pitch_from }: Sources): boolean =>
  pitch_from.includes("lateral_film");

/** The parts of a drawn spine that the films do not show. */
export function assumedText(sources: Sources): string {
  if (!isPitchMeasured(sources))
    return "Depth and arches are assumed: no lateral film was measured.";
  const always = "Arches and sizes from front to back are assumed.";
  const count = sources.pitch_from.filter((source) => source === "population").length;
  if (count === 0) return always;
  return `${always} The pitch of ${levelsText(sources)} is assumed: the lateral film does not show ${count === 1 ? "it" : "them"}.`;
}

/** Levels with a pitch from a population, cranial first, such as `T2 to T5 and L4`. */
function levelsText({ bodies, pitch_from }: Sources): string {
  const runs: string[][] = [[]];
  for (let index = bodies.length - 1; index >= 0; index -= 1) {
    if (at(pitch_from, index) === "population") runs.at(-1)?.push(at(bodies, index).level);
    else runs.push([]);
  }
  const names = runs.flatMap((run) => (run.length > 2 ? `${run[0]} to ${run.at(-1)}` : run));
  return new Intl.ListFormat("en-GB").format(names);
}
