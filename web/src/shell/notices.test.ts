import { expect, it } from "vitest";

import type { Api } from "../api/types";
import { byLine } from "./notices";

const notice = (text: string, line: Api<"LineName"> | null = null): Api<"Notice"> => ({
  severity: "warning",
  code: "code",
  line,
  text,
});

it("puts what is said of a line under the line, and the rest first", () => {
  const all = [
    notice("the fit did not converge (`iterations`)", "iliac_line"),
    notice("no scale"),
    notice("one", "inflection_line"),
    notice("two", "iliac_line"),
  ];
  expect(byLine(all)).toEqual([
    { line: null, notices: [notice("no scale")] },
    { line: "inflection_line", notices: [notice("one")] },
    {
      line: "iliac_line",
      notices: [notice("the fit did not converge (`iterations`)"), notice("two")],
    },
  ]);
});

it("has no group without a notice, and takes none from its words", () => {
  expect(byLine([])).toEqual([]);
  const told = notice("iliac line: nothing");
  expect(byLine([told])).toEqual([{ line: null, notices: [told] }]);
});
