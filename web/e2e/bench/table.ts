/** A row of the table: measured action and its times. */
export type Row = [what: string, ...times: string[]];

/** Quantile of the samples. */
export function quantile(samples: readonly number[], share: number): number {
  const sorted = samples.toSorted((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? Number.NaN;
}

export function spread(what: string, samples: readonly number[]): Row {
  const ms = (value: number): string => `${value.toFixed(0)} ms`;
  return [
    what,
    ms(quantile(samples, 0.5)),
    ms(quantile(samples, 0.95)),
    ms(Math.max(...samples)),
    `${samples.length}`,
  ];
}

/** Prints rows in aligned columns. */
export function print(rows: readonly Row[]): void {
  const all: Row[] = [["", "p50", "p95", "max", "samples"], ...rows];
  const widths = all[0]!.map((_, i) => Math.max(...all.map((row) => (row[i] ?? "").length)));
  for (const row of all) console.log(row.map((cell, i) => cell.padEnd(widths[i]!)).join("  "));
}
