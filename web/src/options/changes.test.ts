import { expect, test } from "vitest";

import type { Api } from "../api/types";
import { changesOf, draftOf } from "./changes";

const option = (name: string, value: string): Api<"OptionView"> => ({
  name,
  title: name,
  help: "",
  value,
  default: value,
  is_changed: false,
  is_closed: false,
  values: [],
});

const view: Api<"OptionsView"> = {
  revision: 3,
  may_change: true,
  options: [option("support", "frontal"), option("inflections", "")],
};

test("only what was written anew is sent", () => {
  const draft = draftOf(view);
  expect(changesOf(view, draft)).toEqual([]);
  expect(changesOf(view, { ...draft, support: " frontal " })).toEqual([]);
  expect(changesOf(view, { ...draft, inflections: "L1,T6 " })).toEqual([
    { name: "inflections", value: "L1,T6" },
  ]);
});

test("an emptied value is sent, and resets its option", () => {
  expect(changesOf(view, { ...draftOf(view), support: "" })).toEqual([
    { name: "support", value: "" },
  ]);
});
