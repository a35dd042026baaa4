// The standings of a match at a moment.

import type { Course, SeatState } from "../data/course";
import { type MatchEvent, METRE, type Seat, type Trails } from "../data/trails";

export interface Standing {
  seat: Seat;
  place: number; // from 1; ties share one
  health: number; // hp
  supplies: number;
  kills: number;
  distance: number | null; // m to the target, where there is one that was not reached
  reached: number | null; // frame in which it reached the target
}

// What ranks a seat: smaller numbers come first, the earlier before the later.
type Key = number[];

// What events say about seats, kept so that a moment takes little time.
export class Tally {
  private readonly kills: number[][];
  private readonly outs: (number | null)[];
  private readonly reached: (number | null)[];
  private counted = 0;
  private trails: Trails | null = null; // of the course when they were counted

  constructor(private readonly course: Course) {
    this.kills = course.seats.map(() => []);
    this.outs = course.seats.map(() => null);
    this.reached = course.seats.map(() => null);
    this.update();
  }

  // Take in the events that have come since, or begin anew with the match.
  update(): void {
    const { events, trails } = this.course;
    if (trails !== this.trails) this.clear();
    this.trails = trails;
    for (const event of events.slice(this.counted)) this.add(event);
    this.counted = events.length;
  }

  // The standings in a frame, best first.
  at(frame: number): Standing[] {
    const states = this.course.seats.map((seat) => this.course.at(seat.seat, frame));
    const standings = this.course.seats.map((seat) => this.standing(seat, states[seat.seat], frame));
    const keys = new Map(standings.map((standing) => [standing, this.key(standing, frame)]));
    const keyOf = (standing: Standing) => keys.get(standing) as Key;
    standings.sort((one, other) => compared(keyOf(one), keyOf(other)) || one.seat.seat - other.seat.seat);
    standings.forEach((standing, at) => {
      const before = standings[at - 1];
      const isTie = before && compared(keyOf(before), keyOf(standing)) === 0;
      standing.place = isTie ? before.place : at + 1;
    });
    return standings;
  }

  private standing(seat: Seat, state: SeatState, frame: number): Standing {
    const { target } = this.course.trails;
    const reached = upTo(this.reached[seat.seat], frame);
    const away = target && Math.hypot(target.x / METRE - state.x, target.z / METRE - state.z);
    return {
      seat,
      place: 0,
      health: state.health,
      supplies: state.supplies,
      kills: countUpTo(this.kills[seat.seat], frame),
      distance: reached === null ? away : null,
      reached,
    };
  }

  // By what the track counts: the target, who is left, or supplies.
  private key(standing: Standing, frame: number): Key {
    const { track, target, seats } = this.course.trails;
    if (target) return [standing.reached ?? Infinity, standing.distance ?? 0];
    if (track !== "royale") return [-standing.supplies];
    const placement = seats[standing.seat.seat].result?.metrics.placement;
    if (placement !== undefined && frame >= this.course.lastFrame) return [placement];
    const out = upTo(this.outs[standing.seat.seat], frame);
    return out === null ? [-Infinity, -standing.kills] : [-out];
  }

  private add(event: MatchEvent): void {
    const { kind, seat, other, frame } = event;
    if ((kind === "death" || kind === "out") && other !== null) this.kills[other].push(frame);
    if (kind === "out" && seat !== null) this.outs[seat] = frame;
    if (kind === "target" && seat !== null) this.reached[seat] ??= frame;
  }

  private clear(): void {
    this.counted = 0;
    for (const kills of this.kills) kills.length = 0;
    this.outs.fill(null);
    this.reached.fill(null);
  }
}

function compared(one: Key, other: Key): number {
  const at = one.findIndex((value, place) => value !== other[place]);
  return at < 0 ? 0 : one[at] - other[at];
}

function upTo(frame: number | null, now: number): number | null {
  return frame !== null && frame <= now ? frame : null;
}

function countUpTo(frames: number[], now: number): number {
  const after = frames.findIndex((frame) => frame > now);
  return after < 0 ? frames.length : after;
}
