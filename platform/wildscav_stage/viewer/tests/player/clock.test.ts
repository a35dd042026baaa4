import { expect, test } from "vitest";
import { Clock, clockText } from "../../src/player/clock";

function clockOf(end: number): Clock {
  const clock = new Clock();
  clock.setEnd(end);
  return clock;
}

// Let seconds pass in ticks of 100 ms, from a time in ms on; returns the time after them.
function pass(clock: Clock, seconds: number, from = 0): number {
  for (let now = from; now <= from + 1000 * seconds; now += 100) clock.advance(now);
  return from + 1000 * seconds;
}

test("time passes while the match plays, at its speed", () => {
  const clock = clockOf(60);
  pass(clock, 2);
  expect(clock.seconds).toBe(0);
  clock.play();
  clock.setSpeed(4);
  pass(clock, 2);
  expect(clock.seconds).toBeCloseTo(8);
  clock.pause();
  pass(clock, 2, 5000);
  expect(clock.seconds).toBeCloseTo(8);
});

test("a page that slept does not leap", () => {
  const clock = clockOf(60);
  clock.play();
  clock.advance(0);
  clock.advance(50_000);
  expect(clock.seconds).toBe(0.25);
});

test("at the end it stops, and playing again begins anew", () => {
  const clock = clockOf(1);
  clock.play();
  pass(clock, 2);
  expect(clock.seconds).toBe(1);
  expect(clock.isRunning).toBe(false);
  clock.play();
  expect(clock.seconds).toBe(0);
});

test("one can go to any moment, but not beyond the match", () => {
  const clock = clockOf(10);
  clock.seek(-5);
  expect(clock.seconds).toBe(0);
  clock.seek(50);
  expect(clock.seconds).toBe(10);
});

test("speeds go up and down, and have ends", () => {
  const clock = clockOf(10);
  clock.changeSpeed(1);
  expect(clock.speed).toBe(2);
  for (let press = 0; press < 9; press++) clock.changeSpeed(-1);
  expect(clock.speed).toBe(0.25);
});

test("a match that is being played is followed, a little behind its newest moment", () => {
  const clock = clockOf(20);
  clock.isOpen = true;
  clock.setEnd(20);
  clock.followLive();
  expect(clock.seconds).toBe(20);
  let now = 0;
  for (let second = 21; second <= 25; second++) {
    clock.setEnd(second);
    now = pass(clock, 1, now);
  }
  expect(clock.seconds).toBeGreaterThan(24);
  expect(clock.seconds).toBeLessThan(25);
  now = pass(clock, 6, now);
  expect(clock.seconds).toBe(25);
  expect(clock.isFollowingLive).toBe(true);
});

test("a match that is played much faster than it can be watched is still followed", () => {
  const clock = clockOf(20);
  clock.isOpen = true;
  clock.followLive();
  clock.setEnd(200);
  pass(clock, 0.3);
  expect(clock.seconds).toBeGreaterThan(199);
});

test("whoever looks back is left alone, and returns by playing to the present", () => {
  const clock = clockOf(20);
  clock.isOpen = true;
  clock.followLive();
  clock.seek(19);
  clock.setEnd(20.5);
  pass(clock, 1);
  expect(clock.seconds).toBe(19);
  clock.play();
  pass(clock, 2);
  expect(clock.isFollowingLive).toBe(true);
});

test("at the end of a match that was followed, time stands still", () => {
  const clock = clockOf(20);
  clock.isOpen = true;
  clock.followLive();
  clock.setEnd(21);
  clock.close();
  pass(clock, 9);
  expect(clock.seconds).toBe(21);
  expect(clock.isFollowingLive).toBe(false);
  expect(clock.isRunning).toBe(false);
});

test("listeners hear of changes until they stop", () => {
  const clock = clockOf(10);
  let heard = 0;
  const stop = clock.listen(() => heard++);
  clock.seek(3);
  stop();
  clock.seek(4);
  expect(heard).toBe(1);
});

test("times are minutes and seconds", () => {
  expect(clockText(0)).toBe("0:00");
  expect(clockText(73.9)).toBe("1:13");
  expect(clockText(600)).toBe("10:00");
});

test("two matches that are compared have one time, which ends with the longer one", () => {
  const clock = new Clock();
  const [one, other] = [{}, {}];
  clock.setEnd(10, one);
  clock.setEnd(30, other);
  clock.seek(20);
  expect([clock.seconds, clock.end]).toEqual([20, 30]);
  clock.setEnd(12, one);
  expect(clock.end).toBe(30);
  clock.play();
  // Both draw in each frame; time passes once.
  for (let now = 0; now <= 1000; now += 100) for (const _ of [one, other]) clock.advance(now);
  expect(clock.seconds).toBeCloseTo(21);
});
