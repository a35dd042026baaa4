// Where one looks, and where one's own body is expected to be until the server tells: for display only.
//
// The view is what the server told, and all turns that the body had not made by then. The body goes on from where it
// was told to be, by what was held since the moment that this tells of. What turns out to be wrong fades
// within some pictures.

import { FRAMES, IN_WATER, ON_GROUND, type Own, type Rules } from "./messages";

const SPEED = 10; // m/s, of a person who walks
const GRAVITY = 9.81; // m/s²
const JUMP = 5; // m/s, upwards
const KEPT = 800; // ms of what was held that are remembered
const LONGEST = 500; // ms that are expected at most
const FADING = 80; // ms in which an error fades by about two thirds
const FARTHEST = 3; // m; what is farther off is a respawn, and shown at once
const STEADY = 120; // ms for which the same must have been held before a wall is thought to be in the way
const STOPPED = 0.5; // m/s that a body is slower than it wants, from which on something is in its way

export interface Held {
  forward: number; // -1 to 1
  right: number;
  turn: number; // degrees since the last input
  look: number;
  jump: boolean;
}

type Place = [number, number, number];

interface Tick {
  end: number; // ms
  length: number; // ms
  east: number; // m/s that were wanted
  north: number;
  jump: boolean;
}

export class Prediction {
  yaw = 0;
  pitch = 0;
  place: Place = [0, 0, 0];
  lag = 0; // ms from an input to the moment that tells of it
  errors: number[] = []; // m, of the last expectations
  private own: Own | null = null;
  private ahead = [0, 0]; // degrees of the inputs taken that the body has yet to turn
  private told = 0; // ms, when what ``own`` tells was held
  private arrival = 0; // ms, when a moment of frame 0 would have come
  private newest = 0; // number of the last input that was taken
  private readonly pending = new Map<number, { sent: number; turn: number; look: number }>();
  private ticks: Tick[] = [];
  private offset: Place = [0, 0, 0]; // of what is shown from what is expected
  private isPaused = false;

  // floor: m, the height of the ground at a place.
  constructor(
    private readonly rules: Rules,
    private readonly floor: (x: number, z: number) => number,
  ) {}

  // Note an input that is sent.
  send(number: number, held: Held, now: number): void {
    this.pending.set(number, { sent: now, turn: held.turn, look: held.look });
  }

  // Note what is held for some ms until now, and go on.
  advance(held: Held, length: number, now: number): void {
    const bearing = ((this.yaw + held.turn) * Math.PI) / 180;
    const share = 1 / Math.max(1, Math.hypot(held.forward, held.right));
    const [ahead, aside] = [held.forward * share * SPEED, held.right * share * SPEED];
    const east = ahead * Math.sin(bearing) + aside * Math.cos(bearing);
    const north = ahead * Math.cos(bearing) - aside * Math.sin(bearing);
    if (!this.isPaused) this.ticks.push({ end: now, length, east, north, jump: held.jump });
    this.ticks = this.ticks.filter((tick) => tick.end > now - KEPT);
    this.offset = this.offset.map((part) => part * Math.exp(-length / FADING)) as Place;
    this.show();
  }

  // Forget what was held before a pause, and expect nothing while it lasts.
  pause(isPaused: boolean): void {
    this.isPaused = isPaused;
    this.ticks = [];
    this.pending.clear();
    this.arrival = -Infinity;
    this.slide();
  }

  // Take what the server tells of a frame before which an input was taken.
  take(own: Own, frame: number, input: number, now: number, ahead = [0, 0]): void {
    const isOther = !this.own || this.own.health <= 0 || own.health <= 0;
    const arrival = now - (1000 * frame) / FRAMES;
    const isLate = this.own && Math.abs(arrival - this.arrival) < 500;
    this.arrival = isLate ? this.arrival + 0.1 * (arrival - this.arrival) : arrival;
    this.noteTaken(input, now);
    [this.own, this.ahead] = [own, ahead];
    this.told = this.arrival + (1000 * frame) / FRAMES - this.lag;
    const error = this.slide(isOther);
    if (!isOther && error <= FARTHEST) this.errors = [...this.errors.slice(-249), error];
  }

  // Go from what was shown to what is expected now, by and by unless that is far off or at once is asked for. Returns
  // how far it is, m.
  private slide(atOnce = false): number {
    const before = this.place;
    this.offset = [0, 0, 0];
    this.show();
    const offset = this.place.map((part, axis) => before[axis] - part) as Place;
    const error = Math.hypot(...offset);
    if (!atOnce && error <= FARTHEST) [this.offset, this.place] = [offset, before];
    return error;
  }

  private noteTaken(input: number, now: number): void {
    const sent = this.pending.get(input)?.sent;
    if (input !== this.newest && sent !== undefined) {
      const lag = Math.min(LONGEST, now - sent);
      const share = this.lag === 0 ? 1 : lag < this.lag ? 0.3 : 0.05;
      this.lag += share * (lag - this.lag);
    }
    this.newest = input;
    for (const number of this.pending.keys()) if (number <= input) this.pending.delete(number);
  }

  private show(): void {
    if (!this.own) return;
    [this.yaw, this.pitch] = [this.own.yaw, this.own.pitch];
    const ahead = { turn: this.ahead[0], look: this.ahead[1] };
    // The dead do not turn.
    for (const { turn, look } of this.own.health > 0 ? [ahead, ...this.pending.values()] : []) {
      this.yaw += turn;
      this.pitch = Math.max(-90, Math.min(90, this.pitch + look));
    }
    const expected =
      this.own.health > 0 ? this.expected(this.own) : ([this.own.x, this.own.y, this.own.z] as Place);
    this.place = expected.map((part, axis) => part + this.offset[axis]) as Place;
  }

  private expected(own: Own): Place {
    const place: Place = [own.x, own.y, own.z];
    const factor = own.flags & IN_WATER ? this.rules.water_speed_factor : 1;
    const wall = this.wall(own, factor);
    let [rise, stands] = [own.velocity[1], (own.flags & ON_GROUND) !== 0];
    const level = stands ? own.y : -Infinity; // where a jump ends
    for (const tick of this.ticks) {
      const seconds = Math.min(tick.length, tick.end - this.told) / 1000;
      if (seconds <= 0 || tick.end - this.told > LONGEST) continue;
      const against = Math.min(0, tick.east * wall[0] + tick.north * wall[1]);
      place[0] += (tick.east - against * wall[0]) * factor * seconds;
      place[2] += (tick.north - against * wall[1]) * factor * seconds;
      if (stands && tick.jump && factor === 1) [stands, rise] = [false, JUMP];
      if (stands) continue;
      place[1] += rise * seconds - (GRAVITY * seconds * seconds) / 2;
      rise -= GRAVITY * seconds;
      if (rise < 0 && place[1] < level) [place[1], stands] = [level, true];
    }
    return [place[0], Math.max(place[1], Math.min(own.y, this.floor(place[0], place[2]))), place[2]];
  }

  // The unit vector by which something pushes the body back; zero if nothing seems to.
  private wall(own: Own, factor: number): [number, number] {
    const around = this.ticks.filter((tick) => Math.abs(tick.end - this.told) < STEADY);
    if (!around.length) return [0, 0];
    const [{ east, north }] = around;
    const isSteady = around.every((tick) => Math.hypot(tick.east - east, tick.north - north) < STOPPED);
    const [toEast, toNorth] = [own.velocity[0] - factor * east, own.velocity[2] - factor * north];
    const length = Math.hypot(toEast, toNorth);
    return isSteady && length > STOPPED ? [toEast / length, toNorth / length] : [0, 0];
  }
}
