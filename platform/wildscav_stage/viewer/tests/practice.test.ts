// The figures of the shooting range.

import { expect, test } from "vitest";
import type { Now } from "../src/play/messages";
import { Practice } from "../src/play/practice";

const shot = [0, 0, 0, 0];
const now = (frame: number, more: Partial<Now>) => ({ kind: "now", frame, ...more }) as Now;

test("shots, hits and the time from the first hit to the kill are counted", () => {
  const practice = new Practice(0);
  expect([practice.accuracy, practice.timeToKill]).toEqual([null, null]);
  practice.note(now(10, { shots: [shot] }));
  practice.note(now(20, { shots: [shot], hits: [2] }));
  practice.note(now(45, { shots: [shot], hits: [2], deaths: [[2, 0]] }));
  expect(practice.summary).toBe("2 of 3 shots hit (67 %)");
  expect([practice.kills, practice.timeToKill]).toEqual([1, 0.5]);
  practice.note(now(100, { shots: [shot], hits: [2] })); // it is back, and its time begins anew
  practice.note(now(150, { shots: [shot], hits: [2], deaths: [[2, 0]] }));
  expect(practice.timeToKill).toBe(0.75);
  expect(practice.rows(["you", "near", "far"])).toEqual([
    { seat: 1, name: "near", values: [0, 0, null] },
    { seat: 2, name: "far", values: [4, 2, 0.75] },
  ]);
});

test("what others shoot does not count", () => {
  const practice = new Practice(0);
  practice.note(now(10, { shots: [[1, 0, 0, 0]], deaths: [[2, 1]] }));
  expect([practice.shots, practice.kills]).toEqual([0, 0]);
  expect(practice.summary).toBe("0 of 0 shots hit");
});
