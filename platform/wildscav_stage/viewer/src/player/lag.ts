// How far the picture of a match that is being played is behind it, in the seconds of whoever watches.

const KEPT = 200; // arrivals

export class Lag {
  private readonly arrivals: [number, number][] = []; // the newest frame, and when it came, ms

  // delay: s that news take to be sent.
  constructor(
    private readonly delay: number,
    private readonly framesPerSecond: number,
  ) {}

  note(frame: number, now: number): void {
    this.arrivals.push([frame, now]);
    if (this.arrivals.length > KEPT) this.arrivals.shift();
  }

  // s; what had been played before one came counts as played at its own pace.
  of(frame: number, now: number): number {
    const [oldest, came] = this.arrivals[0] ?? [frame, now];
    const arrival = this.arrivals.find(([newest]) => newest >= frame);
    const since = frame < oldest ? came - (1000 * (oldest - frame)) / this.framesPerSecond : arrival?.[1];
    return this.delay + Math.max(0, now - (since ?? now)) / 1000;
  }
}
