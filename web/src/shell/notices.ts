import type { Api } from "../api/types";
import { lineNames } from "./words";

type Notice = Api<"Notice">;
type LineKindName = Api<"LineKindName">;

/** Notices of one line of action, or of none. */
interface LineNotices {
  line: LineKindName | null;
  notices: Notice[];
}

/** Groups notices by line of action and removes the line's name from their texts; notices without a line first, groups with notes only last. */
export function byLine(notices: readonly Notice[]): LineNotices[] {
  const groups: LineNotices[] = [null, ...lineNames].map((line) => ({ line, notices: [] }));
  for (const notice of notices) {
    const line = notice.line ?? null;
    groups.find((group) => group.line === line)?.notices.push({ ...notice, line: null });
  }
  const isQuiet = (group: LineNotices): boolean =>
    group.notices.every(({ severity }) => severity === "note");
  return groups
    .filter((group) => group.notices.length > 0)
    .toSorted((a, b) => Number(isQuiet(a)) - Number(isQuiet(b)));
}
