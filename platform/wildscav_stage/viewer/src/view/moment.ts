// What a moment of the match shows: where all seats are, and who has just been hit.

import type { Course, SeatState } from "../data/course";

const FLASH = 9; // frames that a hit is shown

export interface Moment {
  frame: number;
  states: SeatState[];
  flashes: number[]; // of each seat: 1 when it is hit, then less until 0
}

export function momentOf(course: Course, frame: number): Moment {
  const flashes = course.seats.map(() => 0);
  for (const event of course.eventsBetween(frame - FLASH, frame + 1e-6)) {
    const seat = event.kind === "hit" ? event.other : null;
    if (seat !== null) flashes[seat] = Math.max(flashes[seat], 1 - (frame - event.frame) / FLASH);
  }
  return { frame, states: course.seats.map((_, seat) => course.at(seat, frame)), flashes };
}
