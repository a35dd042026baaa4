// The course of a match: what the document of its trails says about any frame. Lengths are decimetres, as there.

const LEAP = 40; // dm between two samples beyond what anyone walks: a respawn

export class Course {
  // names: of the seats, by number, as the page knows them; records have those under which submissions are entered.
  constructor(document, names = {}) {
    this.names = names;
    this.document = document;
    this.frames = document.samples.frames;
    this.seats = document.samples.seats;
    this.events = document.events;
  }

  // Add what a match that is being played has seen since the last document.
  extend(next) {
    if (next.first) {
      this.frames = next.samples.frames;
      this.seats = next.samples.seats;
      this.events = next.events;
    } else {
      this.frames.push(...next.samples.frames);
      next.samples.seats.forEach((samples, seat) => {
        for (const name of Object.keys(samples)) this.seats[seat][name].push(...samples[name]);
      });
      this.events.push(...next.events);
    }
    this.document = next;
  }

  get lastFrame() {
    return this.frames.length ? this.frames[this.frames.length - 1] : 0;
  }

  seconds(frame) {
    return frame / this.document.frames_per_second;
  }

  // The last sample that is not after a frame.
  sampleAt(frame) {
    return Math.max(0, countUntil(this.frames.length, (place) => this.frames[place], frame) - 1);
  }

  // The number of events up to a frame.
  eventsUntil(frame) {
    return countUntil(this.events.length, (place) => this.events[place].frame, frame);
  }

  // Where a seat is in a frame, and how it fares.
  at(seat, frame) {
    const samples = this.seats[seat];
    const here = this.sampleAt(frame);
    const state = {
      x: samples.x[here],
      z: samples.z[here],
      yaw: samples.yaw[here],
      health: samples.health[here],
      supplies: samples.supplies[here],
    };
    const next = here + 1;
    if (next < this.frames.length && this.isConnected(seat, next)) {
      const part = (frame - this.frames[here]) / (this.frames[next] - this.frames[here]);
      const turn = ((samples.yaw[next] - state.yaw + 540) % 360) - 180;
      state.x += (samples.x[next] - state.x) * part;
      state.z += (samples.z[next] - state.z) * part;
      state.yaw += turn * part;
    }
    return state;
  }

  // Whether a seat walked from the sample before to a sample, and did not die or come back in between.
  isConnected(seat, sample) {
    const { x, z, health } = this.seats[seat];
    if (health[sample - 1] <= 0 || health[sample] <= 0) return false;
    const far = Math.hypot(x[sample] - x[sample - 1], z[sample] - z[sample - 1]);
    return far <= (LEAP * (this.frames[sample] - this.frames[sample - 1])) / 10;
  }

  // The safe zone in a frame and the circle to which it shrinks next; null without a zone.
  zoneAt(frame) {
    const phases = this.document.zone;
    if (!phases.length) return null;
    const phase = phases.find((each) => frame < each.end) ?? phases[phases.length - 1];
    const part = Math.min(1, Math.max(0, (frame - phase.start) / (phase.end - phase.start)));
    const between = (name) => phase.before[name] + (phase.after[name] - phase.before[name]) * part;
    return { now: { x: between("x"), z: between("z"), radius: between("radius") }, next: phase.after };
  }

  name(seat) {
    return this.names[seat] ?? this.document.seats[seat].name;
  }

  // An event as a sentence.
  describe(event) {
    const by = event.other === null ? "" : `, shot by ${this.name(event.other)}`;
    const who = event.seat === null ? "" : this.name(event.seat);
    switch (event.kind) {
      case "hit":
        return `${who} hits ${this.name(event.other)}, ${event.amount} hp left`;
      case "death":
        return `${who} dies${by}`;
      case "out":
        return `${who} is out${by}`;
      case "respawn":
        return `${who} is back`;
      case "pick_up":
        return `${who} picks up ${event.amount} ${event.amount === 1 ? "supply" : "supplies"}`;
      case "target":
        return `${who} reaches the target`;
      case "zone":
        return event.amount ? "The safe zone begins to shrink" : "The safe zone stands still";
      default:
        return event.kind;
    }
  }
}

// How many of the ascending values are not greater than a limit.
function countUntil(length, valueAt, limit) {
  let low = 0;
  let high = length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (valueAt(middle) <= limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

export function clock(seconds) {
  const whole = Math.floor(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
