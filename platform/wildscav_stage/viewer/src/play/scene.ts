// What both pages do to draw: they fetch the map, keep the stage as large as its canvas, and count pictures.

import { unzipped } from "../data/arrays";
import type { Course } from "../data/course";
import { type GameMap, readMap } from "../data/map";
import type { Stage, StageMaker } from "../stage";
import { find } from "./dom";

const BACK = 4000; // ms in which 3D must be back
const LONGEST = 1000; // ms between two pictures; after more, the page was not shown

let kept: { key: string; map: Promise<GameMap> } | null = null; // the map of the last match

// Use the map of a key once it is there, or tell why the match cannot be shown.
export function withMap(key: string, use: (map: GameMap) => void, fail: (why: string) => void): void {
  if (kept?.key !== key) kept = { key, map: fetchMap(key) };
  const own = kept;
  own.map.then(use).catch((error: Error) => {
    if (kept === own) kept = null; // to be tried again
    console.error(error);
    fail(`${error.message}.`);
  });
}

async function fetchMap(key: string): Promise<GameMap> {
  const answer = await fetch(`${location.pathname}/map?key=${key}`);
  if (!answer.ok || !answer.body) throw new Error(`the map could not be loaded (${answer.status})`);
  const map = await readMap(await unzipped(answer.body));
  await map.whole; // bodies must not walk through what is not there yet
  return map;
}

// Whether the browser has WebGL 2.
export function hasWebGL(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return context !== null;
}

// Draws one match on the page's canvas.
export class Picture {
  readonly stage: Stage;
  private readonly canvas = find("picture") as HTMLCanvasElement;
  private readonly observer: ResizeObserver;
  private shown: number[] = []; // when pictures were shown, ms
  private waiting = 0; // for the browser, which mostly gives the graphics processor back

  // lose: called if the browser no longer draws in 3D.
  constructor(
    gameMap: GameMap,
    course: Course,
    make: StageMaker,
    private readonly lose: () => void,
  ) {
    this.stage = make(this.canvas, gameMap, course);
    this.observer = new ResizeObserver(() => this.fit());
    this.observer.observe(this.canvas);
    this.canvas.addEventListener("webglcontextlost", this.wait);
    this.canvas.addEventListener("webglcontextrestored", this.goOn);
    this.fit();
  }

  draw(frame: number, now: number): void {
    this.stage.draw(frame);
    this.shown = [...this.shown.filter((when) => now - when < 1000), now];
  }

  // Pictures in the last second.
  get rate(): number {
    return this.shown.length;
  }

  dispose(): void {
    this.observer.disconnect();
    this.canvas.removeEventListener("webglcontextlost", this.wait);
    this.canvas.removeEventListener("webglcontextrestored", this.goOn);
    this.goOn();
    this.stage.dispose();
  }

  private readonly wait = () => {
    this.waiting = window.setTimeout(this.lose, BACK);
  };
  private readonly goOn = () => clearTimeout(this.waiting);

  private fit(): void {
    this.stage.resize(this.canvas.clientWidth, this.canvas.clientHeight, devicePixelRatio);
  }
}

// Call a function for each picture of the display, with the ms since the last one.
export function eachPicture(draw: (now: number, length: number) => void): void {
  let last = performance.now();
  const next = () => {
    requestAnimationFrame(next);
    const now = performance.now();
    draw(now, Math.min(LONGEST, now - last));
    last = now;
  };
  requestAnimationFrame(next);
}
