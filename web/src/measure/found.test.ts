import { expect, it } from "vitest";

import { clarity, leftWords, offerOf, secondsSaved } from "./found";
import { acceptable, aboutProposals, openProposals, UNSEEN, type Proposal } from "./proposals";
import { withEvents } from "./landmarks";
import { WALLS, reading } from "./reading.fixture";

/** A vertebra in the picture with this deviation in percent; the server calls those up to 15 % sure. */
const found = (level: string, sd_percent: number): Proposal => ({
  level,
  corners: [],
  sd_percent,
  sd_share: sd_percent / 100,
  is_sure: sd_percent <= 15,
});
/** Seventeen vertebrae, of which some are clear. */
const spine = (clear: number): Proposal[] =>
  Array.from({ length: 17 }, (_, index) => found(`V${index}`, index < clear ? 12 : 20));

const HOW = { way: "walls", onRequest: true } as const;

it("tells clearly found vertebrae from those to check and from completed ones", () => {
  expect([found("L4", 15), found("L4", 16)].map(clarity)).toEqual(["clear", "check"]);
  expect(clarity({ ...found("L4", 5), sd_share: null })).toBeNull();
});

it("accepts the clearly found vertebrae together, then the next one alone", () => {
  const all = [found("L4", 20), found("L3", 15), found("L2", 9)];
  const target = { kind: "wall", level: "L4", side: "left" } as const;
  const open = openProposals(reading(), all);
  expect(acceptable(reading(), open, target, HOW)).toEqual(all.slice(1));
  expect(acceptable(reading(), open.slice(0, 1), target, HOW)).toEqual([all[0]]);
  expect(leftWords(open)).toMatch(/^To check: L4\./);
  expect(leftWords(all.slice(1))).toBe("");
});

it("replaces a found vertebra after a click on it, and keeps the others", () => {
  const all = [found("L4", 20), found("L3", 12)];
  const once = withEvents(reading(), WALLS.slice(0, 1));
  expect(openProposals(once, all)).toEqual([all[1]]);
  const completed = { ...found("L4", 8), sd_share: null };
  const vague = { ...found("L3", 30), sd_share: null };
  const twice = { ...withEvents(reading(), WALLS), proposals: [completed, vague] };
  expect(openProposals(twice, all)).toEqual([all[1], completed]);
  // Of two equal ones, one is drawn.
  const equal = { ...found("L3", 12), sd_share: null };
  expect(openProposals({ ...twice, proposals: [equal] }, all)).toEqual([all[1]]);
});

it("offers proposals only where they save time against two clicks", () => {
  // P, the answer, a look at the levels and A take as long as the clicks on the first five or six.
  expect(secondsSaved(spine(5))).toBeLessThan(0);
  expect(secondsSaved(spine(6))).toBeGreaterThan(0);
  expect(secondsSaved(spine(14))).toBeCloseTo(7.9, 1);
  const few = spine(5);
  expect(offerOf(few, few)).toEqual({
    isSlow: true,
    words: ["Two clicks is faster", "on this film: 5 of 17 vertebrae were found clearly"],
  });
  const many = spine(14);
  expect(offerOf(many, many)).toMatchObject({
    isSlow: false,
    words: ["14 of 17 vertebrae", expect.any(String)],
  });
  expect(offerOf(many, many.slice(1))).toBeNull();
  expect(offerOf([], [])).toBeNull();
});

it("asks to check doubtful levels first", () => {
  const all = spine(14);
  const told = (are_levels_doubtful: boolean): string[] =>
    aboutProposals({
      detection: {
        ...UNSEEN,
        proposals: all,
        levels: "51 % probable",
        are_levels_doubtful,
        remarks: ["T1 left out"],
      },
      offer: null,
      proposals: all,
      misfits: [],
    }).map(({ text }) => text);
  expect(told(true)).toEqual(["Check the levels first (U, J): 51 % probable", "T1 left out"]);
  expect(told(false)).toEqual([
    "Levels: 51 % probable",
    expect.stringMatching(/^To check: V14, V15, V16\. Two clicks replace a proposal/),
    "T1 left out",
  ]);
});
