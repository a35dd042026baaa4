// The first steps: which ones there are, and when each is done.

import { expect, test } from "vitest";
import { Bindings } from "../src/play/bindings";
import { type Did, Lessons, type Needs } from "../src/play/lessons";

const NOTHING: Did = {
  ...{ turned: 0, walked: 0, jumped: false, fired: false, reloads: false, gained: false },
  ...{ target: null, seconds: 0.02 },
};
const BATTLE: Needs = { track: "battle", weapon: true, supplies: true };
const keys = new Bindings();
const words = (lessons: Lessons) => lessons.words(keys, false);

test("a step ends when it is done, and the next one comes", () => {
  const lessons = new Lessons(BATTLE, new Set());
  expect(words(lessons)).toBe("Look around with the mouse");
  expect(lessons.take({ ...NOTHING, turned: 50 })).toBe(false);
  expect(lessons.take({ ...NOTHING, walked: 9, jumped: true })).toBe(false); // that is not what was asked for
  expect(lessons.take({ ...NOTHING, turned: 50 })).toBe(true);
  expect(words(lessons)).toBe("Walk with W A S D");
});

test.each<[Partial<Needs>, string[]]>([
  [{}, ["pick_up", "shoot", "reload"]],
  [{ supplies: false }, ["shoot", "reload"]],
  [{ track: "gathering", weapon: false }, ["pick_up"]],
  [{ track: "navigation", weapon: false, supplies: false }, ["target"]],
  [{ track: "capture", weapon: false, supplies: false }, []],
  [{ track: "royale" }, ["pick_up", "shoot", "reload", "zone"]],
])("the steps of %o besides looking, walking and jumping are %o", (needs, names) => {
  const lessons = new Lessons({ ...BATTLE, ...needs }, new Set());
  lessons.skip();
  expect([...lessons.known]).toEqual(["look", "walk", "jump", ...names]);
  expect(words(lessons)).toBeNull();
});

test("what was done once is not asked for again, and the person's own keys are named", () => {
  keys.bind("jump", 0, "KeyJ");
  expect(words(new Lessons(BATTLE, new Set(["look", "walk"])))).toBe("Jump with J");
  expect(new Lessons(BATTLE, new Set(["look"])).words(keys, true)).toBe("Walk with the stick on the left");
});

test("who comes 10 m nearer to the target goes the right way", () => {
  const known = new Set(["look", "walk", "jump"]);
  const lessons = new Lessons({ track: "navigation", weapon: false, supplies: false }, known);
  const at = (target: number) => lessons.take({ ...NOTHING, target });
  expect([50, 55, 49, 46].map(at)).toEqual([false, false, false, false]); // 9 m nearer
  expect(at(45)).toBe(true);
});
