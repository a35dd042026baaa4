// What the page of a person expects, compared with a server that is some way off.

import { expect, test } from "vitest";
import { Clock } from "../src/play/clock";
import { TurnLimit } from "../src/play/controls";
import { SeenCourse } from "../src/play/live_course";
import { countsOfRobots } from "../src/play/lobby";
import { type Begin, FRAMES, type Now, ON_GROUND, type Own, Rows } from "../src/play/messages";
import { type Held, Prediction } from "../src/play/prediction";
import { DEFAULTS, settingsOf } from "../src/play/settings";

const RULES = {
  water_speed_factor: 0.5,
  turn_speed: 9000,
  fire_interval: 0.2,
  supply_sight: 20,
  reload_time: 2,
  view_angle: 90,
};
const OWN: Own = {
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
  const own = { ...OWN };
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

test("what the body has yet to turn of an input is seen with the input", () => {
  const prediction = new Prediction(RULES, () => 0);
  prediction.send(1, { ...STILL, turn: 20 }, 0);
  prediction.advance(STILL, PICTURE, 0);
  prediction.take({ ...OWN }, 1, 0, 20);
  expect(prediction.yaw).toBe(20);
  prediction.take({ ...OWN, yaw: 7.2 }, 2, 1, 40, [12.8, 0]);
  expect(prediction.yaw).toBe(20);
});

test("a wall that holds the body is not walked through", () => {
  const { moved } = play(walk(500), 50, 4);
  expect(Math.max(...moved.map(({ z }) => z))).toBeLessThan(4 + 2.2); // it is not known of before it is touched
  for (const { time, z } of moved) if (time > 1700) expect(Math.abs(z - 4)).toBeLessThan(0.3);
});

// Holds some keys for some ms of the page's time, picture by picture, and returns the places that are shown.
function hold(prediction: Prediction, held: Held, from: number, until: number) {
  const places: number[] = [];
  for (let time = from; time < until; time += PICTURE) {
    prediction.advance(held, PICTURE, time);
    places.push(prediction.place[2]);
  }
  return places;
}

test("the dead do not turn, and who comes back is shown there at once", () => {
  const prediction = new Prediction(RULES, () => 0);
  prediction.take({ ...OWN, yaw: 10, health: 0 }, 2, 0, 40);
  prediction.send(1, { ...STILL, turn: 30, look: 5 }, 50);
  hold(prediction, walk(0)(0), 50, 100);
  expect([prediction.yaw, prediction.pitch, prediction.place[2]]).toEqual([10, 0, 0]);
  prediction.take({ ...OWN, yaw: 90, x: 1 }, 4, 1, 100);
  expect([prediction.yaw, prediction.place[0]]).toEqual([90, 1]);
});

test("nobody moves in a pause, nor goes ahead and back after it", () => {
  const prediction = new Prediction(RULES, () => 0);
  prediction.send(1, STILL, -100);
  prediction.take(OWN, 0, 0, 0);
  prediction.take(OWN, 2, 1, 40); // 140 ms after the input that it tells of
  const before = Math.max(...hold(prediction, walk(0)(0), 40, 90));
  expect(before).toBeGreaterThan(0.4);
  prediction.pause(true);
  const during = hold(prediction, walk(0)(0), 100, 1100);
  expect(Math.max(...during)).toBeLessThanOrEqual(before);
  expect(during[during.length - 1]).toBeCloseTo(0, 3);
  prediction.pause(false);
  const after: number[] = [];
  for (let frame = 4; frame < 20; frame += 2) {
    prediction.take(OWN, frame, 1, 1020 + 20 * frame);
    after.push(...hold(prediction, STILL, 1020 + 20 * frame, 1060 + 20 * frame));
  }
  expect(Math.max(...after.map(Math.abs))).toBeLessThan(0.01);
});

test.each([
  [1 / 60, 300, 6], // a 60th of the 360° in a second
  [1 / 30, 300, 7.2], // the engine turns no farther in a frame
  [1, 300, 7.2], // nothing is saved up
  [1 / 60, -2, -2], // what is slow enough is not limited
])(
  "in pictures of %f s a turn by %f° is one by %f° at most, at 360° a second",
  (seconds, degrees, turned) => {
    const limit = new TurnLimit();
    for (let picture = 0; picture < 4; picture++)
      expect(limit.take(degrees, seconds, 360)).toBeCloseTo(turned, 9);
  },
);

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

test.each([
  [0, 0, 1], // straight at it
  [4, 0, 1], // at its shoulder
  [15, 0, null],
  [0, 30, null],
  [180, 0, null],
])("at %i° and %i° down, one aims at %o", (yaw, pitch, seat) => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.own = { x: 0, y: 0, z: 0, yaw, pitch, health: 100, supplies: 0 };
  course.learn(now(2, { others: [[1, 0, 0, 1000, 0, 0]] }), 0); // 10 m to the north
  expect(course.aimedAt(2)).toBe(seat);
  expect(course.aimedAt(60)).toBe(seat); // as long as nothing else is told
});

test("nobody aims at who is out of sight", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.own = { x: 0, y: 0, z: 0, yaw: 0, pitch: 0, health: 100, supplies: 0 };
  course.learn(now(2, { others: [[1, 0, 0, 1000, 0, 0]] }), 0);
  course.learn(now(4), 0);
  expect(course.aimedAt(4)).toBeNull();
});

test("the dead see who shot them where it stood", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.learn(now(2, { deaths: [[0, 1]], killer: [1, 300, 0, 400] }), 0);
  course.own = { x: 0, y: 0, z: 0, yaw: 0, pitch: 0, health: 0, supplies: 0 };
  expect(course.at(1, 200)).toMatchObject({ x: 3, z: 4, health: 100 });
  course.own = { ...course.own, health: 100 };
  expect(course.at(1, 200).x).toBeGreaterThan(1000);
  course.learn(now(300, { deaths: [[0, 1]] }), 0); // from behind
  course.own = { ...course.own, health: 0 };
  expect(course.at(1, 300).x).toBeGreaterThan(1000);
});

test("who dies in sight lies there for a while", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.learn(now(2, { others: [[1, 100, 0, 0, 0, 1]] }), 0);
  course.learn(now(4, { deaths: [[1, 0]] }), 0);
  expect(course.at(1, 6)).toMatchObject({ x: 1, health: 0 });
  expect(course.at(1, 400).x).toBeGreaterThan(1000);
});

test("a shot of somebody who is out of sight at once comes from where the shooter stood", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.learn(now(2, { others: [[1, 0, 0, 0, 0, 0]], shots: [[1, 100, 0, 200, 600, 100, 200]] }), 0);
  course.learn(now(4, { shots: [[1, 100, 0, 200]] }), 2);
  expect(course.shots).toMatchObject([{ frame: 2, x: 6, y: 1, z: 2, from: { x: 1, y: 0, z: 2, yaw: 90 } }]);
});

test("it is shown whom nobody can hurt", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  course.learn(now(2, { others: [[1, 0, 0, 0, 0, 1]] }), 0);
  expect(course.at(1, 2).isSafe).toBe(true);
  course.learn(now(4, { others: [[1, 0, 0, 0, 0, 0]] }), 2);
  expect(course.at(1, 4).isSafe).toBe(false);
});

test("one's own shots are shown at once, and those of others when they are drawn", () => {
  const course = new SeenCourse(BEGIN, "battle", 0);
  const shots = [
    [1, 0, 0, 0, 1, 2, 3],
    [0, 0, 0, 0, 4, 5, 6],
    [1, 0, 0, 0], // nobody saw where it ended
  ];
  course.learn(now(10, { shots }), 6);
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

test("a spectator is told of rows by what has changed of them", () => {
  const rows = new Rows();
  const moment = { kind: "all", number: 1, ping: null, frame: 4 } as const;
  rows.take({
    ...moment,
    all: 1,
    agents: [
      [0, 100, 0, 200, 9000, 0, 100, 30, 90, 5, 0, 0, 0],
      [1, ...Array(12).fill(0)],
    ],
  });
  rows.take({ ...moment, moved: [[0, 0b100001, 50, -20]], left: [1] });
  expect(rows.of(0)).toMatchObject({ x: 1.5, z: 2, yaw: 90, health: 80, clip: 30, supplies: 5 });
  expect(rows.of(1)).toBeNull();
});

test("a host can choose up to eight robots, and as many as there are", () => {
  expect(countsOfRobots(3)).toHaveLength(9);
  expect(countsOfRobots(3).slice(0, 3)).toEqual(["no robots", "1 robot", "2 robots"]);
  expect(countsOfRobots(10).at(-1)).toBe("10 robots");
});
