import { expect, test } from "vitest";
import { Obstacles } from "../src/view/obstacles";
import { planesOf } from "../src/view/polyhedra";
import { mapOf } from "./cube_map";

test("the planes of a solid point outwards", () => {
  const planes = planesOf(mapOf([["wall", 2, 0, 3, 1]]), 0);
  for (let at = 0; at < planes.length; at += 4) {
    const [x, y, z, offset] = planes.subarray(at, at + 4);
    expect(2.5 * x + 0.5 * y + 3.5 * z - offset).toBeCloseTo(-0.5);
  }
});

test("one looks as far as the next wall, but through furniture", () => {
  const obstacles = new Obstacles(
    mapOf([
      ["furniture", 1, 0, -1, 2],
      ["wall", 6, 0, -1, 2],
    ]),
  );
  expect(obstacles.free(0, 1, 0, [1, 0, 0], 10)).toBeCloseTo(6);
  expect(obstacles.free(0, 1, 0, [1, 0, 0], 5)).toBe(5);
  expect(obstacles.free(0, 1, 0, [-1, 0, 0], 10)).toBe(10);
  expect(obstacles.free(0, 3, 0, [1, 0, 0], 10)).toBe(10);
});

test("one does not look into the ground", () => {
  expect(new Obstacles(mapOf([])).free(0, 2, 0, [0, -1, 0], 10)).toBeLessThan(2);
});
