// What agents mark: places as poles, and lines.

import type { Course } from "../data/course";
import { CLOTHES, METRE } from "../data/trails";
import type { Lines } from "./lines";

const POLE = 3; // m
const OPACITY = 0.9;
const WIDTH = 2.5; // pixels

export function showMarks(lines: Lines, course: Course, frame: number, pixelRatio: number): void {
  const marks = course.marksAt(frame);
  lines.begin(marks.reduce((count, mark) => count + Math.max(1, mark.points.length - 1), 0));
  for (const { seat, points } of marks) {
    const color = course.seats[seat].colors[CLOTHES];
    const places = points.map((point) => point.map((length) => length / METRE));
    const ends = places.length > 1 ? places : [places[0], [places[0][0], places[0][1] + POLE, places[0][2]]];
    for (let at = 1; at < ends.length; at++) {
      const [[x, y, z], [toX, toY, toZ]] = [ends[at - 1], ends[at]];
      lines.add(x, y, z, toX, toY, toZ, color, OPACITY, OPACITY, WIDTH * pixelRatio);
    }
  }
  lines.end();
}
