import { expect, test } from "vitest";
import type { Ground } from "../src/data/map";
import { heightAt, normalsOf, trianglesOf } from "../src/view/terrain";

// Two cells of 2 m, the corners of each of different height.
const GROUND: Ground = {
  rows: 2,
  columns: 3,
  cell: 2,
  corner: [-2, 4],
  heights: new Float32Array([0, 1, 2, 4, 8, 16]),
  colors: new Uint8Array(18),
};

test("the diagonal of a cell runs from south-west to north-east, as in the engine's meshes", () => {
  expect(trianglesOf(0, 3)).toEqual([0, 4, 1, 0, 3, 4]);
});

test("the height of the ground is that of the triangle that a place is in", () => {
  expect(heightAt(GROUND, -2, 4)).toBe(0);
  expect(heightAt(GROUND, 0, 6)).toBe(8);
  expect(heightAt(GROUND, -1, 5)).toBe(4); // on the diagonal: between 0 and 8
  expect(heightAt(GROUND, -0.5, 4.5)).toBe(0.75 + 0.25 * 7); // the south-eastern triangle
  expect(heightAt(GROUND, -1.5, 5.5)).toBe(0.75 * 4 + 0.25 * 4); // the north-western one
});

test("the height beyond the map is that of its edge", () => {
  expect(heightAt(GROUND, -50, 4)).toBe(0);
  expect(heightAt(GROUND, 50, 50)).toBe(16);
});

test("normals point upwards and have length 1", () => {
  const normals = normalsOf(GROUND);
  for (let at = 0; at < normals.length; at += 3) {
    expect(normals[at + 1]).toBeGreaterThan(0);
    expect(Math.hypot(...normals.subarray(at, at + 3))).toBeCloseTo(1, 6);
  }
  const steep = 1 / Math.sqrt(1 + 0.5 ** 2 + 2 ** 2); // 0.5 m per m to the east, 2 to the north
  expect(normals[1]).toBeCloseTo(steep, 6);
});
