import type { Api } from "../api/types";
import { threeDigits } from "../shell/number";

/** A number with its unit; no space before a degree sign. */
export const withUnit = (value: number | undefined, unit: string): string =>
  unit === "°" ? `${threeDigits(value)}°` : `${threeDigits(value)} ${unit}`;

const BOX_HEIGHT_PX = 38;

/** Horizontal boxes, one below the other, with room for their names. */
export async function drawBoxes(chart: Api<"BoxChart">, width_px: number): Promise<Element> {
  const Plot = await import("@observablehq/plot");
  const boxes = chart.boxes.map(({ label, five: [low, lower, median, upper, high] }) => ({
    label,
    low,
    lower,
    median,
    upper,
    high,
  }));
  const outliers = chart.boxes.flatMap(({ label, outliers }) =>
    outliers.map((value) => ({ label, value })),
  );
  return detached(
    Plot.plot({
      className: "chart",
      width: width_px,
      height: 60 + boxes.length * BOX_HEIGHT_PX,
      marginLeft: Math.min(220, 24 + 7 * Math.max(...boxes.map((box) => box.label.length))),
      marginRight: 20,
      marginTop: 8,
      marginBottom: 46,
      x: { label: chart.axis, grid: true, nice: true, labelArrow: "none", labelAnchor: "center" },
      y: { label: null, domain: boxes.map((box) => box.label), padding: 0.4, tickSize: 0 },
      marks: [
        Plot.ruleY(boxes, { y: "label", x1: "low", x2: "high", stroke: "var(--text-quiet)" }),
        Plot.barX(boxes, {
          y: "label",
          x1: "lower",
          x2: "upper",
          fill: "var(--accent-wash)",
          stroke: "var(--accent)",
        }),
        Plot.tickX(boxes, { y: "label", x: "low", stroke: "var(--text-quiet)", inset: 6 }),
        Plot.tickX(boxes, { y: "label", x: "high", stroke: "var(--text-quiet)", inset: 6 }),
        Plot.tickX(boxes, {
          y: "label",
          x: "median",
          stroke: "var(--accent-strong)",
          strokeWidth: 2.5,
        }),
        Plot.dot(outliers, { y: "label", x: "value", r: 3, stroke: "var(--warning)" }),
      ],
    }),
  );
}

/** Differences against means, with their mean and limits of agreement. */
export async function drawAgreement(
  view: Api<"BlandAltmanView">,
  width_px: number,
): Promise<Element> {
  const Plot = await import("@observablehq/plot");
  const pairs = view.means.map((mean, index) => ({ mean, difference: view.differences[index] }));
  const [low = Number.NaN, high = Number.NaN] = view.limits;
  const lines = [
    { at: high, text: withUnit(high, view.unit), dash: true },
    { at: view.bias, text: `mean ${withUnit(view.bias, view.unit)}`, dash: false },
    { at: low, text: withUnit(low, view.unit), dash: true },
  ];
  return detached(
    Plot.plot({
      className: "chart",
      width: width_px,
      height: 230,
      marginLeft: 56,
      marginRight: 96,
      marginBottom: 40,
      x: {
        label: `mean of both (${view.unit})`,
        nice: true,
        labelArrow: "none",
        labelAnchor: "center",
      },
      y: {
        label: `difference (${view.unit})`,
        grid: true,
        nice: true,
        labelArrow: "none",
        labelAnchor: "center",
      },
      marks: [
        Plot.ruleY([0], { stroke: "var(--line-strong)" }),
        Plot.ruleY(
          lines.filter((line) => line.dash),
          { y: "at", stroke: "var(--warning)", strokeDasharray: "5 4" },
        ),
        Plot.ruleY([view.bias], { stroke: "var(--accent)" }),
        Plot.dot(pairs, {
          x: "mean",
          y: "difference",
          r: 2.5,
          fill: "var(--text)",
          fillOpacity: 0.55,
        }),
        Plot.text(lines, {
          y: "at",
          text: "text",
          frameAnchor: "right",
          textAnchor: "start",
          dx: 6,
          fill: "var(--text)",
        }),
      ],
    }),
  );
}

/** Removes Plot's style element, which the content policy of the program blocks; `Chart.svelte` contains the rules. */
function detached(plot: Element): Element {
  for (const style of plot.querySelectorAll("style")) style.remove();
  return plot;
}
