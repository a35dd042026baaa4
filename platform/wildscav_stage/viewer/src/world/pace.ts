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
  { detail: 2, scale: 1, maxRatio: 2, reach: 240, shadows: true },
  { detail: 2, scale: 1, maxRatio: 1.25, reach: 120, shadows: true },
  { detail: 1, scale: 1, maxRatio: 1, reach: 60, shadows: true },
  { detail: 1, scale: 1, maxRatio: 1, reach: 24, shadows: true },
  { detail: 1, scale: 0.75, maxRatio: 1, reach: 16, shadows: true },
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
  private count = 0;
  private sum = 0;

  constructor(isSoftware: boolean) {
    this.level = isSoftware ? OF_SOFTWARE : 0;
  }

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
