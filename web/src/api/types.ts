import type { components } from "./schema";

/** A type of the interface by its name, as the program describes it. */
export type Api<Name extends keyof components["schemas"]> = components["schemas"][Name];
