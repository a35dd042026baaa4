import { expect, test } from "vitest";
import type { Light } from "../src/data/map";
import { lit } from "../src/view/light";

const LIGHT = {
  sun: [-0.451, 0.7517, -0.4811],
  sunlight: [0.56, 0.53, 0.46],
  skylight: [0.56, 0.59, 0.64],
  direct: 0.9,
  open: [0.9, 0.3],
  side: [-0.1, -0.04],
} as Light;

test("level ground is as bright as the engine's cameras show it", () => {
  expect(lit([100, 100, 100], [0, 1, 0], LIGHT)).toEqual([105, 107, 108]);
});

test("in a shadow the light of the sky is left", () => {
  expect(lit([100, 100, 100], [0, 1, 0], LIGHT, 0)).toEqual([67, 71, 77]);
});

test("an eastern wall is away from the sun, and darker than a northern one", () => {
  expect(lit([200, 200, 200], [1, 0, 0], LIGHT)).toEqual([90, 94, 102]);
  expect(lit([200, 200, 200], [0, 0, 1], LIGHT)[0]).toBeGreaterThan(90);
});

test("no colour is brighter than white", () => {
  expect(lit([255, 255, 255], LIGHT.sun, LIGHT)).toEqual([255, 255, 255]);
});
