// The frame of the match that is shown: a little in the past, so that what comes late is there in time.

import { FRAMES } from "./messages";

const JUMP = 300; // ms by which a moment is early or late after a pause

export class Clock {
  newest = 0; // frame
  private offset: number | null = null; // ms, when frame 0 would have come

  // behind: frames that are shown later than they come.
  constructor(private readonly behind: number) {}

  note(frame: number, now: number): void {
    const offset = now - (1000 * frame) / FRAMES;
    const late = this.offset === null ? JUMP : offset - this.offset;
    if (this.offset === null || Math.abs(late) >= JUMP) this.offset = offset;
    else this.offset += late * (late < 0 ? 0.3 : 0.03);
    this.newest = frame;
  }

  frame(now: number): number {
    if (this.offset === null) return 0;
    const frame = ((now - this.offset) * FRAMES) / 1000 - this.behind;
    return Math.max(0, Math.min(frame, this.newest));
  }
}
