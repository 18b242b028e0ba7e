/** Layers over a film in the order of their keys. */
export const LAYERS = [
  { name: "axes", label: "Axes" },
  { name: "curve", label: "Curve" },
  { name: "residuals", label: "Residuals" },
  { name: "inflections", label: "Inflections" },
  { name: "least", label: "Least rotating" },
  { name: "cobb", label: "Cobb" },
  { name: "lines", label: "Lines of action" },
  { name: "erect", label: "Erect film beside" },
] as const;

type LayerName = (typeof LAYERS)[number]["name"];

/** Which layers are shown; the same on every film. */
export const layers = $state({
  shown: Object.fromEntries(LAYERS.map(({ name }) => [name, true])) as Record<LayerName, boolean>,
});
