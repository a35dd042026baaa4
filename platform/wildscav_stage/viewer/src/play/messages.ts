// What the server sends to the pages of people and spectators: see sight.py, audience.py and table.py.

import type { Seat } from "../data/trails";

// What happened, and what is new, since the last moment. Lengths are cm, angles hundredths of a degree.
export interface Moment {
  number: number;
  ping: number | null; // ms
  frame: number;
  deaths?: [number, number][]; // who, and by whom or -1
  boxes?: number[][]; // serial, x, y, z
  gone?: number[];
  target?: [number, number, number];
  zone?: number[];
}

export interface Now extends Moment {
  kind: "now";
  input: number; // the last one that took effect
  ahead?: [number, number]; // degrees, right and down, that inputs so far turn and the body has yet to
  own: number[]; // as ownOf reads it
  others?: number[][]; // seat, x, y, z, yaw, and 1 if nobody can hurt it
  shots?: number[][]; // seat, x, y, z of its soles, and where the shot ended if that is known: x, y, z
  hits?: number[];
  hurt?: number[];
  killer?: number[]; // who shot one in sight: seat, x, y, z, and its health if that is told
  gained?: number;
}

export interface All extends Moment {
  kind: "all";
  all?: 1; // whether this is everything, and not what is new
  agents?: number[][]; // seat and row
  moved?: number[][]; // seat, bits of the numbers of its row that have changed, and by how much each has
  left?: number[]; // seats
  shots?: number[][]; // seat, and where the shot ended: x, y, z
}

export interface Person {
  seat: number;
  name: string;
  where: "here" | "away" | "expected";
  host: boolean;
  ready: boolean; // whether they want the next match to start
}

// How guests come; the code is empty if they do not.
export interface Room {
  code: string;
  link: string;
  seconds: number; // that the code is still valid
}

export interface People {
  kind: "people";
  people: Person[];
  spectators: number;
  opponents: string[]; // the names of all seats that are not people's
  robots: string[]; // those of them that the host chooses
  new_map: boolean; // whether the next match is on another one
  room?: Room | null;
  links?: Record<string, string>;
  watch_link?: string;
  local_only?: boolean;
}

export interface Table {
  kind: "table";
  track: string;
  title: string;
  names: string[];
  people: number;
  seat: number | null;
  may_pause: boolean;
  stand_in: string;
  is_range: boolean; // whether the others are targets
  kinds: string[]; // of robots that the host may choose
  delay: number; // s after which spectators see a match
}

export interface Metric {
  title: string;
  unit: string;
}

export interface ScoreRow {
  seat: number;
  name: string;
  values: (number | null)[]; // null: nothing to tell
}

export interface Rules {
  water_speed_factor: number;
  turn_speed: number; // degrees a second
  fire_interval: number; // s
  supply_sight: number; // m
  reload_time: number; // s
  view_angle: number; // degrees across
}

export interface Begin {
  kind: "begin";
  paused: boolean;
  map: string; // its key, another one for another map
  weapon: boolean;
  supplies: boolean;
  metrics: Metric[];
  seats: (Seat & { mark?: string })[]; // mark: how a person tells its team
  frame_limit: number;
  frames_per_action: number; // of a step, after each of which moments are told
  rules: Rules;
}

export interface Over {
  kind: "over";
  ending: string;
  time: number;
  metrics: Metric[];
  rows: ScoreRow[];
  played: number[]; // the seats of people who took part
  next: string; // what the button says that starts the next match; empty if there is none
  match: { secret: string; record: string | null }; // the name of its record, if it can be downloaded
  record?: string;
  commands?: string[];
}

export type Message =
  | Now
  | All
  | People
  | Table
  | Begin
  | Over
  | { kind: "refused" | "failed"; message: string }
  | { kind: "lobby" | "preparing" | "elsewhere" }
  | { kind: "countdown"; seconds: number }
  | { kind: "paused"; paused: boolean }
  | { kind: "scores"; rows: ScoreRow[] };

// A page does something for some kinds of messages.
export type Handlers = { [M in Message as M["kind"]]?: (message: M) => void };

export const FRAMES = 50; // a second
export const [ON_GROUND, IN_WATER, CAN_PICK_UP] = [1, 2, 4]; // flags

// The rows of agents as spectators are told them, in which velocities and flags are missing.
export class Rows {
  private readonly rows = new Map<number, number[]>();

  take(moment: All): void {
    if (moment.all) this.rows.clear();
    for (const [seat, ...row] of moment.agents ?? []) this.rows.set(seat, row);
    for (const seat of moment.left ?? []) this.rows.delete(seat);
    for (const [seat, bits, ...changes] of moment.moved ?? []) {
      const before = this.rows.get(seat) ?? [];
      let next = 0;
      this.rows.set(
        seat,
        before.map((value, place) => value + (bits & (1 << place) ? changes[next++] : 0)),
      );
    }
  }

  // What is told of a seat; null if it is not in the match.
  of(seat: number): Own | null {
    const row = this.rows.get(seat);
    return row ? ownOf([...row.slice(0, 5), 0, 0, 0, 0, ...row.slice(5)]) : null;
  }
}

// A seat in full. Lengths are m, angles degrees, times frames.
export interface Own {
  x: number;
  y: number;
  z: number;
  yaw: number;
  pitch: number;
  velocity: [number, number, number];
  flags: number;
  health: number;
  clip: number;
  spare: number;
  supplies: number;
  reload: number;
  respawn: number;
  invincible: number;
}

export function ownOf(row: number[]): Own {
  const [x, y, z, yaw, pitch, east, up, north] = row.slice(0, 8).map((value) => value / 100);
  const [flags, health, clip, spare, supplies, reload, respawn, invincible] = row.slice(8);
  const velocity: Own["velocity"] = [east, up, north];
  return { x, y, z, yaw, pitch, velocity, flags, health, clip, spare, supplies, reload, respawn, invincible };
}
