/** Layers over a film in the order of their keys, with the token of their colour. */
export const LAYERS = [
  { name: "axes", label: "Axes", colour: "--mark" },
  { name: "curve", label: "Curve", colour: "--curve" },
  { name: "residuals", label: "Residuals", colour: "--text" },
  { name: "inflections", label: "Inflections", colour: "--inflection" },
  { name: "least", label: "Least rotating", colour: "--least-rotating" },
  { name: "cobb", label: "Cobb", colour: "--text" },
  { name: "lines", label: "Lines of action", colour: "--estimated-line" },
  { name: "erect", label: "Erect film beside", colour: "--text" },
] as const;

type LayerName = (typeof LAYERS)[number]["name"];

/** Which layers are shown; the same on every film. */
export const layers = $state({
  shown: Object.fromEntries(LAYERS.map(({ name }) => [name, true])) as Record<LayerName, boolean>,
});
