// What both pages do to draw: they fetch the map, keep the stage as large as its canvas, and count pictures.

import { unzipped } from "../data/arrays";
import type { Course } from "../data/course";
import { type GameMap, readMap } from "../data/map";
import type { Stage, StageOptions } from "../stage";
import { createStage } from "../world";
import { find } from "./dom";

const LONGEST = 1000; // ms between two pictures; after more, the page was not shown

let map: Promise<GameMap> | null = null; // all matches of a table are played on one

// Use the map once it is there, or tell why the match cannot be shown.
export function withMap(use: (map: GameMap) => void, fail: (why: string) => void): void {
  map ??= fetchMap();
  map.then(use).catch((error: Error) => {
    map = null; // to be tried again
    console.error(error);
    fail(`${error.message}.`);
  });
}

async function fetchMap(): Promise<GameMap> {
  const answer = await fetch(`${location.pathname}/map`);
  if (!answer.ok) throw new Error(`the map could not be loaded (${answer.status})`);
  return readMap(await unzipped(await answer.arrayBuffer()));
}

// Draws one match on the page's canvas.
export class Picture {
  readonly stage: Stage;
  private readonly observer: ResizeObserver;
  private shown: number[] = []; // when pictures were shown, ms

  constructor(gameMap: GameMap, course: Course, options: StageOptions) {
    const canvas = find("picture") as HTMLCanvasElement;
    this.stage = createStage(canvas, gameMap, course, options);
    this.observer = new ResizeObserver(() => this.fit(canvas));
    this.observer.observe(canvas);
    this.fit(canvas);
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
    this.stage.dispose();
  }

  private fit(canvas: HTMLCanvasElement): void {
    this.stage.resize(canvas.clientWidth, canvas.clientHeight, devicePixelRatio);
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
