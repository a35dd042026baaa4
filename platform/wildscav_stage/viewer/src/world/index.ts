// A match in 3D, drawn with three.js. Everything is placed in the game's frame, in a group that is mirrored.

import { Color, Group, LinearSRGBColorSpace, type Mesh, Scene, WebGLRenderer } from "three";
import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import type { Stage, StageOptions, View } from "../stage";
import { Input } from "../view/gestures";
import { momentOf } from "../view/moment";
import { createAgents } from "./agents";
import { createBoxes } from "./boxes";
import { Cameras } from "./cameras";
import { createGround } from "./ground";
import { inCorner } from "./inset";
import { createLabels } from "./labels";
import { Lines } from "./lines";
import { Pace, probe } from "./pace";
import { castShadows } from "./shadow";
import { createShared } from "./shared";
import { showShots } from "./shots";
import { createSky } from "./sky";
import { createSolids } from "./solids";
import { Still } from "./still";
import { createTarget } from "./target";
import { showTrails } from "./trails";
import { createWater } from "./water";
import { createZone } from "./zone";

const SPARK = 5; // CSS pixels, of the sparks over boxes
const ROOFLESS = 90; // m in view from above, from where on houses are shown without roofs
const CRATES = 130; // m, up to which boxes are shown as crates
const SOME_WAY_OFF = 330; // m; from the camera above, all is farther away, and within some times as far
const ENLARGED = 0.016; // of what is in view from above: how tall agents are drawn at least
const TALL = 1.8; // m, an agent

// Throws an Error where the browser has no WebGL 2.
export function createStage(
  canvas: HTMLCanvasElement,
  map: GameMap,
  course: Course,
  { hasLabels = true, over }: StageOptions = {},
): Stage {
  const isSoftware = probe();
  const renderer = new WebGLRenderer({
    canvas,
    antialias: !isSoftware,
    stencil: true,
    powerPreference: "high-performance",
  });
  renderer.outputColorSpace = LinearSRGBColorSpace;
  renderer.setClearColor(new Color(0.62, 0.68, 0.72));
  const sharing = createShared(map.light);
  const { shared } = sharing;
  const ground = createGround(map, shared);
  const solids = createSolids(map, shared);
  const agents = createAgents(map, course, shared);
  const boxes = createBoxes(map, course, shared);
  const labels = createLabels(course, shared);
  const zone = createZone(map, course, shared);
  const tracers = new Lines(shared, 64, true);
  const trails = new Lines(shared, 64, false);
  const sky = createSky(shared);
  const scene = new Scene();
  const root = new Group();
  root.scale.z = -1;
  const water = createWater(map, shared);
  root.add(ground.group, solids.group, water.mesh, sky, agents.group, boxes.group);
  root.add(labels.group, zone.group, createTarget(course, shared), tracers.mesh, trails.mesh);
  scene.add(root);
  labels.group.visible = hasLabels;
  ground.see(shared.eye.value, Infinity);
  solids.see(shared.eye.value, Infinity, true);
  const shadows = castShadows(renderer, map, [ground.group, solids.group], shared);
  root.updateMatrixWorld(true);
  scene.matrixWorldAutoUpdate = false;
  const cameras = new Cameras(map, course, shared);
  const statics = [ground.group, solids.group, water.mesh, sky];
  const still = isSoftware ? new Still(renderer, root, statics, shared) : null;
  const pace = new Pace(isSoftware);
  const size = { width: 1, height: 1, ratio: 1 };
  let before = 0;

  const fit = () => {
    const { scale, maxRatio, detail, shadows: hasShadows } = pace.quality;
    const ratio = Math.min(size.ratio, maxRatio) * scale;
    renderer.setPixelRatio(ratio);
    renderer.setSize(size.width, size.height, false);
    renderer.getDrawingBufferSize(shared.viewport.value);
    shared.perPixel.value = ratio;
    sharing.setDetail(detail);
    shared.shadowFrame.value.w = hasShadows ? 1 : 0;
  };
  const isMoved = () => stage.view.kind === "free" || stage.view.kind === "above";
  const zoom = (factor: number, x: number, y: number) => {
    if (stage.view.kind === "free") cameras.orbit.zoom(factor);
    else if (isMoved()) cameras.mapView.zoom(factor, x, y, size.width, size.height);
  };
  const input = new Input(
    canvas,
    {
      drag: (right, down, isShift) => {
        if (stage.view.kind === "free") cameras.orbit.drag(right, down, isShift, size.height);
        else if (isMoved()) cameras.mapView.drag(right, down, size.width, size.height);
      },
      zoom,
    },
    isMoved,
  );
  const move = (seconds: number) => {
    const [right, ahead] = input.heading();
    if (stage.view.kind === "free") cameras.orbit.fly([right, ahead], seconds);
    else if (right || ahead)
      cameras.mapView.drag(-400 * right * seconds, 400 * ahead * seconds, size.width, size.height);
  };

  // Draw a view for so many CSS pixels, some seconds after the last picture.
  const show = (view: View, frame: number, width: number, height: number, seconds: number) => {
    const moment = momentOf(course, frame);
    const shown = cameras.place(view, moment, width, height, seconds);
    const { hidden, isFromAbove, across } = shown;
    const ratio = shared.perPixel.value;
    const reach = isFromAbove ? reachFromAbove(across, pace.quality.reach) : pace.quality.reach;
    ground.see(shared.eye.value, 1.5 * reach);
    solids.see(shared.eye.value, reach, !isFromAbove || across > ROOFLESS);
    solids.cut(shown.focus);
    agents.show(moment, hidden, isFromAbove ? Math.max(1, (ENLARGED * across) / TALL) : 1);
    labels.show(moment, hidden, isFromAbove);
    boxes.show(
      frame,
      shared.eye.value,
      isFromAbove ? (across > CRATES ? 0 : Infinity) : Math.min(CRATES, 2 * reach),
      view.kind === "eyes" ? 0 : SPARK * ratio * (isFromAbove ? 0.7 : 1),
    );
    zone.show(frame, isFromAbove);
    showShots(tracers, course, frame, ratio, hidden);
    trails.mesh.visible = isFromAbove;
    if (isFromAbove) showTrails(trails, course, frame, stage.trail ?? 0, ratio);
    sky.visible = !isFromAbove;
    const isWhole = width === size.width;
    if (still && isWhole) still.render(scene, shown.camera, shown.focus ? -1 : pace.level);
    else renderer.render(scene, shown.camera);
  };
  // What an agent sees has no names in it.
  const showInset = (seat: number, frame: number) => {
    labels.group.visible = false;
    inCorner(renderer, shared, size, (width, height) =>
      show({ kind: "eyes", seat }, frame, width, height, 0),
    );
    labels.group.visible = hasLabels;
  };

  const stage: Stage = {
    kinds: ["free", "behind", "eyes", "above"],
    view: { kind: "free", seat: 0 } as View,
    inset: null,
    trail: 20,
    draw: (frame) => {
      const now = performance.now();
      const seconds = before ? (now - before) / 1000 : 0;
      before = now;
      if (pace.note(seconds)) fit();
      move(Math.min(0.1, seconds));
      show(stage.view, frame, size.width, size.height, seconds);
      over?.(renderer);
      if (typeof stage.inset === "number") showInset(stage.inset, frame);
    },
    zoom: (factor) => zoom(factor, size.width / 2, size.height / 2),
    resize: (width, height, pixelRatio) => {
      Object.assign(size, { width, height, ratio: pixelRatio });
      cameras.orbit.fit(width / height);
      fit();
    },
    dispose: () => {
      input.dispose();
      root.traverse((each) => {
        (each as Mesh).geometry?.dispose();
      });
      for (const part of [agents, labels, shadows, water]) part.dispose();
      still?.dispose();
      sharing.dispose();
      renderer.dispose();
    },
  };
  return stage;
}

// The reach of a view from above, whose camera is far away from everything.
function reachFromAbove(across: number, reach: number): number {
  if (across < reach) return Infinity;
  return across < 5 * reach ? SOME_WAY_OFF : 0;
}
