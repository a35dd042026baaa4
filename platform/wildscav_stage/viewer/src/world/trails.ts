// Where each seat was some seconds before, for the view from above.

import type { Course } from "../data/course";
import type { Lines } from "./lines";

const METRE = 100; // units of the document
const PIECE = 2; // samples from one end of a line to the other
const LEAP = 6 * METRE; // between its ends beyond what anyone walks: a respawn
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
    for (let at = last, from = at; at > first; at = from) {
      from = Math.max(first, PIECE * Math.floor((at - 1) / PIECE)); // so that old lines stay the same
      if (health[at] <= 0 || Math.abs(x[at] - x[from]) + Math.abs(z[at] - z[from]) > LEAP) continue;
      lines.add(
        x[from] / METRE,
        height[from] / METRE + ABOVE,
        z[from] / METRE,
        x[at] / METRE,
        height[at] / METRE + ABOVE,
        z[at] / METRE,
        color,
        opacity(from),
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
