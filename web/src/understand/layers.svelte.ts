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

export type LayerName = (typeof LAYERS)[number]["name"];

/** Which layers are shown; the same on every film. */
class Layers {
  shown = $state<Record<LayerName, boolean>>({
    axes: true,
    curve: true,
    residuals: true,
    inflections: true,
    least: true,
    cobb: true,
    lines: true,
    erect: true,
  });

  /** By the number of its key. */
  toggle(number: number): void {
    const layer = LAYERS[number - 1];
    if (layer) this.shown[layer.name] = !this.shown[layer.name];
  }
}

export const layers = new Layers();
