import { expect, it } from "vitest";

import type { Api } from "../api/types";
import { byLine } from "./notices";

const notice = (text: string): Api<"Notice"> => ({ severity: "warning", code: "code", text });

it("puts what is said of a line under the line, and the rest first", () => {
  const iliac = notice("iliac line: the fit ended with `iterations`");
  const all = [
    iliac,
    notice("no scale"),
    notice("inflection line: one"),
    notice("iliac line: two"),
  ];
  expect(byLine(all)).toEqual([
    { line: null, notices: [notice("no scale")] },
    { line: "inflection_line", notices: [notice("one")] },
    { line: "iliac_line", notices: [notice("the fit ended with `iterations`"), notice("two")] },
  ]);
});

it("has no group without a notice, and knows a line only at the beginning", () => {
  expect(byLine([])).toEqual([]);
  const text = "on the iliac line: nothing";
  expect(byLine([notice(text)])).toEqual([{ line: null, notices: [notice(text)] }]);
});
