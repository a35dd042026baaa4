import { expect, test } from "vitest";
import { Pace, QUALITIES } from "../src/world/pace";

function draw(pace: Pace, seconds: number, pictures: number): void {
  for (let picture = 0; picture < pictures; picture++) pace.note(seconds);
}

test("fast pictures stay as they are, and one that takes long changes nothing", () => {
  const pace = new Pace(false);
  draw(pace, 1 / 60, 100);
  pace.note(0.9);
  draw(pace, 1 / 60, 100);
  expect(pace.level).toBe(0);
});

test("slow pictures show less, down to the least", () => {
  const pace = new Pace(false);
  draw(pace, 1 / 15, 12);
  expect(pace.level).toBe(1);
  draw(pace, 0.6, 4);
  expect(pace.level).toBe(3);
  draw(pace, 0.6, 100);
  expect(pace.level).toBe(QUALITIES.length - 1);
});

test("more is tried again, but not what was too slow twice", () => {
  const pace = new Pace(false);
  for (let turn = 0; turn < 2; turn++) {
    draw(pace, 1 / 15, 12);
    expect(pace.level).toBe(1);
    draw(pace, 1 / 60, 12 * 21);
    expect(pace.level).toBe(turn === 0 ? 0 : 1);
  }
});

test("a match that nobody watches for a while is not slow", () => {
  const pace = new Pace(false);
  draw(pace, 30, 100);
  expect(pace.level).toBe(0);
});
