// What the page of a person expects, compared with a server that is some way off.

import { expect, test } from "vitest";
import { Clock } from "../src/play/clock";
import { SeenCourse } from "../src/play/live_course";
import { type Begin, FRAMES, type Now, ON_GROUND, type Own } from "../src/play/messages";
import { type Held, Prediction } from "../src/play/prediction";
import { DEFAULTS, settingsOf } from "../src/play/settings";

const RULES = { water_speed_factor: 0.5, turn_speed: 9000, fire_interval: 0.2, supply_sight: 20 };
const STILL: Held = { forward: 0, right: 0, turn: 0, look: 0, jump: false };
const PICTURE = 1000 / 60; // ms

interface Sent {
  at: number; // ms
  number: number;
  held: Held;
}

// Plays on a plane with a wall at some z: what is held at each time, ms, is seen by the server after a delay, and
// what it tells comes after another one. Returns the prediction, and how far it moved by each picture.
function play(heldAt: (time: number) => Held, delay: number, wall = Infinity, until = 3000) {
  const prediction = new Prediction(RULES, () => 0);
  const own: Own = {
    x: 0,
    y: 0,
    z: 0,
    yaw: 0,
    pitch: 0,
    velocity: [0, 0, 0],
    flags: ON_GROUND,
    health: 100,
    clip: 15,
    spare: 60,
    supplies: 0,
    reload: 0,
    respawn: 0,
    invincible: 0,
  };
  const [sent, told]: [Sent[], { at: number; frame: number; input: number; own: Own }[]] = [[], []];
  const moved: { time: number; z: number; yaw: number }[] = [];
  let [held, taken, frame, step, picture] = [STILL, 0, 0, 7, 0];
  for (let time = 0; time < until; time++) {
    if (time >= step) {
      step += 1000 / FRAMES;
      while (sent.length && sent[0].at + delay <= time) {
        const input = sent.shift() as Sent;
        [held, taken] = [input.held, input.number];
        own.yaw += input.held.turn;
      }
      const bearing = (own.yaw * Math.PI) / 180;
      const [x, z] = [own.x, own.z];
      own.x += (held.forward * 10 * Math.sin(bearing)) / FRAMES;
      own.z = Math.min(wall, own.z + (held.forward * 10 * Math.cos(bearing)) / FRAMES);
      own.velocity = [(own.x - x) * FRAMES, 0, (own.z - z) * FRAMES];
      if (++frame % 2 === 0) told.push({ at: time + delay, frame, input: taken, own: structuredClone(own) });
    }
    while (told.length && told[0].at <= time) {
      const { frame, input, own } = told.shift() as (typeof told)[0];
      prediction.take(own, frame, input, time);
    }
    if (time < picture) continue;
    picture += PICTURE;
    const input = heldAt(time);
    const number = moved.length + 1;
    sent.push({ at: time, number, held: input });
    prediction.send(number, input, time);
    prediction.advance(input, PICTURE, time);
    moved.push({ time, z: prediction.place[2], yaw: prediction.yaw });
  }
  return { prediction, moved, truth: own };
}

const walk =
  (from: number, to = Infinity) =>
  (time: number) => ({
    ...STILL,
    forward: time >= from && time < to ? 1 : 0,
  });

test.each([0, 50, 150])("a key moves the picture at once, with %i ms each way", (delay) => {
  const { moved } = play(walk(1000), delay);
  const first = moved.find(({ z }) => z > 0.01);
  expect(first?.time).toBeLessThan(1000 + 2 * PICTURE);
});

test.each([
  [0, 0.5],
  [50, 0.5],
  [150, 0.5],
])("a walk with %i ms each way is expected to %f m", (delay, most) => {
  const { prediction, truth } = play(walk(800, 2200), delay);
  expect(prediction.errors.length).toBeGreaterThan(50);
  expect(Math.max(...prediction.errors)).toBeLessThan(most);
  expect(prediction.place[2]).toBeCloseTo(truth.z, 1);
});

test("the view turns at once, and is that of the server in the end", () => {
  const { moved, truth } = play((time) => ({ ...STILL, turn: time >= 1000 && time < 1500 ? 3 : 0 }), 50);
  const first = moved.find(({ yaw }) => yaw > 0);
  expect(first?.time).toBeLessThan(1000 + PICTURE);
  for (let at = 1; at < moved.length; at++) expect(moved[at].yaw).toBeGreaterThanOrEqual(moved[at - 1].yaw); // it never goes back
  expect(moved[moved.length - 1].yaw).toBe(truth.yaw);
});

test("a wall that holds the body is not walked through", () => {
  const { moved } = play(walk(500), 50, 4);
  expect(Math.max(...moved.map(({ z }) => z))).toBeLessThan(4 + 2.2); // it is not known of before it is touched
  for (const { time, z } of moved) if (time > 1700) expect(Math.abs(z - 4)).toBeLessThan(0.3);
});

const SEAT = { kind: "x", colors: [], full_health: 100, result: null };
const BEGIN = {
  frame_limit: 500,
  seats: [0, 1].map((seat) => ({ ...SEAT, seat, team: seat, name: `${seat}` })),
} as unknown as Begin;
const now = (frame: number, more: Partial<Now> = {}): Now => ({
  ...{ kind: "now", number: 1, ping: null, frame, input: 0, own: [] },
  ...more,
});

test("others are between their places, and nowhere out of sight", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.learn(now(2, { others: [[1, 100, 0, 0, 17900, 1]] }), 0);
  course.learn(now(4, { others: [[1, 200, 0, 0, -17900, 1]] }), 0);
  course.learn(now(6), 0);
  expect(course.at(1, 1).x).toBeGreaterThan(1000);
  expect(course.at(1, 3)).toMatchObject({ x: 1.5, yaw: 180, health: 100 });
  expect(course.at(1, 4).x).toBe(2);
  expect(course.at(1, 5).x).toBeGreaterThan(1000);
});

test("who dies in sight lies there for a while", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.learn(now(2, { others: [[1, 100, 0, 0, 0, 1]] }), 0);
  course.learn(now(4, { deaths: [[1, 0]] }), 0);
  expect(course.at(1, 6)).toMatchObject({ x: 1, health: 0 });
  expect(course.at(1, 400).x).toBeGreaterThan(1000);
});

test("one's own shots are shown at once, and those of others when they are drawn", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.learn(now(10, { shots: [[1, 1, 2, 3], [0, 4, 5, 6], [1]] }), 6);
  expect(course.shots.map(({ frame, seat }) => [frame, seat])).toEqual([
    [6, 0],
    [10, 1],
  ]);
  course.learn(now(12), 8);
  expect(course.shotsBetween(0, 7)).toHaveLength(1);
});

test("boxes come and go as they are told", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.learn(
    now(2, {
      boxes: [
        [7, 1, 2, 3],
        [8, 4, 5, 6],
      ],
    }),
    0,
  );
  course.learn(now(4, { gone: [7] }), 0);
  expect(course.boxesAt(4)).toMatchObject([{ x: 4, height: 5, z: 6 }]);
});

test("the frame that is shown runs evenly though moments come unevenly, and waits while they stay away", () => {
  const clock = new Clock(4);
  for (let frame = 2; frame <= 100; frame += 2) clock.note(frame, 20 * frame + (frame % 8 ? 0 : 15));
  const shown = clock.frame(2000);
  expect(shown).toBeGreaterThan(95);
  expect(clock.frame(2010) - shown).toBeCloseTo(0.5);
  expect(clock.frame(9000)).toBe(100);
  clock.note(102, 9040); // after a pause
  expect(clock.frame(9040)).toBeCloseTo(98);
});

test("settings are what was kept, as far as it is allowed", () => {
  expect(settingsOf("")).toEqual(DEFAULTS);
  expect(settingsOf("no JSON")).toEqual(DEFAULTS);
  expect(settingsOf('{"field": 70, "sensitivity": 99, "invert": 1}')).toEqual({ ...DEFAULTS, field: 70 });
});
