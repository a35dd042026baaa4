// The document of a match, as platform/wildscav_stage/scene/document.py describes it. Lengths are centimetres there.

const TRAILS_VERSION = 3;
export const METRE = 100; // units of the document
export const CLOTHES = 2; // the part of a body that is seen best: of its colours, the one of its team

// "note" is what an agent said, which the notes of a match have.
export type EventKind = "hit" | "death" | "out" | "respawn" | "pick_up" | "target" | "zone" | "note";

export interface MatchEvent {
  frame: number;
  kind: EventKind;
  seat: number | null;
  other: number | null;
  amount: number;
  text?: string; // of a note
}

export interface SeatResult {
  supplies: number;
  kills: number;
  deaths: number;
  shots: number;
  hits: number;
  metrics: Record<string, number>;
}

export interface Seat {
  seat: number;
  name: string;
  kind: string;
  team: number;
  colors: [number, number, number][];
  full_health: number;
  result: SeatResult | null;
}

// Lists begin with a number and go on with differences.
export type SampleName = "x" | "z" | "height" | "yaw" | "pitch" | "health" | "supplies";
export type SeatSamples = Record<SampleName, number[]>;
export type ShotName = "frames" | "seats" | "x" | "z" | "height";

export interface Circle {
  x: number;
  z: number;
  radius: number;
}

export interface ZonePhase {
  start: number;
  end: number;
  before: Circle;
  after: Circle;
}

export interface Box {
  x: number;
  z: number;
  height: number;
  dropped: boolean;
  quantity: number;
  appears: number;
  taken: number | null;
}

export interface Trails {
  version: number;
  over: boolean;
  delay: number; // s until news are sent
  track: string;
  title: string;
  frames_per_second: number;
  frames: number;
  frame_limit: number;
  ending: string;
  outcome: string;
  target: { x: number; z: number; height: number } | null;
  seats: Seat[];
  samples: { frames: number[]; seats: SeatSamples[] };
  shots: Record<ShotName, number[]>;
  events: MatchEvent[];
  zone: ZonePhase[];
  boxes: Box[];
}

// What comes next of a match that is being played. Of each box that is gone: its place among all, and the frame.
export interface News extends Pick<Trails, "samples" | "shots" | "events" | "boxes"> {
  taken: [number, number][];
}

// Read the text of a document. It throws an Error whose message a person can read.
export function readTrails(text: string): Trails {
  const trails = JSON.parse(text) as Trails;
  if (trails.version !== TRAILS_VERSION) {
    throw new Error(`this page reads matches of version ${TRAILS_VERSION}, not ${trails.version}`);
  }
  return trails;
}
