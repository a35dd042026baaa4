// What a person reads and sees of their death.

import { expect, test } from "vitest";
import { Hits, killerOf, turnedTo, wordsOf } from "../src/play/fall";
import type { Now } from "../src/play/messages";

const HERE = { x: 0, z: 0 };
const hits = (given: number[], hurt: number[]) => {
  const noted = new Hits();
  noted.note({ hits: given, hurt } as unknown as Now);
  return noted;
};

test("who was in view is told with distance, and health where it is told", () => {
  const duel = hits([2, 2, 3], [2, 2, 2, 2, 2]);
  expect(wordsOf("Ada", killerOf([2, 300, 0, 400, 60]), HERE, duel, 2)).toEqual([
    "Ada shot you from 5 m away, and has 60 health left.",
    "Hits on you: 5. Yours on Ada: 2.",
  ]);
  expect(wordsOf("Ada", killerOf([2, 300, 0, 400]), HERE, duel, 2)[0]).toBe("Ada shot you from 5 m away.");
});

test("of who was not in view, no place is told", () => {
  expect(wordsOf("Ada", killerOf(undefined), HERE, hits([], [1]), 1)).toEqual([
    "Ada shot you from outside your view.",
    "Hits on you: 1. Yours on Ada: 0.",
  ]);
});

test("hits are those since one came to life", () => {
  const duel = hits([1], [1]);
  duel.forget();
  expect(duel.with(1)).toEqual({ given: 0, taken: 0 });
});

test("the view turns to the killer the short way, and stays there", () => {
  const killer = { seat: 1, x: -10, y: 0, z: 0, health: null };
  const from = { ...HERE, y: 0, yaw: 190, pitch: 20 };
  expect(turnedTo(killer, from, 0)).toEqual({ yaw: 190, pitch: 20 });
  const after = turnedTo(killer, from, 5000);
  expect(after.yaw).toBeCloseTo(270);
  expect(after.pitch).toBeCloseTo(1.7, 1); // down from the eye to the chest
  expect(turnedTo({ ...killer, x: 0, z: 10 }, { ...from, yaw: 350 }, 5000).yaw).toBeCloseTo(360);
});
