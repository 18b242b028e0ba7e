import type { Api } from "../api/types";
import { lineNames, lineWord } from "./words";

type Notice = Api<"Notice">;
type LineName = Api<"LineName">;

/** What there is to say of one line of action, or of no line. */
export interface LineNotices {
  line: LineName | null;
  notices: Notice[];
}

/** The program begins what it says of a line with the line's name. */
const startOf = (line: LineName): string => `${lineWord(line).toLowerCase()}: `;

/** Notices under the line that they are about, whose name is taken off; those about none first, and mere notes last. */
export function byLine(notices: readonly Notice[]): LineNotices[] {
  const groups: LineNotices[] = [null, ...lineNames].map((line) => ({ line, notices: [] }));
  for (const notice of notices) {
    const line = lineNames.find((name) => notice.text.startsWith(startOf(name))) ?? null;
    const text = line ? notice.text.slice(startOf(line).length) : notice.text;
    groups.find((group) => group.line === line)?.notices.push({ ...notice, text });
  }
  const isQuiet = (group: LineNotices): boolean =>
    group.notices.every(({ severity }) => severity === "note");
  return groups
    .filter((group) => group.notices.length > 0)
    .toSorted((a, b) => Number(isQuiet(a)) - Number(isQuiet(b)));
}
