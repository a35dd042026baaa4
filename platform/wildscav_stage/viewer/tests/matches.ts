// Small matches for tests.

import { Course } from "../src/data/course";
import type { EventKind, MatchEvent, Seat, SeatSamples, Trails } from "../src/data/trails";

export function seat(number: number, name = `agent ${number}`): Seat {
  const colors = [0, 1, 2].map((): [number, number, number] => [255, 75, 51]);
  return { seat: number, name, kind: "submission", team: number, colors, full_health: 100, result: null };
}

// Samples that change nothing but supplies: ten a second, of as many seconds as there are numbers of supplies.
export function samples(supplies: number[][], tenths = 10): { frames: number[]; seats: SeatSamples[] } {
  const count = supplies[0].length * tenths + 1;
  const constant = (value: number) => [value, ...Array<number>(count - 1).fill(0)];
  const seats = supplies.map((carried, at) => ({
    x: constant(100 * at),
    z: constant(0),
    height: constant(0),
    yaw: constant(0),
    pitch: constant(0),
    health: constant(100),
    supplies: carried.flatMap((value, second) => {
      const change = value - (carried[second - 1] ?? 0);
      return second
        ? [change, ...Array<number>(tenths - 1).fill(0)]
        : [value, ...Array<number>(tenths).fill(0)];
    }),
  }));
  return { frames: [0, ...Array<number>(count - 1).fill(50 / tenths)], seats };
}

export function trails(
  supplies: number[][],
  events: MatchEvent[] = [],
  others: Partial<Trails> = {},
): Trails {
  return {
    version: 3,
    over: true,
    delay: 0,
    track: "battle",
    title: "Supply battle",
    frames_per_second: 50,
    frames: 50 * supplies[0].length,
    frame_limit: 9000,
    ending: "time_up",
    outcome: "agent 0 wins",
    target: null,
    seats: supplies.map((_, number) => seat(number)),
    samples: samples(supplies),
    shots: { frames: [], seats: [], x: [], z: [], height: [] },
    events,
    zone: [],
    boxes: [],
    ...others,
  };
}

export function event(
  frame: number,
  kind: EventKind,
  by: number | null = null,
  other: number | null = null,
): MatchEvent {
  return { frame, kind, seat: by, other, amount: 1 };
}

export function course(...match: Parameters<typeof trails>): Course {
  return new Course(trails(...match));
}
