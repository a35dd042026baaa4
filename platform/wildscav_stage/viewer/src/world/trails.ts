// Where each seat was some seconds before, for the view from above.

import { Group } from "three";
import type { Course } from "../data/course";
import { CLOTHES, METRE } from "../data/trails";
import type { Moment } from "../view/moment";
import { createWays, type Way } from "../view/ways";
import { Lines } from "./lines";
import type { Shared } from "./shared";

const ABOVE = 0.4; // m over the soles
const OPACITY = 0.9; // of the way since the last sample
const WIDTH = 2; // pixels
const FEW = 64; // lines that there is room for at first

export interface Trails {
  group: Group;
  show(moment: Moment, seconds: number, pixelRatio: number): void;
}

export function createTrails(course: Course, shared: Shared): Trails {
  const [old, latest] = [new Lines(shared, FEW, false), new Lines(shared, course.seats.length, false)];
  const group = new Group();
  group.add(old.mesh, latest.mesh);
  const waysIn = createWays(course);
  let [shown, shownWidth]: [Way[] | null, number] = [null, 0];
  const show = (moment: Moment, seconds: number, pixelRatio: number) => {
    const [ways, width] = [waysIn(moment.frame, seconds), WIDTH * pixelRatio];
    if (ways !== shown || width !== shownWidth) layWays(old, course, ways, width);
    [shown, shownWidth] = [ways, width];
    layLatest(latest, course, moment, seconds > 0 ? width : 0);
  };
  return { group, show };
}

function layWays(lines: Lines, course: Course, ways: Way[], width: number): void {
  lines.begin(ways.length);
  for (const { seat, from, to, fromOpacity, toOpacity } of ways) {
    const { x, z, height } = course.samples[seat];
    lines.add(
      x[from] / METRE,
      height[from] / METRE + ABOVE,
      z[from] / METRE,
      x[to] / METRE,
      height[to] / METRE + ABOVE,
      z[to] / METRE,
      course.seats[seat].colors[CLOTHES],
      fromOpacity,
      toOpacity,
      width,
    );
  }
  lines.end();
}

// From the last sample to where each seat is now.
function layLatest(lines: Lines, course: Course, { frame, states }: Moment, width: number): void {
  const last = course.sampleAt(frame);
  lines.begin(states.length);
  states.forEach((now, seat) => {
    const { x, z, height } = course.samples[seat];
    if (now.health <= 0 || !width) return;
    lines.add(
      x[last] / METRE,
      height[last] / METRE + ABOVE,
      z[last] / METRE,
      now.x,
      now.y + ABOVE,
      now.z,
      course.seats[seat].colors[CLOTHES],
      OPACITY,
      OPACITY,
      width,
    );
  });
  lines.end();
}
