import type { Api } from "../api/types";

export type Row = Api<"CohortRow">;

/** Rows sorted by study or by the cells of a heading; rows without a value are last. */
export function sorted(rows: Row[], heading: string | null, descending: boolean): Row[] {
  const direction = descending ? -1 : 1;
  const byStudy = (a: Row, b: Row): number =>
    a.study.localeCompare(b.study, "en", { numeric: true, sensitivity: "base" });
  if (heading === null) return rows.toSorted((a, b) => direction * byStudy(a, b));
  return rows.toSorted((a, b) => {
    const [x, y] = [cellOf(a, heading), cellOf(b, heading)];
    const [isEmptyX, isEmptyY] = [isEmpty(x), isEmpty(y)];
    if (isEmptyX !== isEmptyY) return isEmptyX ? 1 : -1;
    return direction * compare(x, y) || byStudy(a, b);
  });
}

export const cellOf = (row: Row, heading: string): Api<"CohortCell"> | undefined =>
  row.cells.find((cell) => cell.heading === heading);

/** Headings of all rows, in their order. */
export const headingsOf = (rows: Row[]): string[] => [
  ...new Set(rows.flatMap((row) => row.cells.map((cell) => cell.heading))),
];

/** Names of all statistics, in their order. */
export const statisticsOf = (views: readonly Api<"ReliabilityView">[]): string[] => [
  ...new Set(views.flatMap(({ statistics }) => statistics.map(({ name }) => name))),
];

const isEmpty = (cell: Api<"CohortCell"> | undefined): boolean =>
  cell === undefined || cell.text === "–" || cell.text === "";

function compare(a: Api<"CohortCell"> | undefined, b: Api<"CohortCell"> | undefined): number {
  if (typeof a?.value === "number" && typeof b?.value === "number") return a.value - b.value;
  return (a?.text ?? "").localeCompare(b?.text ?? "", "en", { numeric: true });
}
