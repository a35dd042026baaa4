// The tracers of shots: from the muzzle to where they ended, for a moment.

import type { Course } from "../data/course";
import type { Color } from "../data/map";
import type { Lines } from "./lines";

const SEEN = 9; // frames
const MUZZLE = [0.1, 1.22, 0.45]; // m to the right, up and ahead of the soles of the shooter
const COLOR: Color = [255, 236, 170];
const WIDTH = 3.5; // pixels

export function showShots(lines: Lines, course: Course, frame: number, pixelRatio: number): void {
  const shots = course.shotsBetween(frame - SEEN, frame + 1e-6);
  lines.begin(shots.length);
  for (const shot of shots) {
    const { x, y, z, yaw } = course.at(shot.seat, shot.frame);
    const [east, north] = [Math.sin((yaw * Math.PI) / 180), Math.cos((yaw * Math.PI) / 180)];
    const left = 1 - (0.7 * (frame - shot.frame)) / SEEN;
    lines.add(
      x + MUZZLE[0] * north + MUZZLE[2] * east,
      y + MUZZLE[1],
      z - MUZZLE[0] * east + MUZZLE[2] * north,
      shot.x,
      shot.y,
      shot.z,
      COLOR,
      0.35 * left,
      0.95 * left,
      WIDTH * pixelRatio,
    );
  }
  lines.end();
}
