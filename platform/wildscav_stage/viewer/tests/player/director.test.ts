import { expect, test } from "vitest";
import { Director } from "../../src/player/director";
import { course, event, trails } from "../matches";

const quiet = Array<number>(20).fill(0);
const match = (...events: Parameters<typeof event>[]) =>
  course(
    [quiet, quiet, quiet],
    events.map((each) => event(...each)),
  );

test("somebody is followed where nothing happens", () => {
  const director = new Director(match());
  expect([0, 500, 1000].map((frame) => director.at(frame))).toEqual([0, 0, 0]);
});

test("who shoots is followed from a moment before, and afterwards until somebody else has more to do", () => {
  const director = new Director(match([300, "hit", 2, 1], [310, "death", 1, 2], [900, "pick_up", 1]));
  expect(director.at(249)).toBe(0);
  expect(director.at(250)).toBe(2);
  expect(director.at(700)).toBe(2);
  expect(director.at(800)).toBe(1);
});

test("cuts are five seconds apart", () => {
  const director = new Director(
    match([260, "hit", 0, 1], [320, "hit", 1, 2], [380, "hit", 2, 1], [480, "hit", 1, 0]),
  );
  const followed = Array.from({ length: 5 }, (_, place) => director.at(250 + 50 * place));
  expect(new Set(followed).size).toBe(1);
});

test("a match that goes on is followed on, and its past stays as it was", () => {
  const shown = match([300, "hit", 2, 1]);
  const director = new Director(shown);
  const next = trails([[0], [0], [0]], [event(1200, "hit", 1, 0)]);
  const firsts = next.samples.seats.map((lists) => {
    const entries = Object.entries(lists).map(([name, [value]]) => [name, [value]]);
    return Object.fromEntries(entries) as typeof lists;
  });
  shown.extend({ ...next, taken: [], samples: { frames: [1250], seats: firsts } });
  director.update();
  expect(director.at(300)).toBe(2);
  expect(director.at(1250)).toBe(1);
});
