import { expect, test } from "vitest";
import { distantTriangles, floorsAmong, reducedTriangles } from "../src/world/reduced";
import { mapOf } from "./cube_map";

test("furniture is seen from nearby alone", () => {
  const map = mapOf([["furniture", 0, 0, 0, 1]]);
  expect(reducedTriangles(map, 0)).toEqual([]);
  expect(distantTriangles(map, 0, [])).toEqual([]);
});

test("a wall from afar is what looks out of its house, without top and bottom", () => {
  // The floor lies east of the wall, whose other upright faces look outside.
  const map = mapOf([
    ["wall", 0, 0, 0, 1],
    ["floor", 1, 0, -2, 5],
  ]);
  const floors = floorsAmong(map, [0, 1]);
  expect(floors).toHaveLength(1);
  expect(distantTriangles(map, 0, [])).toHaveLength(3 * 8);
  expect(distantTriangles(map, 0, floors)).toHaveLength(3 * 6);
});

test("no triangle has a corner that the solid lacks", () => {
  const map = mapOf([
    ["crown", 3, 2, 3, 2],
    ["rock", 0, 0, 0, 1],
  ]);
  for (const solid of [0, 1])
    for (const corners of [reducedTriangles(map, solid), distantTriangles(map, solid, [])])
      expect(corners.every((corner) => corner >= 0 && corner < 8)).toBe(true);
});
