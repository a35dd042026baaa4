// The course of a match: what its document says about any moment. Lengths are metres, angles degrees, times frames.

import type { Note } from "./notes";
import {
  type Box,
  type Circle,
  type MatchEvent,
  METRE,
  type News,
  type SampleName,
  type Seat,
  type ShotName,
  type Trails,
} from "./trails";

const LEAP = 0.4; // m a frame beyond what anyone walks: a respawn
const SAMPLES: SampleName[] = ["x", "z", "height", "yaw", "pitch", "health", "supplies"];
const SHOTS: ShotName[] = ["frames", "seats", "x", "z", "height"];

export interface SeatState {
  x: number;
  y: number; // of the soles
  z: number;
  yaw: number; // 0 faces north, grows clockwise
  pitch: number; // positive looks down
  health: number; // hp, 0 = dead
  supplies: number;
  isSafe?: boolean; // whether nobody can hurt it, as far as that is told
}

export interface Shot {
  frame: number;
  seat: number;
  x: number; // where it ended
  y: number;
  z: number;
  from?: SeatState; // the shooter, if that is not who the course has in this frame
}

export class Course {
  readonly seats: Seat[];
  readonly frames: number[] = [];
  readonly shots: Shot[] = [];
  private marks: Note[] = [];
  events: MatchEvent[] = [];
  trails: Trails;
  readonly samples: Record<SampleName, number[]>[]; // of each seat, as in the document but without differences

  // names: of seats, as a page knows them; records have those under which submissions were entered.
  constructor(trails: Trails, names: Record<number, string> = {}) {
    this.trails = trails;
    this.seats = trails.seats.map((seat) => ({ ...seat, name: names[seat.seat] ?? seat.name }));
    this.samples = this.seats.map(() => emptied(SAMPLES));
    this.add(trails);
  }

  // Begin anew, with another document of the same match.
  begin(trails: Trails): void {
    this.frames.length = this.shots.length = this.events.length = 0;
    for (const samples of this.samples) for (const name of SAMPLES) samples[name].length = 0;
    this.trails = trails;
    this.add(trails);
  }

  // Add what comes next of a match that is being played.
  extend(news: News): void {
    this.add(news);
    const { boxes } = this.trails;
    for (const box of news.boxes) boxes.push(box);
    for (const [place, frame] of news.taken) boxes[place].taken = frame;
    this.trails.frames = this.lastFrame;
  }

  // Add what agents said, as events, and drew.
  addNotes(notes: Note[]): void {
    this.marks = notes.filter((note) => note.name && note.value === null);
    const said = notes.filter((note) => note.text);
    const events = said.map(({ frame, seat, text }): MatchEvent => {
      return { frame, kind: "note", seat, other: null, amount: 0, text };
    });
    this.events = [...this.events, ...events].sort((one, other) => one.frame - other.frame);
  }

  // The marks in a frame: of each seat and name, the last one.
  marksAt(frame: number): Note[] {
    const shown = new Map<string, Note>();
    for (const note of this.marks) if (note.frame <= frame) shown.set(`${note.seat} ${note.name}`, note);
    return [...shown.values()].filter((note) => note.points.length);
  }

  get lastFrame(): number {
    return this.frames[this.frames.length - 1] ?? 0;
  }

  seconds(frame: number): number {
    return frame / this.trails.frames_per_second;
  }

  // The last sample that is not after a frame.
  sampleAt(frame: number): number {
    return Math.max(0, countUntil(this.frames, (each) => each, frame) - 1);
  }

  // The events from one frame on and before another.
  eventsBetween(first: number, end: number): MatchEvent[] {
    const at = (frame: number) => countUntil(this.events, (event) => event.frame, frame - 1e-9);
    return this.events.slice(at(first), at(end));
  }

  // The shots from one frame on and before another.
  shotsBetween(first: number, end: number): Shot[] {
    const at = (frame: number) => countUntil(this.shots, (shot) => shot.frame, frame - 1e-9);
    return this.shots.slice(at(first), at(end));
  }

  // Where a seat is in a frame, and how it fares. Between two samples, places and angles are interpolated.
  at(seat: number, frame: number): SeatState {
    const samples = this.samples[seat];
    const here = this.sampleAt(frame);
    const next = Math.min(here + 1, this.frames.length - 1);
    const length = this.frames[next] - this.frames[here];
    const share = length > 0 && !this.leaps(next, seat) ? clamped((frame - this.frames[here]) / length) : 0;
    const between = (name: SampleName) =>
      samples[name][here] + share * (samples[name][next] - samples[name][here]);
    return {
      x: between("x") / METRE,
      y: between("height") / METRE,
      z: between("z") / METRE,
      yaw: between("yaw"),
      pitch: between("pitch"),
      health: samples.health[here],
      supplies: samples.supplies[here],
    };
  }

  // Whether a seat came to a sample by a respawn, and not on its feet.
  leaps(sample: number, seat: number): boolean {
    const { x, z } = this.samples[seat];
    const most = LEAP * METRE * (this.frames[sample] - this.frames[sample - 1]);
    return (x[sample] - x[sample - 1]) ** 2 + (z[sample] - z[sample - 1]) ** 2 > most * most;
  }

  // The boxes that lie on the map in a frame, lengths in centimetres.
  boxesAt(frame: number): Box[] {
    return this.trails.boxes.filter(
      (box) => box.appears <= frame && (box.taken === null || box.taken > frame),
    );
  }

  // The safe zone in a frame and the next circle, in metres; null if there is no zone.
  zoneAt(frame: number): { now: Circle; next: Circle } | null {
    const { zone } = this.trails;
    if (!zone.length) return null;
    const phase = zone.find((each) => frame < each.end) ?? zone[zone.length - 1];
    const share = clamped((frame - phase.start) / Math.max(1, phase.end - phase.start));
    const at = (name: keyof Circle) => phase.before[name] + share * (phase.after[name] - phase.before[name]);
    return { now: circle({ x: at("x"), z: at("z"), radius: at("radius") }), next: circle(phase.after) };
  }

  private add(trails: Omit<News, "taken">): void {
    addSums(this.frames, trails.samples.frames);
    trails.samples.seats.forEach((samples, seat) => {
      for (const name of SAMPLES) addSums(this.samples[seat][name], samples[name]);
    });
    const columns = SHOTS.map((name) => addSums([], trails.shots[name]));
    for (let place = 0; place < columns[0].length; place++) {
      const [frame, seat, x, z, y] = columns.map((column) => column[place]);
      this.shots.push({ frame, seat, x: x / METRE, y: y / METRE, z: z / METRE });
    }
    for (const event of trails.events) this.events.push(event);
  }
}

function emptied(names: SampleName[]): Record<SampleName, number[]> {
  return Object.fromEntries(names.map((name) => [name, [] as number[]])) as Record<SampleName, number[]>;
}

// Add what differences sum up to; in a loop, since a call takes no more than some 100,000 arguments.
function addSums(list: number[], differences: number[]): number[] {
  let sum = 0;
  for (const difference of differences) {
    sum += difference;
    list.push(sum);
  }
  return list;
}

function clamped(share: number): number {
  return Math.min(1, Math.max(0, share));
}

function circle({ x, z, radius }: Circle): Circle {
  return { x: x / METRE, z: z / METRE, radius: radius / METRE };
}

// The number of entries whose key is at most a value, in a list in ascending order of its keys.
function countUntil<T>(list: T[], keyOf: (entry: T) => number, value: number): number {
  let low = 0;
  let high = list.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (keyOf(list[middle]) <= value) low = middle + 1;
    else high = middle;
  }
  return low;
}
