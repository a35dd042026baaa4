// The events of a match: what they are called, how they look on a time line, and which comes next.

import type { Course } from "../data/course";
import type { EventKind, MatchEvent } from "../data/trails";

interface Look {
  title: string; // of the kind, for a check box
  color: string; // M. Okabe and K. Ito's, which people with any kind of colour vision tell apart
  tall: number; // share of the height of the time line
  isNotable: boolean; // whether one jumps to it, if there are such
}

export const LOOKS: Record<EventKind, Look> = {
  target: { title: "target reached", color: "#cc79a7", tall: 1, isNotable: true },
  out: { title: "eliminations", color: "#d55e00", tall: 1, isNotable: true },
  death: { title: "deaths", color: "#d55e00", tall: 1, isNotable: true },
  zone: { title: "safe zone", color: "#56b4e9", tall: 0.8, isNotable: true },
  respawn: { title: "respawns", color: "#f5f5f5", tall: 0.5, isNotable: false },
  hit: { title: "hits", color: "#f0e442", tall: 0.5, isNotable: true },
  pick_up: { title: "pick-ups", color: "#009e73", tall: 0.3, isNotable: false },
  note: { title: "what agents say", color: "#e69f00", tall: 0.4, isNotable: false },
};
export const KINDS = Object.keys(LOOKS) as EventKind[];
const APART = 1; // s between two moments that are worth a jump

// An event as a sentence without a full stop.
export function describe(event: MatchEvent, course: Course): string {
  const name = (seat: number | null) => (seat === null ? "" : course.seats[seat].name);
  const by = event.other === null ? "" : `, shot by ${name(event.other)}`;
  switch (event.kind) {
    case "hit":
      return `${name(event.seat)} hits ${name(event.other)}, ${event.amount} hp left`;
    case "death":
      return `${name(event.seat)} dies${by}`;
    case "out":
      return `${name(event.seat)} is out${by}`;
    case "respawn":
      return `${name(event.seat)} is back`;
    case "pick_up":
      return `${name(event.seat)} picks up ${counted(event.amount, "supply", "supplies")}`;
    case "target":
      return `${name(event.seat)} reaches the target`;
    case "note":
      return `${name(event.seat)}: ${event.text}`;
    case "zone":
      return event.amount ? "The safe zone begins to shrink" : "The safe zone stands still";
    default:
      return event.kind;
  }
}

export function counted(count: number, one: string, many = `${one}s`): string {
  return `${count} ${count === 1 ? one : many}`;
}

// The nearest event before or after a frame that is worth a jump; undefined if there is none.
export function jumpFrom(
  events: MatchEvent[],
  frame: number,
  direction: 1 | -1,
  framesPerSecond: number,
): MatchEvent | undefined {
  const notable = events.filter((event) => LOOKS[event.kind].isNotable);
  const wanted = notable.length ? notable : events;
  const apart = APART * framesPerSecond;
  if (direction > 0) return wanted.find((event) => event.frame >= frame + apart);
  return wanted.findLast((event) => event.frame <= frame - apart);
}

// The events for a feed over the picture: the latest that everybody wants to know, newest last.
export function feedAt(course: Course, frame: number, frames: number, most: number): MatchEvent[] {
  const isNews = (event: MatchEvent) => ["death", "out", "target"].includes(event.kind);
  return course
    .eventsBetween(frame - frames, frame + 1e-6)
    .filter(isNews)
    .slice(-most);
}

// The frame of the sample before or after a frame.
export function stepFrom(course: Course, frame: number, direction: 1 | -1): number {
  const here = course.sampleAt(frame);
  const isBetween = course.frames[here] < frame;
  const next = direction > 0 ? here + 1 : isBetween ? here : here - 1;
  return course.frames[Math.min(Math.max(0, next), course.frames.length - 1)] ?? 0;
}
