// The time of a match that is shown.

export const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16];
const LONGEST_TICK = 0.25; // s; a page that was asleep does not leap
const LIVE_DELAY = 0.8; // s behind the newest moment, so that the picture flows between two answers of the server
const FARTHEST = 30; // s behind the newest moment from where one leaps to it
const ARRIVED = 0.01; // s

export class Clock {
  seconds = 0;
  end = 0; // s, of the match, or of the longest that is shown
  speed = 1;
  isPlaying = false;
  isFollowingLive = false;
  isOpen = false; // while the match is being played: its end will come later
  private readonly listeners = new Set<() => void>();
  private readonly ends = new Map<object, number>(); // s, of each match
  private lastTick: number | null = null;

  // Tell a listener of everything but the passing of time; returns what ends that.
  listen(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  setEnd(seconds: number, match: object = this): void {
    this.ends.set(match, seconds);
    this.end = Math.max(...this.ends.values());
    this.tell();
  }

  get isRunning(): boolean {
    return this.isPlaying || (this.isFollowingLive && this.end - this.seconds > 0);
  }

  // Let time pass up to now, in ms.
  advance(now: number): void {
    const passed = this.lastTick === null ? 0 : Math.min((now - this.lastTick) / 1000, LONGEST_TICK);
    this.lastTick = now;
    if (passed <= 0) return;
    if (this.isFollowingLive) this.approach(passed);
    else if (this.isPlaying) this.pass(passed);
  }

  // Forget when time last passed: it stands still now.
  rest(): void {
    this.lastTick = null;
  }

  play(): void {
    if (this.seconds >= this.end && !this.isOpen) this.seconds = 0;
    this.isPlaying = true;
    this.rest();
    this.tell();
  }

  pause(): void {
    this.isPlaying = this.isFollowingLive = false;
    this.tell();
  }

  seek(seconds: number): void {
    this.isFollowingLive = false;
    this.seconds = Math.min(Math.max(0, seconds), this.end);
    this.tell();
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    this.tell();
  }

  // The next speed up or down.
  changeSpeed(direction: 1 | -1): void {
    const next = SPEEDS.indexOf(this.speed) + direction;
    this.setSpeed(SPEEDS[Math.min(Math.max(0, next), SPEEDS.length - 1)]);
  }

  // Go to the newest moment of a match that is being played, and stay there.
  followLive(): void {
    this.isFollowingLive = true;
    this.isPlaying = false;
    this.seconds = this.end;
    this.tell();
  }

  // A match is over: from here on, its end is the end.
  close(): void {
    this.isOpen = false;
    this.tell();
  }

  private pass(passed: number): void {
    this.seconds = Math.min(this.end, this.seconds + passed * this.speed);
    if (this.seconds < this.end) return;
    this.isPlaying = false;
    this.isFollowingLive = this.isOpen;
    this.tell();
  }

  // The farther behind, the faster, at whatever rate the match is played.
  private approach(passed: number): void {
    const behind = this.end - this.seconds;
    if (behind > FARTHEST) this.seconds = this.end - LIVE_DELAY;
    else if (behind < ARRIVED) this.seconds = this.end;
    else this.seconds += behind * (1 - Math.exp(-passed / LIVE_DELAY));
    if (this.seconds < this.end || this.isOpen) return;
    this.isFollowingLive = false;
    this.tell();
  }

  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}

// A time as m:ss.
export function clockText(seconds: number): string {
  const whole = Math.floor(seconds + 1e-6);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
