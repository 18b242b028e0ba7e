import { expect, it } from "vitest";

import { acceptable, accepting, openProposals, shifted } from "./proposals";
import { WALLS, reading } from "./reading.fixture";
import { landmarkAt, proposedAt } from "./hit";
import {
  landmarksOf,
  missingCorner,
  placeOf,
  placing,
  remaining,
  stepsAfter,
  withEvents,
  missingPedicle,
  missingWall,
  nextLandmark,
  wordsOfEvent,
  type Event,
  type ReadingView,
  type VertebraView,
} from "./landmarks";
import { UPRIGHT } from "./turn";

const VIEW = { scale: 1, aspect: 1, left: -0.5, top: -0.5, turn: UPRIGHT };

it("shows events before they are recorded", () => {
  const before = reading();
  const after = withEvents(before, [
    placing(before, { kind: "corner", level: "L4", corner: "superior_left" }, [10, 20]),
    { kind: "place_iliac_crest", side: "right", column_px: 3, row_px: 4 },
  ]);
  expect(before.vertebrae).toEqual([]);
  expect(placeOf(after, { kind: "corner", level: "L4", corner: "superior_left" })).toEqual([
    10, 20,
  ]);
  expect(placeOf(after, { kind: "crest", side: "right" })).toEqual([3, 4]);
  expect(missingCorner(after, "L4")).toEqual({
    kind: "corner",
    level: "L4",
    corner: "superior_right",
  });
});

it("places new landmarks and moves existing ones", () => {
  const landmark = { kind: "corner", level: "L4", corner: "superior_left" } as const;
  const first = placing(reading(), landmark, [1, 2]);
  expect(first.kind).toBe("place_corner");
  const placed = withEvents(reading(), [first]);
  expect(placing(placed, landmark, [3, 4]).kind).toBe("move_corner");
  expect(wordsOfEvent(placing(placed, landmark, [3, 4.26]))).toBe(
    "L4 – superior endplate, patient’s left to (3.0, 4.3) px",
  );
});

it("grabs the nearest landmark within reach", () => {
  const marked = withEvents(reading(), [
    { kind: "place_corner", level: "L4", corner: "superior_left", column_px: 100, row_px: 100 },
    { kind: "place_corner", level: "L4", corner: "superior_right", column_px: 112, row_px: 100 },
  ]);
  expect(landmarkAt(marked, VIEW, [107, 100], 10, null)).toMatchObject({
    corner: "superior_right",
  });
  expect(landmarkAt(marked, VIEW, [100, 111], 10, null)).toBeNull();
  expect(landmarksOf(marked)).toHaveLength(2);
});

/** L4 without landmarks. */
function vertebra(with_: Partial<VertebraView>): VertebraView {
  const walls = { left_px: null, right_px: null };
  const nothing = { level: "L4", corners: [], walls, pedicles: walls, complete: false } as const;
  return { ...nothing, corners: [], midpoint_px: null, axis: null, ...with_ };
}

const origin = "completed" as const;
const L4 = {
  level: "L4",
  sd_percent: 9,
  sd_share: null,
  is_sure: false,
  corners: [
    { corner: "superior_left" as const, px: [10, 10], origin },
    { corner: "superior_right" as const, px: [30, 10], origin },
    { corner: "inferior_right" as const, px: [30, 30], origin },
    { corner: "inferior_left" as const, px: [10, 30], origin },
  ],
};
const BY_WALLS = { way: "walls", onRequest: false } as const;
const offered = (of: ReadingView, how: Parameters<typeof acceptable>[3] = BY_WALLS) =>
  acceptable(of, openProposals(of, []), nextLandmark(of, how.way), how);

it("shows the proposals of vertebrae with both walls, and accepts them as one change", () => {
  const one = { ...withEvents(reading(), WALLS.slice(0, 1)), proposals: [L4] };
  expect(offered(one)).toEqual([]);
  expect(missingWall(one, "L4")).toEqual({ kind: "wall", level: "L4", side: "right" });
  const both = { ...withEvents(reading(), WALLS), proposals: [L4] };
  expect(offered(both)).toEqual([L4]);
  expect(landmarkAt(both, VIEW, [10, 20], 3, null)).toMatchObject({ kind: "wall", side: "left" });

  const event = accepting([L4]);
  expect(wordsOfEvent(event)).toBe("corners accepted of L4");
  const accepted = withEvents(both, [event]);
  expect(accepted.vertebrae).toMatchObject([{ complete: true }]);
  const corners = L4.corners.map((corner) => ({ ...corner, origin: "accepted" }));
  expect(accepted.vertebrae[0]!.corners).toEqual(expect.arrayContaining(corners));
  expect(offered(accepted)).toEqual([]);
  // The erect film and clicks on other vertebrae determine a sure one, in both ways of marking.
  const sure = { ...L4, is_sure: true };
  const unmarked = { ...reading(), proposals: [{ ...L4, level: "L3" }, sure] };
  for (const way of ["walls", "corners"] as const)
    expect(offered(unmarked, { way, onRequest: false })).toEqual([sure]);
  const move = placing(accepted, { kind: "corner", level: "L4", corner: "superior_left" }, [11, 9]);
  const moved = withEvents(accepted, [move]).vertebrae[0]!.corners;
  expect(moved.map(({ origin: how }) => how).sort()).toEqual([
    "accepted",
    "accepted",
    "accepted",
    "adjusted",
  ]);
  expect(missingWall(accepted, "L4")).toBeNull();
});

it("offers the corners of a proposal", () => {
  const corners = [{ corner: "inferior_left" as const, px: [50, 60], origin }];
  const L3 = { level: "L3", corners, sd_percent: 9, sd_share: null, is_sure: false };
  const found = proposedAt([L3], VIEW, [52, 60], 10);
  expect(found).toEqual({ kind: "corner", level: "L3", corner: "inferior_left" });
});

it("rotates an axis from its unrecorded angle", () => {
  const axis = { from_px: [0, 9], to_px: [0, 0], axis_deg: 4.2, by_hand: false, text: "" };
  const turned = withEvents({ ...reading(), vertebrae: [vertebra({ complete: true, axis })] }, [
    { kind: "set_axis", level: "L4", axis_deg: 4.3 },
  ]);
  expect(turned.vertebrae[0]!.axis).toMatchObject({ axis_deg: 4.3, by_hand: true });
});

it("removes undone events with their undos, and undos of earlier events", () => {
  const note = (text: string): Event => ({ kind: "note", text });
  const invert = (inverted: boolean): Event => ({ kind: "invert", inverted });
  const [undo, redo]: Event[] = [{ kind: "undo" }, { kind: "redo" }];
  expect(remaining([undo!, redo!])).toEqual([]);
  expect(remaining([invert(true), note("a"), undo!, invert(false)])).toEqual([
    note("a"),
    invert(false),
  ]);
  expect(remaining([invert(true), undo!, redo!])).toEqual([invert(true)]);
  expect(remaining([invert(true), undo!, invert(false), redo!])).toEqual([invert(false)]);
});

it("counts possible redos while events are being sent", () => {
  const invert: Event = { kind: "invert", inverted: true };
  const [undo, redo]: Event[] = [{ kind: "undo" }, { kind: "redo" }];
  const recorded = { undoable: 1, redoable: 2 };
  expect(stepsAfter(recorded, [])).toEqual(recorded);
  expect(stepsAfter(recorded, [redo!])).toEqual({ undoable: 2, redoable: 1 });
  expect(stepsAfter(recorded, [redo!, redo!])).toEqual({ undoable: 3, redoable: 0 });
  expect(stepsAfter(recorded, [undo!, { kind: "note", text: "a" }])).toEqual({
    undoable: 0,
    redoable: 3,
  });
  expect(stepsAfter(recorded, [redo!, invert, undo!])).toEqual({ undoable: 2, redoable: 1 });
});

it("the lateral film has its own corners, and pedicles are placed, moved and stepped through", () => {
  const frontal = reading();
  const lateral = { ...frontal, image: { ...frontal.image, is_lateral: true } };
  const corner = { kind: "corner", level: "L4", corner: "superior_anterior" };
  expect(missingCorner(lateral, "L4")).toEqual(corner);
  const pedicle = { kind: "pedicle", level: "L4", side: "left" } as const;
  const event = placing(frontal, pedicle, [10, 20]);
  const marked = withEvents(frontal, [event]);
  expect(placeOf(marked, pedicle)).toEqual([10, 20]);
  expect(landmarksOf(marked)).toEqual([pedicle]);
  expect(missingPedicle(marked, "L4")).toEqual({ ...pedicle, side: "right" });
});

it("all levels are shifted by one, marked or proposed", () => {
  const before = withEvents(reading(), [
    { kind: "place_corner", level: "L4", corner: "superior_left", column_px: 1, row_px: 2 },
    { kind: "place_corner", level: "L3", corner: "superior_left", column_px: 1, row_px: 1 },
  ]);
  const levels = (up: boolean): string[] =>
    withEvents(before, [{ kind: "shift_levels", up }]).vertebrae.map(({ level }) => level);
  expect(levels(true)).toEqual(["L3", "L2"]);
  const found = ["L4", "L2"].map((level) => ({
    level,
    corners: [],
    sd_percent: 3,
    is_sure: false,
  }));
  expect(shifted(found, before, true).map(({ level }) => level)).toEqual(["L3"]);
  expect(shifted(found, before, false).map(({ level }) => level)).toEqual(["L3"]);
});
