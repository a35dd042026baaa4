import { afterEach, expect, test, vi } from "vitest";
import { Clock } from "../../src/player/clock";
import { Loop } from "../../src/player/loop";

const FRAME = 20; // ms

afterEach(() => vi.unstubAllGlobals());

// How many pictures a player draws in ten seconds of a match that it follows live.
function picturesOf(isCalm: boolean, isCameraMoving = false): number {
  const waiting: FrameRequestCallback[] = [];
  vi.stubGlobal("window", { matchMedia: () => ({ matches: isCalm }) });
  vi.stubGlobal("document", { visibilityState: "visible", addEventListener: () => {} });
  vi.stubGlobal(
    "IntersectionObserver",
    class {
      observe() {}
    },
  );
  vi.stubGlobal("requestAnimationFrame", (callback: FrameRequestCallback) => waiting.push(callback));
  let pictures = 0;
  const clock = new Clock();
  const player = {
    isCameraMoving,
    draw: () => pictures++,
    dispose: () => {},
  };
  const loop = new Loop({} as HTMLElement, clock, player);
  clock.listen(() => loop.refresh());
  clock.isOpen = true;
  clock.followLive();
  for (let now = FRAME; now <= 10_000; now += FRAME) {
    if (now % 1000 === 0) clock.setEnd(now / 1000);
    for (const callback of waiting.splice(0)) callback(now);
  }
  return pictures;
}

test("a match that is followed live flows, but not for people who asked for less motion", () => {
  expect(picturesOf(false)).toBeGreaterThan(400);
  expect(picturesOf(true)).toBeLessThan(40);
});

test("a camera that moves is drawn in any case", () => {
  expect(picturesOf(true, true)).toBeGreaterThan(400);
});
