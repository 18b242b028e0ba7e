/** A linear axis of a chart with round ticks. */
export interface Axis {
  readonly ticks: readonly number[];
  /** Place of a value on the screen. */
  at(value: number): number;
}

/** An axis that holds all values, from one place of the screen to another. */
export function axisOf(values: readonly number[], from_px: number, to_px: number): Axis {
  const [least, most] = [
    values.reduce((a, b) => Math.min(a, b), Infinity),
    values.reduce((a, b) => Math.max(a, b), -Infinity),
  ];
  const isPoint = !(most > least);
  const [low, high] = isPoint ? [(values[0] ?? 0) - 1, (values[0] ?? 0) + 1] : [least, most];
  const rough = (high - low) / 5;
  const size = 10 ** Math.floor(Math.log10(rough));
  const step = size * ([1, 2, 5].find((times) => times * size >= rough) ?? 10);
  const [first, last] = [Math.floor(low / step), Math.ceil(high / step)];
  const ticks = Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
  const scale = (to_px - from_px) / ((last - first) * step);
  return { ticks, at: (value) => from_px + (value - first * step) * scale };
}

/** Points of any number as one path of round dots, each place once. */
export function dotsAt(places: readonly (readonly [number, number])[]): string {
  return [...new Set(places.map(([x, y]) => `M${Math.round(x)} ${Math.round(y)}h0`))].join("");
}
