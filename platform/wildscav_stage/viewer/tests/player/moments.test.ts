import { expect, test } from "vitest";
import type { MatchEvent } from "../../src/data/trails";
import { describe, feedAt, jumpFrom, stepFrom } from "../../src/player/moments";
import { course, event } from "../matches";

test.each<[MatchEvent, string]>([
  [event(0, "hit", 0, 1), "agent 0 hits agent 1, 1 hp left"],
  [event(0, "death", 0, 1), "agent 0 dies, shot by agent 1"],
  [event(0, "out", 0), "agent 0 is out"],
  [event(0, "respawn", 1), "agent 1 is back"],
  [event(0, "pick_up", 0), "agent 0 picks up 1 supply"],
  [{ ...event(0, "pick_up", 0), amount: 3 }, "agent 0 picks up 3 supplies"],
  [event(0, "target", 1), "agent 1 reaches the target"],
  [{ ...event(0, "note", 1), text: "I hide." }, "agent 1: I hide."],
  [event(0, "zone"), "The safe zone begins to shrink"],
  [{ ...event(0, "zone"), amount: 0 }, "The safe zone stands still"],
])("%o is a sentence", (happened, sentence) => {
  expect(describe(happened, course([[0], [0]]))).toBe(sentence);
});

test("jumps lead to events that are worth it, one second apart", () => {
  const events = [
    event(50, "hit", 0, 1),
    event(60, "pick_up", 0),
    event(80, "hit", 0, 1),
    event(200, "death", 1, 0),
  ];
  expect(jumpFrom(events, 0, 1, 50)).toBe(events[0]);
  expect(jumpFrom(events, 50, 1, 50)).toBe(events[3]);
  expect(jumpFrom(events, 200, -1, 50)).toBe(events[2]);
  expect(jumpFrom(events, 80, -1, 50)).toBeUndefined();
  expect(jumpFrom(events, 200, 1, 50)).toBeUndefined();
});

test("where nothing else happens, jumps lead to whatever is listed", () => {
  const picked = event(60, "pick_up", 0);
  expect(jumpFrom([picked], 0, 1, 50)).toBe(picked);
  expect(jumpFrom([], 0, 1, 50)).toBeUndefined();
});

test("the feed has the latest deaths, and only those of the last frames", () => {
  const events = [
    event(10, "death", 0, 1),
    event(20, "hit", 0, 1),
    event(100, "out", 0),
    event(101, "out", 1),
  ];
  const match = course(
    [
      [0, 0, 0],
      [0, 0, 0],
    ],
    events,
  );
  expect(feedAt(match, 100, 250, 4)).toEqual([events[0], events[2]]);
  expect(feedAt(match, 120, 50, 4)).toEqual([events[2], events[3]]);
  expect(feedAt(match, 120, 250, 1)).toEqual([events[3]]);
});

test("steps lead from sample to sample, and stay in the match", () => {
  const match = course([[0, 0]]);
  expect(stepFrom(match, 0, 1)).toBe(5);
  expect(stepFrom(match, 7, 1)).toBe(10);
  expect(stepFrom(match, 7, -1)).toBe(5);
  expect(stepFrom(match, 5, -1)).toBe(0);
  expect(stepFrom(match, 0, -1)).toBe(0);
  expect(stepFrom(match, 100, 1)).toBe(100);
});
