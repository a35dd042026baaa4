// How much is drawn: less after pictures have been slow for a while, so that all computers show some ten a second.

const SLOW = 1 / 24; // s between two pictures that is too long
const PAUSE = 1.5; // s beyond which nobody was drawing
const PATIENCE = 12; // pictures, over which it is judged

export interface Quality {
  detail: number; // see glsl.ts
  scale: number; // of the picture's width and height
  maxRatio: number; // pixels in a CSS pixel, at most
  reach: number; // m, up to which solids have all their triangles
  shadows: boolean;
}

export const QUALITIES: Quality[] = [
  { detail: 2, scale: 1, maxRatio: 2, reach: 110, shadows: true },
  { detail: 2, scale: 1, maxRatio: 1.25, reach: 80, shadows: true },
  { detail: 1, scale: 1, maxRatio: 1, reach: 55, shadows: true },
  { detail: 1, scale: 0.75, maxRatio: 1, reach: 35, shadows: true },
  { detail: 0, scale: 0.6, maxRatio: 1, reach: 20, shadows: true },
  { detail: 0, scale: 0.5, maxRatio: 1, reach: 12, shadows: false },
];

export class Pace {
  level = 0;
  private count = 0;
  private sum = 0;

  get quality(): Quality {
    return QUALITIES[this.level];
  }

  // Note the time since the last picture; true if another quality is to be used from now on.
  note(seconds: number): boolean {
    if (seconds > PAUSE) return false;
    this.sum += seconds;
    if (++this.count < PATIENCE) return false;
    const isSlow = this.sum / this.count > SLOW;
    this.sum = this.count = 0;
    if (!isSlow || this.level === QUALITIES.length - 1) return false;
    this.level++;
    return true;
  }
}
