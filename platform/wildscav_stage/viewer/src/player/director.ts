// Whom to follow: every five seconds whoever has most to do then. A recorded match is known before it is shown.

import type { Course } from "../data/course";
import type { EventKind, MatchEvent } from "../data/trails";

const SCENE = 5; // s between two cuts, at least
const EARLY = 1; // s before what happens
const WORTH: Record<EventKind, number> = {
  target: 8,
  out: 6,
  death: 6,
  hit: 3,
  pick_up: 0.4,
  respawn: 0.1,
  zone: 0,
  note: 0,
};
const LOYALTY = 1.2; // times as much somebody else must have to do

export class Director {
  private scenes: number[] = []; // who is followed in each

  constructor(private readonly course: Course) {
    this.update();
  }

  // Take in the events that have come since.
  update(): void {
    const { trails, lastFrame, seats } = this.course;
    const length = SCENE * trails.frames_per_second;
    const early = EARLY * trails.frames_per_second;
    const count = Math.floor(lastFrame / length) + 1;
    // Whom one followed in the past stays as it was.
    this.scenes.length = Math.max(0, Math.min(this.scenes.length - 1, count));
    while (this.scenes.length < count) {
      const start = this.scenes.length * length;
      const events = this.course.eventsBetween(start + early, start + early + length);
      const before = this.scenes[this.scenes.length - 1] ?? seats[0]?.seat ?? 0;
      this.scenes.push(busiest(events, seats.length, before));
    }
  }

  // The seat to follow in a frame.
  at(frame: number): number {
    const scene = Math.floor(frame / (SCENE * this.course.trails.frames_per_second));
    return this.scenes[Math.min(scene, this.scenes.length - 1)] ?? 0;
  }
}

// The seat for which most happens in some events; whom one followed before, unless another has clearly more.
function busiest(events: MatchEvent[], seats: number, before: number): number {
  const worth = Array<number>(seats).fill(0);
  for (const { kind, seat, other } of events) {
    // Who shot is worth more than who was shot, and stays to be followed.
    const killer = kind === "death" || kind === "out" ? other : null;
    if (killer !== null) worth[killer] += WORTH[kind];
    if (seat !== null) worth[seat] += killer === null ? WORTH[kind] : WORTH[kind] / 2;
    if (kind === "hit" && other !== null) worth[other] += WORTH.hit / 2;
  }
  const most = worth.indexOf(Math.max(...worth));
  return worth[most] > LOYALTY * worth[before] ? most : before;
}
