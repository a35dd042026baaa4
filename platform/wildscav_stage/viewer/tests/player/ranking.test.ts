import { expect, test } from "vitest";
import { Tally } from "../../src/player/ranking";
import { course, event, seat, trails } from "../matches";

const places = (tally: Tally, frame: number) => tally.at(frame).map((each) => [each.place, each.seat.seat]);

test("supplies decide, and ties share a place", () => {
  const tally = new Tally(
    course([
      [3, 3],
      [5, 9],
      [3, 4],
    ]),
  );
  expect(places(tally, 0)).toEqual([
    [1, 1],
    [2, 0],
    [2, 2],
  ]);
  expect(places(tally, 100)).toEqual([
    [1, 1],
    [2, 2],
    [3, 0],
  ]);
});

test("kills count from when they happen", () => {
  const tally = new Tally(course([[0], [0]], [event(20, "death", 1, 0), event(30, "death", 0)]));
  const killsOf = (frame: number) => tally.at(frame).map(({ kills }) => kills);
  expect(killsOf(19)).toEqual([0, 0]);
  expect(killsOf(20)).toEqual([1, 0]);
  expect(killsOf(40)).toEqual([1, 0]);
});

test("in royale, whoever is left leads, then whoever stayed longest", () => {
  const events = [event(10, "out", 2, 1), event(20, "out", 0, 1)];
  const tally = new Tally(course([[9], [0], [9], [0]], events, { track: "royale" }));
  expect(places(tally, 5)).toEqual([
    [1, 0],
    [1, 1],
    [1, 2],
    [1, 3],
  ]);
  expect(places(tally, 30)).toEqual([
    [1, 1],
    [2, 3],
    [3, 0],
    [4, 2],
  ]);
});

test("at the end of royale, the places are the result's", () => {
  const result = { supplies: 0, kills: 0, deaths: 0, shots: 0, hits: 0 };
  const seats = [2, 1].map((placement, at) => ({
    ...seat(at),
    result: { ...result, metrics: { placement } },
  }));
  const tally = new Tally(course([[0], [0]], [], { track: "royale", seats }));
  expect(places(tally, 50)).toEqual([
    [1, 1],
    [2, 0],
  ]);
});

test("with a target, who reached it leads, and then who is near it", () => {
  const target = { x: 500, z: 0, height: 0 };
  const tally = new Tally(course([[0], [0], [0]], [event(25, "target", 0)], { track: "navigation", target }));
  expect(places(tally, 0)).toEqual([
    [1, 2],
    [2, 1],
    [3, 0],
  ]);
  expect(tally.at(0)[0].distance).toBe(3);
  expect(places(tally, 30)).toEqual([
    [1, 0],
    [2, 2],
    [3, 1],
  ]);
  expect(tally.at(30)[0]).toMatchObject({ distance: null, reached: 25 });
});

test("a match that goes on, or begins anew, is counted anew", () => {
  const match = course([[0], [0]], [event(10, "death", 1, 0)]);
  const tally = new Tally(match);
  const next = trails([[0], [0]], [event(60, "death", 1, 0)]);
  match.extend({ ...next, taken: [], samples: { frames: [55], seats: next.samples.seats.map(firsts) } });
  tally.update();
  expect(tally.at(60)[0].kills).toBe(2);
  for (const kills of [0, 3]) {
    match.begin(trails([[0], [0]], Array(kills).fill(event(20, "death", 1, 0))));
    tally.update();
    expect(tally.at(50)[0].kills).toBe(kills);
  }
});

const firsts = <Lists extends Record<string, number[]>>(lists: Lists) =>
  Object.fromEntries(Object.entries(lists).map(([name, values]) => [name, values.slice(0, 1)])) as Lists;
