// How much is drawn: less after pictures have been slow for a while, so that all computers show some ten a second.

// s between two pictures that is too long; half of it leaves time for more.
const SLOW = 1 / 24;
const SLOW_OF_SOFTWARE = 1 / 12;
const PAUSE = 4; // s beyond which nobody was drawing
const PATIENCE = 12; // pictures, over whose median it is judged, unless they take too long
const LONGEST = 2; // s
const FEWEST = 4;
const SURE = 20; // times in a row that pictures must be fast before more is drawn

export interface Quality {
  detail: number; // see glsl.ts
  scale: number; // of the picture's width and height
  maxRatio: number; // pixels in a CSS pixel, at most
  reach: number; // m, up to which solids have all their triangles
  shadows: boolean;
}

export const QUALITIES: Quality[] = [
  { detail: 2, scale: 1, maxRatio: 2, reach: 240, shadows: true },
  { detail: 2, scale: 1, maxRatio: 1.25, reach: 120, shadows: true },
  { detail: 1, scale: 1, maxRatio: 1, reach: 60, shadows: true },
  { detail: 0, scale: 1, maxRatio: 1, reach: 24, shadows: true },
  { detail: 0, scale: 0.75, maxRatio: 1, reach: 16, shadows: true },
  { detail: 0, scale: 0.6, maxRatio: 1, reach: 10, shadows: true },
  { detail: 0, scale: 0.5, maxRatio: 1, reach: 6, shadows: false },
];
const OF_SOFTWARE = 3; // the quality that a browser without a graphics processor begins with

// Whether WebGL 2 is computed by the processor. Throws an Error where there is none.
export function probe(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) throw new Error("this browser has no WebGL 2");
  const about = context.getExtension("WEBGL_debug_renderer_info");
  const name = context.getParameter(about ? about.UNMASKED_RENDERER_WEBGL : context.RENDERER);
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export class Pace {
  level: number;
  private readonly best: number;
  private readonly slow: number;
  private readonly tooSlow = QUALITIES.map(() => 0); // how often each quality was
  private times: number[] = [];
  private fast = 0;

  constructor(isSoftware: boolean) {
    this.level = this.best = isSoftware ? OF_SOFTWARE : 0;
    this.slow = isSoftware ? SLOW_OF_SOFTWARE : SLOW;
  }

  get quality(): Quality {
    return QUALITIES[this.level];
  }

  // Note the time that a picture took; true if another quality is to be used from now on.
  note(seconds: number): boolean {
    if (seconds > PAUSE) return false;
    this.times.push(seconds);
    const sum = this.times.reduce((total, each) => total + each, 0);
    const isEnough = this.times.length >= PATIENCE || (sum > LONGEST && this.times.length >= FEWEST);
    if (!isEnough) return false;
    const median = this.times.sort((one, other) => one - other)[this.times.length >> 1];
    this.times = [];
    this.fast = median < this.slow / 2 ? this.fast + 1 : 0;
    if (median > this.slow) return this.worsen(median);
    return this.fast >= SURE && this.improve();
  }

  // Slow pictures were of too much; very slow ones of much too much.
  private worsen(median: number): boolean {
    const before = this.level;
    this.tooSlow[before]++;
    this.level = Math.min(QUALITIES.length - 1, before + (median > 4 * this.slow ? 2 : 1));
    return this.level !== before;
  }

  // Try the next better quality again, unless it was too slow twice.
  private improve(): boolean {
    this.fast = 0;
    if (this.level === this.best || this.tooSlow[this.level - 1] >= 2) return false;
    this.level--;
    return true;
  }
}
