import type { paths } from "./schema";

/** Names in braces of a path. */
type NamesIn<Path> = Path extends `${string}{${infer Name}}${infer Rest}`
  ? Name | NamesIn<Rest>
  : never;

/** Path parameters as declared; else those that the path contains. */
type PathParameters<Path, Declared> = Declared extends { path: infer Stated }
  ? { path: Stated }
  : [NamesIn<Path>] extends [never]
    ? { path?: never }
    : { path: Record<NamesIn<Path>, string | number> };

type Operation<Path, Declared> = Declared extends { parameters: infer Parameters }
  ? Omit<Declared, "parameters"> & {
      parameters: Omit<Parameters, "path"> & PathParameters<Path, Parameters>;
    }
  : Declared;

/** The routes of the program, each with the parameters of its path. */
export type Routes = {
  [Path in keyof paths]: {
    [Method in keyof paths[Path]]: Operation<Path, paths[Path][Method]>;
  };
};
