// The scene of a match: the map, and what moves on it. All is placed in the game's frame, in a group that is
// mirrored, since z points south in three.js.

import { Group, type Mesh, type Object3D, Scene, type WebGLRenderer } from "three";
import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import type { ViewKind } from "../stage";
import type { Moment } from "../view/moment";
import { createAgents } from "./agents";
import { createBoxes } from "./boxes";
import { Building } from "./building";
import type { Shown } from "./cameras";
import { createGround } from "./ground";
import { createLabels } from "./labels";
import { Lines } from "./lines";
import { showMarks } from "./marks";
import { Shadows } from "./shadow";
import type { Shared } from "./shared";
import { showShots } from "./shots";
import { createSky } from "./sky";
import { createSolids } from "./solids";
import { createTarget } from "./target";
import { createTrails } from "./trails";
import { createWater } from "./water";
import { createZone } from "./zone";

const SPARK = 5; // CSS pixels, of the sparks over boxes
const SPARK_ABOVE = 3.5; // the same from above
const ROOFLESS = 45; // m in view from above, from where on houses are shown without roofs
const CRATES = 130; // m, up to which boxes are shown as crates
const SOME_WAY_OFF = 330; // m; from the camera above, all is farther away, and within some times as far
const ENLARGED = 0.016; // of what is in view from above: how tall agents are drawn at least
const TALL = 1.8; // m, an agent
const FEW = 64; // lines that there is room for at first

export interface MatchScene {
  scene: Scene;
  root: Group;
  statics: Object3D[]; // what stands still
  names: Object3D; // of agents
  readonly isWhole: boolean; // whether all of the map is drawn, with shadows
  // Make more of the map for so many ms, or the shadows of so many parts; whether anything looks different now.
  grow(time: number, shadows: number): boolean;
  // Forget the shadows, which the graphics processor has lost.
  recast(): void;
  // Prepare a picture. reach: m, up to which solids have all their triangles; trail: s of trails from above.
  show(moment: Moment, shown: Shown, kind: ViewKind, reach: number, trail: number): void;
  dispose(): void;
}

export function createScene(
  renderer: WebGLRenderer,
  map: GameMap,
  course: Course,
  shared: Shared,
): MatchScene {
  const land = createLand(renderer, map, shared);
  const life = createLife(map, course, shared);
  const root = new Group();
  root.scale.z = -1;
  root.add(...land.statics, ...life.objects);
  const scene = new Scene();
  scene.add(root);
  scene.matrixWorldAutoUpdate = false;
  root.updateMatrixWorld(true);
  return {
    scene,
    root,
    statics: land.statics,
    names: life.names,
    get isWhole() {
      return land.isWhole;
    },
    grow: land.grow,
    recast: land.recast,
    show: (moment, shown, kind, reach, trail) => {
      land.show(shown, reach);
      life.show(moment, shown, kind, reach, trail);
    },
    dispose: () => {
      root.traverse((each) => {
        (each as Mesh).geometry?.dispose();
      });
      land.dispose();
      life.dispose();
    },
  };
}

// The map: ground, solids, water and sky.
function createLand(renderer: WebGLRenderer, map: GameMap, shared: Shared) {
  const building = new Building();
  const ground = createGround(map, shared, building);
  const solids = createSolids(map, shared, building);
  const water = createWater(map, shared);
  const sky = createSky(shared);
  let shadows: Shadows | null = null;
  let isThere = false; // the whole map
  map.whole.then(() => {
    isThere = true;
  });
  const grow = (time: number, most: number) => {
    solids.extend();
    if (building.go(shared.eye.value, time)) return true;
    if (!isThere || shadows?.areWhole) return false;
    shadows ??= new Shadows(renderer, map, [...ground.casters(), ...solids.casters()], shared);
    shadows.go(most);
    return shadows.areWhole;
  };
  const recast = () => {
    shadows?.dispose();
    shadows = null;
  };
  const show = ({ isFromAbove, across, focus }: Shown, most: number) => {
    const reach = isFromAbove ? reachFromAbove(across, most) : most;
    ground.see(shared.eye.value, 1.5 * reach);
    solids.see(shared.eye.value, reach, !isFromAbove || across > ROOFLESS);
    solids.cut(focus);
    sky.visible = !isFromAbove;
  };
  const dispose = () => {
    recast();
    water.dispose();
  };
  const statics = [ground.group, solids.group, water.mesh, sky];
  return {
    ...{ statics, grow, recast, show, dispose },
    get isWhole() {
      return shadows?.areWhole === true;
    },
  };
}

// What moves on the map.
function createLife(map: GameMap, course: Course, shared: Shared) {
  const agents = createAgents(map, course, shared);
  const boxes = createBoxes(map, course, shared);
  const labels = createLabels(course, shared);
  const zone = createZone(map, course, shared);
  const [tracers, marks] = [new Lines(shared, FEW, true), new Lines(shared, FEW, false)];
  const trails = createTrails(course, shared);
  const groups = [agents.group, boxes.group, labels.group, zone.group, createTarget(course, shared)];
  const show = (moment: Moment, shown: Shown, kind: ViewKind, reach: number, trail: number) => {
    const { frame } = moment;
    const { hidden, isFromAbove, across } = shown;
    const ratio = shared.perPixel.value;
    agents.show(moment, hidden, isFromAbove ? Math.max(1, (ENLARGED * across) / TALL) : 1);
    labels.show(moment, hidden, isFromAbove);
    const crates = isFromAbove ? (across > CRATES ? 0 : Infinity) : Math.min(CRATES, 2 * reach);
    const spark = kind === "eyes" ? 0 : isFromAbove ? SPARK_ABOVE : SPARK;
    boxes.show(frame, shared.eye.value, crates, spark * ratio);
    zone.show(frame, isFromAbove);
    showShots(tracers, course, frame, ratio, hidden);
    showMarks(marks, course, frame, ratio);
    trails.group.visible = isFromAbove;
    if (isFromAbove) trails.show(moment, trail, ratio);
  };
  const dispose = () => {
    agents.dispose();
    labels.dispose();
  };
  const objects = [...groups, tracers.mesh, marks.mesh, trails.group];
  return { objects, names: labels.group, show, dispose };
}

// The reach of a view from above, whose camera is far away from everything.
function reachFromAbove(across: number, reach: number): number {
  if (across < reach) return Infinity;
  return across < 5 * reach ? SOME_WAY_OFF : 0;
}
