import { expect, test } from "vitest";
import { grain, lattice, PERIOD } from "../src/view/noise";

test("the numbers of the noise are the engine's", () => {
  expect([grain(0, 0), grain(1, 0), grain(0, 1), grain(127, 64)]).toEqual([0, 130, 196, 205]);
  expect(lattice()[PERIOD]).toBe(grain(0, 1));
});
