import { MediaQuery } from "svelte/reactivity";

import { at } from "./shapes";

/** Tokens of the stiffness scale, softest first: equal steps of lightness, so that colour-blind readers see the order. */
export const STIFFNESS_TOKENS = [0, 1, 2, 3, 4, 5, 6].map((step) => `--stiffness-${step}`);

const light = new MediaQuery("(prefers-color-scheme: light)");
const known = new Map<string, string>();

/** The theme of the system; it may change while a page is open. */
export const themeName = (): "light" | "dark" => (light.current ? "light" : "dark");

/** Value of a colour of the theme. It is cached for each theme, because reading it triggers a layout. */
export function themeColour(token: string): string {
  const key = `${themeName()} ${token}`;
  const colour =
    known.get(key) ?? getComputedStyle(document.documentElement).getPropertyValue(token).trim();
  known.set(key, colour);
  return colour;
}

/** Colours of the theme that a picture in 3D needs. */
export const palette = () => ({
  bone: themeColour("--bone"),
  boneSimulated: themeColour("--bone-simulated"),
  boneDoubtful: themeColour("--bone-doubtful"),
  /** Outlines and joints. */
  measured: themeColour("--measured"),
  contradiction: themeColour("--contradiction"),
  force: themeColour("--force"),
  quiet: themeColour("--line-strong"),
  line: themeColour("--line"),
  background: themeColour("--bg"),
});
export type Palette = ReturnType<typeof palette>;

export function stiffnessStops(): string[] {
  return STIFFNESS_TOKENS.map(themeColour);
}

/** Colour at a value from 0 to 1 of a scale with equal stops, each `#rrggbb`. */
export function onScale(stops: readonly string[], relative: number): string {
  const place = Math.min(Math.max(relative, 0), 1) * (stops.length - 1);
  const index = Math.min(Math.floor(place), stops.length - 2);
  const share = place - index;
  const [low, high] = [channels(at(stops, index)), channels(at(stops, index + 1))];
  const mixed = low.map((value, i) => Math.round(value + (at(high, i) - value) * share));
  return `#${mixed.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}

function channels(colour: string): number[] {
  return [1, 3, 5].map((start) => Number.parseInt(colour.slice(start, start + 2), 16));
}
