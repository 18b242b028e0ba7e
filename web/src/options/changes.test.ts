import { expect, test } from "vitest";

import type { Api } from "../api/types";
import { changesOf, draftOf, renewed } from "./changes";

const option = (name: string, value: string): Api<"OptionView"> => ({
  name,
  title: name,
  help: "",
  value,
  default: value,
  default_words: value,
  is_changed: false,
  is_closed: false,
  takes_file: false,
  values: [],
});

const view: Api<"OptionsView"> = {
  revision: 3,
  may_change: true,
  options: [option("support", "frontal"), option("inflections", "")],
};

test("only new values are sent", () => {
  const draft = draftOf(view);
  expect(changesOf(view, draft)).toEqual([]);
  expect(changesOf(view, { ...draft, support: " frontal " })).toEqual([]);
  expect(changesOf(view, { ...draft, inflections: "L1,T6 " })).toEqual([
    { name: "inflections", value: "L1,T6" },
  ]);
});

test("after a conflict, a value that another person changed is not changed back", () => {
  const draft = { ...draftOf(view), inflections: "L1,T6" };
  const now = { ...view, options: [option("support", "fixed"), option("inflections", "")] };
  const after = renewed(now, view, draft);
  expect(after).toEqual({ support: "fixed", inflections: "L1,T6" });
  expect(changesOf(now, after)).toEqual([{ name: "inflections", value: "L1,T6" }]);
  expect(renewed(view, null, {})).toEqual(draftOf(view));
});

test("the text of an opened file is sent, unless another value is chosen after it", () => {
  const files = { support: { name: "own.json", text: "{}" } };
  expect(changesOf(view, { ...draftOf(view), support: "own.json" }, files)).toEqual([
    { name: "support", value: "{}", file: "own.json" },
  ]);
  expect(changesOf(view, draftOf(view), files)).toEqual([]);
});

test("an emptied value is sent, and resets its option", () => {
  expect(changesOf(view, { ...draftOf(view), support: "" })).toEqual([
    { name: "support", value: "" },
  ]);
});
