// The course of a match that is being played, as far as its spectators or one of its seats are told of it.

import { Course, type SeatState } from "../data/course";
import { METRE, type Trails } from "../data/trails";
import { bearingOf } from "./bearing";
import { type Killer, killerOf } from "./fall";
import { type All, type Begin, FRAMES, type Moment, type Now, Rows } from "./messages";

const NOWHERE = 1e5; // m, where nobody is drawn
const GAP = 10; // frames without word of an agent after which it comes anew
const LYING = 200; // frames for which somebody is seen who died in sight
const [EYE, CHEST] = [1.5, 1]; // m over the soles
const SEEN = 300; // m, within which one aims at somebody
const [WIDE, SHARE] = [0.8, 0.015]; // m from the middle of a body, and more for each m of distance
const KEPT = 100; // frames for which sightings are kept

export abstract class LiveCourse extends Course {
  private readonly boxes = new Map<number, Trails["boxes"][number]>();

  constructor(begin: Begin, track: string) {
    super(emptyTrails(begin, track));
  }

  protected take(moment: Moment): void {
    const { frame } = moment;
    for (const [seat, by] of moment.deaths ?? [])
      insert(this.events, { frame, kind: "death", seat, other: by < 0 ? null : by, amount: 0 });
    for (const [serial, x, height, z] of moment.boxes ?? [])
      this.boxes.set(serial, { x, z, height, dropped: false, quantity: 1, appears: 0, taken: null });
    for (const serial of moment.gone ?? []) this.boxes.delete(serial);
    if (moment.boxes || moment.gone) this.trails.boxes = [...this.boxes.values()];
    if (moment.target) {
      const [x, height, z] = moment.target;
      this.trails.target = { x, z, height };
    }
    if (moment.zone) this.trails.zone = [phaseOf(moment.zone)];
  }

  protected noteShot(frame: number, seat: number, end: number[], from?: SeatState): void {
    const [x, y, z] = end.map((value) => value / METRE);
    insert(this.shots, { frame, seat, x, y, z, from });
  }

  protected forgetBoxes(): void {
    this.boxes.clear();
  }
}

// What spectators see: everybody.
export class WatchedCourse extends LiveCourse {
  readonly rows = new Rows();

  learn(moment: All): void {
    if (moment.all) this.forgetBoxes();
    this.rows.take(moment);
    this.frames.push(moment.frame);
    this.samples.forEach((samples, seat) => {
      const own = this.rows.of(seat);
      const before = samples.yaw[samples.yaw.length - 1] ?? 0;
      samples.x.push(own ? METRE * own.x : METRE * NOWHERE);
      samples.z.push(own ? METRE * own.z : METRE * NOWHERE);
      samples.height.push(own ? METRE * own.y : 0);
      samples.yaw.push(own ? before + turned(own.yaw - before) : before);
      samples.pitch.push(own?.pitch ?? 0);
      samples.health.push(own?.health ?? 0);
      samples.supplies.push(own?.supplies ?? 0);
    });
    for (const [seat, ...end] of moment.shots ?? []) this.noteShot(moment.frame, seat, end);
    this.take(moment);
  }
}

interface Sighting {
  frame: number;
  state: SeatState;
}

// What the person in a seat sees. Their own state is whatever the page expects it to be.
export class SeenCourse extends LiveCourse {
  own: SeatState = unseen();
  killer: Killer | null = null; // who shot one last, if it was in sight; the dead see it where it stood
  private newest = 0;
  private readonly sightings: Sighting[][];

  constructor(
    begin: Begin,
    track: string,
    readonly seat: number,
  ) {
    super(begin, track);
    this.sightings = this.seats.map(() => []);
  }

  // now: the frame that is being drawn, when one's own shots are shown.
  learn(moment: Now, now: number): void {
    const { frame } = moment;
    this.newest = frame;
    for (const [seat, ...row] of moment.others ?? []) {
      const [x, y, z, yaw] = row.map((value) => value / METRE);
      const health = this.seats[seat].full_health;
      const state = { ...unseen(), x, y, z, yaw, health, isSafe: row[4] === 1 };
      this.sightings[seat] = this.sightings[seat].filter((each) => each.frame > frame - KEPT);
      this.sightings[seat].push({ frame, state });
    }
    if (moment.deaths?.some(([seat]) => seat === this.seat)) this.killer = killerOf(moment.killer);
    for (const other of moment.hits ?? [])
      insert(this.events, { frame: now, kind: "hit", seat: this.seat, other, amount: 0 });
    for (const [seat, x, y, z, ...end] of moment.shots ?? []) {
      if (!end.length) continue;
      const yaw = (Math.atan2(end[0] - x, end[2] - z) * 180) / Math.PI;
      const from = { ...unseen(), x: x / METRE, y: y / METRE, z: z / METRE, yaw };
      // One's own shots are shown at once, from where one is shown.
      if (seat === this.seat) this.noteShot(now, seat, end);
      else this.noteShot(frame, seat, end, from);
    }
    this.take(moment);
  }

  override at(seat: number, frame: number): SeatState {
    if (seat === this.seat) return this.own;
    if (seat === this.killer?.seat && this.own.health <= 0) return this.stateOf(this.killer);
    const all = this.sightings[seat];
    const next = all.findIndex((each) => each.frame > frame);
    const last = all[(next < 0 ? all.length : next) - 1];
    if (!last) return unseen();
    const died = this.events.some(
      (event) => event.kind === "death" && event.seat === seat && Math.abs(event.frame - last.frame) <= GAP,
    );
    if (died && frame - last.frame < LYING) return { ...last.state, health: 0 };
    if (next < 0) return this.newest - last.frame > 0 && frame > last.frame ? unseen() : last.state;
    if (all[next].frame - last.frame > GAP) return unseen();
    return between(last.state, all[next].state, (frame - last.frame) / (all[next].frame - last.frame));
  }

  // The seat that one aims at in a frame; null if it is nobody.
  aimedAt(frame: number): number | null {
    const { x, y, z, yaw, pitch } = this.own;
    const [bearing, down] = [(yaw * Math.PI) / 180, (pitch * Math.PI) / 180];
    const ahead = [Math.sin(bearing) * Math.cos(down), -Math.sin(down), Math.cos(bearing) * Math.cos(down)];
    let [nearest, found]: [number, number | null] = [SEEN, null];
    for (let seat = 0; seat < this.seats.length; seat++) {
      if (seat === this.seat || !this.sightings[seat].length) continue;
      const other = this.at(seat, frame);
      const way = [other.x - x, other.y + CHEST - y - EYE, other.z - z];
      const far = way[0] * ahead[0] + way[1] * ahead[1] + way[2] * ahead[2];
      const off = Math.hypot(...way.map((part, axis) => part - far * ahead[axis]));
      if (other.health > 0 && far > 0 && far < nearest && off < WIDE + SHARE * far)
        [nearest, found] = [far, seat];
    }
    return found;
  }

  private stateOf({ seat, x, y, z }: Killer): SeatState {
    const { bearing } = bearingOf({ x, z }, this.own);
    return { ...unseen(), x, y, z, yaw: bearing, health: this.seats[seat].full_health };
  }
}

// An angle in degrees as the equal one in (-180, 180].
export function turned(angle: number): number {
  return 180 - ((((180 - angle) % 360) + 360) % 360);
}

// Insert an entry into a list in the order of frames, whose last entries alone may be later.
function insert<T extends { frame: number }>(list: T[], entry: T): void {
  let place = list.length;
  while (place > 0 && list[place - 1].frame > entry.frame) place--;
  list.splice(place, 0, entry);
}

function between(from: SeatState, to: SeatState, share: number): SeatState {
  const mixed = (name: "x" | "y" | "z") => from[name] + share * (to[name] - from[name]);
  const yaw = from.yaw + share * turned(to.yaw - from.yaw);
  return { ...to, x: mixed("x"), y: mixed("y"), z: mixed("z"), yaw };
}

function unseen(): SeatState {
  return { x: NOWHERE, y: 0, z: NOWHERE, yaw: 0, pitch: 0, health: 1, supplies: 0 };
}

function phaseOf([start, end, ...rest]: number[]): Trails["zone"][number] {
  const circle = (at: number) => ({ x: rest[at], z: rest[at + 1], radius: rest[at + 2] });
  return { start, end, before: circle(0), after: circle(3) };
}

function emptyTrails(begin: Begin, track: string): Trails {
  return {
    version: 0, // of no file
    over: false,
    delay: 0,
    track,
    title: track,
    frames_per_second: FRAMES,
    frames: 0,
    frame_limit: begin.frame_limit,
    ending: "none",
    outcome: "",
    target: null,
    seats: begin.seats,
    samples: { frames: [], seats: [] },
    shots: { frames: [], seats: [], x: [], z: [], height: [] },
    events: [],
    zone: [],
    boxes: [],
  };
}
