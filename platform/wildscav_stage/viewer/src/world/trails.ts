// Where each seat was some seconds before, for the view from above.

import type { Course } from "../data/course";
import type { Lines } from "./lines";

const METRE = 100; // units of the document
const LEAP = 4 * METRE; // between two samples beyond what anyone walks: a respawn
const ABOVE = 0.4; // m over the soles
const TORSO = 2; // the part of a body that has the colour of its team
const OPACITY = 0.9; // of the newest part
const WIDTH = 2; // pixels

export function showTrails(
  lines: Lines,
  course: Course,
  frame: number,
  seconds: number,
  pixelRatio: number,
): void {
  const last = course.sampleAt(frame);
  const first = course.sampleAt(frame - seconds * course.trails.frames_per_second);
  lines.begin((last - first + 1) * course.seats.length);
  const opacity = (sample: number) => (OPACITY * (sample - first)) / Math.max(1, last - first);
  for (let seat = 0; seat < course.seats.length; seat++) {
    const { x, z, height, health } = course.samples[seat];
    const color = course.seats[seat].colors[TORSO];
    for (let at = first + 1; at <= last; at++) {
      if (health[at] <= 0 || Math.abs(x[at] - x[at - 1]) + Math.abs(z[at] - z[at - 1]) > LEAP) continue;
      lines.add(
        x[at - 1] / METRE,
        height[at - 1] / METRE + ABOVE,
        z[at - 1] / METRE,
        x[at] / METRE,
        height[at] / METRE + ABOVE,
        z[at] / METRE,
        color,
        opacity(at - 1),
        opacity(at),
        WIDTH * pixelRatio,
      );
    }
    const now = course.at(seat, frame);
    const end = 3;
    if (now.health > 0 && Math.hypot(now.x - x[last] / METRE, now.z - z[last] / METRE) < end)
      lines.add(
        x[last] / METRE,
        height[last] / METRE + ABOVE,
        z[last] / METRE,
        now.x,
        now.y + ABOVE,
        now.z,
        color,
        OPACITY,
        OPACITY,
        WIDTH * pixelRatio,
      );
  }
  lines.end();
}
