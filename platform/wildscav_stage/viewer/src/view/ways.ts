// The ways that seats have gone, as lines between samples, for views from above.

import type { Course } from "../data/course";

const MOST = 4000; // lines; where there are more, samples are left out
const OPACITY = 0.9; // of the newest line

export interface Way {
  seat: number;
  from: number; // sample
  to: number; // sample
  fromOpacity: number;
  toOpacity: number;
}

// Tells the lines of some seconds before a frame; the same list, until it is another.
export function createWays(course: Course): (frame: number, seconds: number) => Way[] {
  let [known, knownFirst, knownLast] = [{} as object, 0, 0];
  let ways: Way[] = [];
  return (frame, seconds) => {
    const last = course.sampleAt(frame);
    const first = course.sampleAt(frame - seconds * course.trails.frames_per_second);
    if (known === course.trails && knownFirst === first && knownLast === last) return ways;
    [known, knownFirst, knownLast] = [course.trails, first, last];
    ways = course.seats.flatMap((_, seat) => waysOf(course, seat, first, last));
    return ways;
  };
}

function waysOf(course: Course, seat: number, first: number, last: number): Way[] {
  const step = stepOf(last - first, course.seats.length);
  const opacity = (sample: number) => (OPACITY * (sample - first)) / (last - first);
  const ways: Way[] = [];
  for (let to = last, from = to; to > first; to = from) {
    from = Math.max(first, step * Math.floor((to - 1) / step)); // so that old lines stay the same
    if (isWalked(course, seat, from, to))
      ways.push({ seat, from, to, fromOpacity: opacity(from), toOpacity: opacity(to) });
  }
  return ways;
}

// How many samples a line spans. Doubled, it has its ends where it had them before.
function stepOf(samples: number, seats: number): number {
  let step = 1;
  while ((samples / step) * seats > MOST) step *= 2;
  return step;
}

function isWalked(course: Course, seat: number, from: number, to: number): boolean {
  const { health } = course.samples[seat];
  for (let sample = from + 1; sample <= to; sample++)
    if (health[sample] <= 0 || course.leaps(sample, seat)) return false;
  return true;
}
