/** The levels of a reading, in the order of marking. */
export const LEVELS: readonly string[] = "L4 L3 L2 L1 T12 T11 T10 T9 T8 T7 T6 T5 T4 T3 T2".split(
  " ",
);
