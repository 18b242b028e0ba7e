import { expect, it } from "vitest";

import type { Api } from "../api/types";
import { byLine } from "./notices";

const notice = (text: string, line: Api<"LineKindName"> | null = null): Api<"Notice"> => ({
  severity: "warning",
  code: "code",
  line,
  text,
});

it("groups notices by line of action, others first", () => {
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

it("has no empty groups, and does not group by the text of a notice", () => {
  expect(byLine([])).toEqual([]);
  const told = notice("iliac line: nothing");
  expect(byLine([told])).toEqual([{ line: null, notices: [told] }]);
});
