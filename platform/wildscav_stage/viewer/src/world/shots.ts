// The tracers of shots: from the muzzle to where they ended, for a moment.

import type { Course } from "../data/course";
import type { Color } from "../data/map";
import type { Lines } from "./lines";

const SEEN = 9; // frames
const MUZZLE = [0.1, 1.22, 0.45]; // m to the right, up and ahead of the soles of the shooter
const EYE = 1.5; // m over the soles
const IN_VIEW = [0.17, 0.19, 1.1]; // m to the right, down and ahead of the eye: the muzzle of one's own weapon
const COLOR: Color = [255, 236, 170];
const WIDTH = 3.5; // pixels

// hidden: the seat whose eyes see them, if they are any seat's.
export function showShots(
  lines: Lines,
  course: Course,
  frame: number,
  pixelRatio: number,
  hidden: number | null,
): void {
  const shots = course.shotsBetween(frame - SEEN, frame + 1e-6);
  lines.begin(shots.length);
  for (const shot of shots) {
    const { x, y, z, yaw, pitch } = shot.from ?? course.at(shot.seat, shot.frame);
    const [right, up, ahead] = shot.seat === hidden ? inView((pitch * Math.PI) / 180) : MUZZLE;
    const [east, north] = [Math.sin((yaw * Math.PI) / 180), Math.cos((yaw * Math.PI) / 180)];
    const left = 1 - (0.7 * (frame - shot.frame)) / SEEN;
    lines.add(
      x + right * north + ahead * east,
      y + up,
      z - right * east + ahead * north,
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

function inView(pitch: number): number[] {
  const [right, down, ahead] = IN_VIEW;
  const [sin, cos] = [Math.sin(pitch), Math.cos(pitch)];
  return [right, EYE - down * cos - ahead * sin, ahead * cos - down * sin];
}
