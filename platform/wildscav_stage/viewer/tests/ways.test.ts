import { expect, test } from "vitest";
import { createWays } from "../src/view/ways";
import { course, trails } from "./matches";

test("a way has a line between two samples, and older ones are fainter", () => {
  const ways = createWays(course([[0, 0]]))(50, 0.3);
  expect(ways.map(({ from, to }) => [from, to])).toEqual([
    [9, 10],
    [8, 9],
    [7, 8],
  ]);
  expect(ways.map(({ toOpacity }) => toOpacity)).toEqual([0.9, 0.6, 0.3].map((each) => expect.closeTo(each)));
});

test("the list is another only with another sample", () => {
  const waysIn = createWays(course([[0, 0]]));
  expect(waysIn(51, 1)).toBe(waysIn(54, 1));
  expect(waysIn(55, 1)).not.toBe(waysIn(51, 1));
});

test("however many seats there are, the lines are some thousand, and cover all of the time", () => {
  const ways = createWays(course(Array(1000).fill(Array(60).fill(0))))(3000, Infinity);
  expect(ways.length).toBeLessThanOrEqual(5000);
  expect(Math.min(...ways.map(({ from }) => from))).toBe(0);
});

test("the dead draw no line, and nobody does to where they come back", () => {
  const match = trails([[0]]);
  const [one] = match.samples.seats;
  one.health.fill(-100, 3, 4).fill(100, 5, 6);
  one.x[8] = 900;
  const lines = createWays(course([[0]], [], { samples: match.samples }))(50, Infinity);
  expect(lines.map(({ to }) => to)).toEqual([10, 9, 7, 6, 5, 2, 1]);
});
