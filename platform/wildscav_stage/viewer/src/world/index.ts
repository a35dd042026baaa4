// A match in 3D, drawn with three.js.

import { Color, LinearSRGBColorSpace, WebGLRenderer } from "three";
import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import { type Stage, type StageOptions, TRAIL } from "../stage";
import { type Moment, momentOf } from "../view/moment";
import { Cameras } from "./cameras";
import { inCorner } from "./inset";
import { Pace, probe } from "./pace";
import { createScene } from "./scene";
import { createShared } from "./shared";
import { createSteering } from "./steering";
import { Still } from "./still";

const LONGEST = 0.1; // s that held keys count for one picture
// What of the map a picture waits for: ms of making it, and parts whose shadows are drawn.
const GROWTH = { time: 12, shadows: Infinity };
const GROWTH_OF_SOFTWARE = { time: 40, shadows: 8 };

// Throws an Error where the browser has no WebGL 2.
export function createStage(
  canvas: HTMLCanvasElement,
  map: GameMap,
  course: Course,
  { hasLabels = true, over }: StageOptions = {},
): Stage {
  const isSoftware = probe();
  const renderer = createRenderer(canvas, isSoftware);
  const sharing = createShared(map.light);
  const { shared } = sharing;
  const parts = createScene(renderer, map, course, shared);
  const growth = isSoftware ? GROWTH_OF_SOFTWARE : GROWTH;
  parts.names.visible = hasLabels;
  const still = isSoftware ? new Still(renderer, parts.root, parts.statics, shared) : null;
  const cameras = new Cameras(map, course, shared);
  const pace = new Pace(isSoftware);
  const size = { width: 1, height: 1, ratio: 1 };
  const steering = createSteering(canvas, cameras, () => stage.view, size);
  let before = 0; // s, when the last picture was drawn
  let isOther = false; // the quality, than in the last picture

  const adapt = () => {
    const { scale, maxRatio, detail, shadows } = pace.quality;
    const ratio = Math.min(size.ratio, maxRatio) * scale;
    renderer.setPixelRatio(ratio);
    renderer.setSize(size.width, size.height, false);
    renderer.getDrawingBufferSize(shared.viewport.value);
    shared.perPixel.value = ratio;
    shared.shadowFrame.value.w = shadows && parts.isWhole ? 1 : 0;
    sharing.setDetail(detail);
  };
  const elapsed = () => {
    const now = performance.now() / 1000;
    const seconds = before ? now - before : 0;
    before = now;
    return seconds;
  };
  // A picture takes until the page can draw again; the next one may be wanted much later.
  const judge = () => {
    if (!parts.isWhole) return;
    const start = performance.now();
    requestAnimationFrame(() => {
      if (pace.note((performance.now() - start) / 1000)) isOther = true;
    });
  };
  // A browser may take the graphics processor away, and give it back without what it had computed.
  const recast = () => {
    parts.recast();
    still?.forget();
    adapt();
  };
  canvas.addEventListener("webglcontextrestored", recast);

  const grow = () => {
    if (!parts.grow(growth.time, growth.shadows)) return;
    still?.forget();
    if (parts.isWhole) isOther = true;
  };
  // What an agent sees has no names in it.
  const showInset = (seat: number, moment: Moment) => {
    parts.names.visible = false;
    inCorner(renderer, shared, size, (width, height) => {
      const shown = cameras.place({ kind: "eyes", seat }, moment, width, height, 0);
      parts.show(moment, shown, "eyes", pace.quality.reach, 0);
      renderer.render(parts.scene, shown.camera);
    });
    parts.names.visible = hasLabels;
  };

  const stage: Stage = {
    kinds: ["free", "behind", "eyes", "above"],
    view: { kind: "free", seat: 0 },
    inset: null,
    get moving() {
      return !parts.isWhole || steering.isHeld() || (stage.view.kind === "behind" && cameras.isGliding);
    },
    trail: TRAIL,
    get camera() {
      return { above: cameras.mapView.place, free: cameras.orbit.place };
    },
    set camera({ above, free = cameras.orbit.place }) {
      [cameras.mapView.place, cameras.orbit.place] = [above, free];
    },
    draw: (frame) => {
      const seconds = elapsed();
      judge();
      steering.move(Math.min(LONGEST, seconds));
      const moment = momentOf(course, frame);
      const shown = cameras.place(stage.view, moment, size.width, size.height, seconds);
      grow();
      if (isOther) adapt();
      isOther = false;
      parts.show(moment, shown, stage.view.kind, pace.quality.reach, stage.trail ?? 0);
      if (still) still.render(parts.scene, shown.camera, shown.focus ? -1 : pace.level);
      else renderer.render(parts.scene, shown.camera);
      canvas.dataset.picture = parts.isWhole ? "whole" : "partial";
      over?.(renderer);
      if (typeof stage.inset === "number") showInset(stage.inset, moment);
    },
    zoom: steering.zoom,
    resize: (width, height, ratio) => {
      Object.assign(size, { width, height, ratio });
      cameras.orbit.fit(width / height);
      adapt();
    },
    dispose: () => {
      canvas.removeEventListener("webglcontextrestored", recast);
      steering.dispose();
      still?.dispose();
      parts.dispose();
      sharing.dispose();
      renderer.dispose();
    },
  };
  return stage;
}

function createRenderer(canvas: HTMLCanvasElement, isSoftware: boolean): WebGLRenderer {
  const renderer = new WebGLRenderer({
    canvas,
    antialias: !isSoftware,
    stencil: true,
    powerPreference: "high-performance",
  });
  renderer.outputColorSpace = LinearSRGBColorSpace;
  renderer.setClearColor(new Color(0.62, 0.68, 0.72));
  return renderer;
}
