// A small picture in the lower left corner of the large one: what the followed agent sees.

import type { WebGLRenderer } from "three";
import type { Shared } from "./shared";

// As .player-has-inset in viewer.css, which frames it.
const SHARE = 0.28; // of the width of the canvas
const LEAST = 120; // CSS pixels across
const MARGIN = 10; // CSS pixels

// Draw in the corner of a canvas of so many CSS pixels; draw is told how many the corner has.
export function inCorner(
  renderer: WebGLRenderer,
  shared: Shared,
  whole: { width: number; height: number },
  draw: (width: number, height: number) => void,
): void {
  const width = Math.round(Math.max(LEAST, SHARE * whole.width));
  const height = Math.round((width * 9) / 16);
  const before = shared.viewport.value.clone();
  renderer.setViewport(MARGIN, MARGIN, width, height);
  renderer.setScissor(MARGIN, MARGIN, width, height);
  renderer.setScissorTest(true);
  shared.viewport.value.set(width, height).multiplyScalar(shared.perPixel.value);
  draw(width, height);
  renderer.setScissorTest(false);
  renderer.setViewport(0, 0, whole.width, whole.height);
  shared.viewport.value.copy(before);
}
