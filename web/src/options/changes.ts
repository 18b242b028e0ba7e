import type { Api } from "../api/types";

/** Entered values, by the name of the option. */
export type Draft = Record<string, string>;

/** Files that were opened and not sent yet, by the name of the option. */
export type OpenedFiles = Record<string, { name: string; text: string }>;

export const draftOf = (view: Api<"OptionsView">): Draft =>
  Object.fromEntries(view.options.map(({ name, value }) => [name, value]));

/** The options whose entered value differs from the stored one. */
export const changesOf = (
  view: Api<"OptionsView">,
  draft: Draft,
  files: OpenedFiles = {},
): Api<"OptionChange">[] =>
  view.options.flatMap(({ name, value }) => {
    const written = (draft[name] ?? value).trim();
    const file = files[name];
    if (file && written === file.name) return [{ name, value: file.text, file: file.name }];
    return written === value ? [] : [{ name, value: written }];
  });
