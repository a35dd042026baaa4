// How the agent in JavaScript walks and decodes; run by test_homing_js.py with Node's own test runner.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Steering } from "../../../submissions/homing-js/steering.js";
import { decodeTensors } from "../../../submissions/homing-js/tensors.js";

const FAR = 8; // m; what the ring reads where nothing is near
const GOAL = { x: 0, y: 0, z: 30 }; // north of the start

/** An observation at a place, facing `yaw`, with a wall of so many degrees to both sides of a direction. */
function observe({ x = 0, z = 0, yaw = 0, wall = null, halfWidth = 60, away = 2, inWater = false } = {}) {
  const numbers = new Float32Array(72).fill(FAR);
  if (wall !== null) {
    numbers.forEach((_, column) => {
      const beside = ((yaw + column * 5 - wall + 540) % 360) - 180; // degrees from the middle of the wall
      if (Math.abs(beside) < halfWidth) {
        numbers[column] = Math.min(FAR, away / Math.cos((beside * Math.PI) / 180));
      }
    });
  }
  const sensors = { lidar: { shape: [1, 72], numbers } };
  return { position: { x, y: 0, z }, yaw, in_water: inWater, sensors };
}

function stay(steering, steps, where = {}) {
  return Array.from({ length: steps }, () => steering.toward(observe(where), GOAL));
}

test("a free way is walked straight", () => {
  assert.deepEqual(new Steering().toward(observe(), GOAL), { direction: 0, jump: false });
});

test("a wall behind or beyond the goal is none of its business", () => {
  assert.equal(new Steering().toward(observe({ wall: 180 }), GOAL).direction, 0);
  assert.equal(new Steering().toward(observe({ wall: 0, away: 2 }), { x: 0, y: 0, z: 1.5 }).direction, 0);
});

for (const yaw of [0, 90, -135]) {
  test(`before a wall it turns aside as far as it must, whatever its yaw (${yaw})`, () => {
    const { direction } = new Steering().toward(observe({ wall: 0, yaw }), GOAL);
    assert.ok(direction >= 40 && direction <= 100, `${direction}`);
  });
}

test("it keeps to its side of an obstacle, even if the other one becomes shorter", () => {
  const steering = new Steering();
  const first = steering.toward(observe({ wall: -20 }), GOAL).direction;
  const second = steering.toward(observe({ x: 1, wall: 20 }), GOAL).direction;
  assert.ok(first > 0 && second > 0, `${first}, ${second}`);
});

test("a side that leads nowhere is changed", () => {
  const steering = new Steering();
  const walks = [];
  for (let step = 0; step < 70; step += 1) {
    // It moves, but never nearer to the goal.
    walks.push(steering.toward(observe({ z: [0, -1, -3, -4][step % 4], wall: 0 }), GOAL));
  }
  assert.ok(walks[0].direction > 0);
  assert.ok(walks[69].direction < 0);
});

test("who does not get on jumps, and then walks away from the direct line", () => {
  const walks = stay(new Steering(), 30);
  const firstJump = walks.findIndex((walk) => walk.jump);
  assert.equal(firstJump, 6);
  assert.equal(walks[firstJump].direction, 0);
  assert.ok(walks.some((walk) => Math.abs(walk.direction) >= 60));
});

test("wading at half the speed is no reason to jump", () => {
  const steering = new Steering();
  for (let step = 0; step < 30; step += 1) {
    assert.equal(steering.toward(observe({ z: step * 0.15, inWater: true }), GOAL).jump, false);
  }
});

test("the same observations give the same walk", () => {
  assert.deepEqual(stay(new Steering(), 200), stay(new Steering(), 200));
});

test("readings are decoded by their type, wherever their bytes begin in the message", () => {
  const message = Buffer.alloc(13);
  message.writeFloatLE(1.5, 1);
  message.writeFloatLE(-2, 5);
  message.writeFloatLE(8, 9);
  const data = message.subarray(1); // no multiple of four
  const { lidar } = decodeTensors([{ name: "lidar", dtype: "<f4", shape: [1, 3], data }]);
  assert.deepEqual(lidar, { shape: [1, 3], numbers: new Float32Array([1.5, -2, 8]) });
});

test("an agent does not play with readings that it cannot read", () => {
  const data = Buffer.alloc(8);
  assert.throws(() => decodeTensors([{ name: "lidar", dtype: ">f2", shape: [4], data }]), /type >f2/);
  assert.throws(() => decodeTensors([{ name: "lidar", dtype: "<f4", shape: [1, 3], data }]), /8 bytes are no <f4/);
});
