import type { Api } from "../src/api/types";

/** All postures in the usual order. The tests have their own list, so that they notice a posture that the app loses. */
export const POSTURES: readonly Api<"PostureName">[] = [
  "erect",
  "left_bending",
  "right_bending",
  "neutral",
  "traction",
];
