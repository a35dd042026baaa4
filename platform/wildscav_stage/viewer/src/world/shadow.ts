// The shadows of the map. The sun stands still and so does the map, so they are computed once, as a height for
// each ray of the sun: of the highest surface on it. A ray has the number of the place where it crosses the
// lowest level of the map. The map of roofs is the same for rays straight down, and floors and roofs alone.

import {
  Camera,
  DepthTexture,
  DoubleSide,
  LessEqualCompare,
  LinearFilter,
  type Mesh,
  NoColorSpace,
  RedFormat,
  Scene,
  type ShaderMaterial,
  UnsignedShortType,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import type { GameMap } from "../data/map";
import { material, type Shared } from "./shared";

const FINEST = 0.1; // m that a number of the map covers, where there is room
const MOST = 4096; // numbers along a side
const MOST_BY_TOUCH = 2048; // the same on phones and tablets
const LONGEST = 60; // pictures that it takes to draw them, at most
const COARSER = 2; // how much wider the numbers of the map of roofs are

const VERTEX = /* glsl */ `
in vec4 color; // and the kind
uniform vec2 lean; // m to the east and the north that rays go for each m upwards
flat out int kind;
void main() {
  vec3 at = inShadowMap(position, lean);
  kind = int(color.a * 255.0 + 0.5);
  gl_Position = vec4(at.xy, 2.0 * at.z - 1.0, 1.0);
}`;
const FRAGMENT = /* glsl */ `
flat in int kind;
uniform ivec2 kinds; // that cast shadows; all if they are negative
void main() {
  if (kinds.x >= 0 && kind != kinds.x && kind != kinds.y) discard;
  shown = vec4(1.0);
}`;

// A mesh and the part of its index with all triangles.
export interface Caster {
  mesh: Mesh;
  start: number;
  count: number;
  isRoof: boolean; // whether floors or roofs are in it
}

// The shadow maps of ground and solids. All surfaces use them from when they are whole.
export class Shadows {
  private readonly targets: WebGLRenderTarget[];
  private readonly materials: ShaderMaterial[];
  private readonly waiting: [Caster, number][]; // and to which target
  private readonly least: number; // of those to be drawn at once

  constructor(
    private readonly renderer: WebGLRenderer,
    map: GameMap,
    casters: Caster[],
    private readonly shared: Shared,
  ) {
    const isTouched = matchMedia("(pointer: coarse)").matches;
    const most = Math.min(isTouched ? MOST_BY_TOUCH : MOST, renderer.capabilities.maxTextureSize);
    const size = Math.min(most, powerOfTwo(map.size / FINEST));
    shared.shadowFrame.value.set(map.size / 2 + 1, ...heightsOf(map), 0);
    const { x, y, z } = shared.sun.value;
    const { floor, roof } = map.kinds;
    this.targets = [targetOf(size), targetOf(size / COARSER)];
    this.materials = [casterOf(shared, [x / y, z / y], [-1, -1]), casterOf(shared, [0, 0], [floor, roof])];
    const roofs = casters.filter(({ isRoof }) => isRoof);
    this.waiting = [casters, roofs].flatMap((each, target) =>
      each.map((caster): [Caster, number] => [caster, target]),
    );
    this.least = Math.ceil(this.waiting.length / LONGEST);
    for (const target of this.targets) {
      renderer.setRenderTarget(target);
      renderer.clear();
    }
    renderer.setRenderTarget(null);
  }

  get areWhole(): boolean {
    return !this.waiting.length;
  }

  // Draw the shadows of so many more meshes, or of more on a large map.
  go(most: number): void {
    const { renderer, shared } = this;
    renderer.autoClear = false;
    for (const [caster, target] of this.waiting.splice(0, Math.max(most, this.least)))
      this.draw(caster, target);
    renderer.setRenderTarget(null);
    renderer.autoClear = true;
    if (!this.areWhole) return;
    for (const each of this.materials) each.dispose();
    [shared.shadowMap.value, shared.roofMap.value] = this.targets.map(({ depthTexture }) => depthTexture);
  }

  dispose(): void {
    for (const each of [...this.targets, ...this.materials]) each.dispose();
  }

  private draw({ mesh, start, count }: Caster, target: number): void {
    const scene = new Scene();
    scene.overrideMaterial = this.materials[target];
    scene.matrixWorldAutoUpdate = false;
    scene.children.push(mesh); // which stays where it is
    const { geometry } = mesh;
    const { start: startBefore, count: countBefore } = geometry.drawRange;
    geometry.setDrawRange(start, count);
    mesh.frustumCulled = false;
    this.renderer.setRenderTarget(this.targets[target]);
    this.renderer.render(scene, new Camera());
    mesh.frustumCulled = true;
    geometry.setDrawRange(startBefore, countBefore);
  }
}

function casterOf(shared: Shared, lean: [number, number], kinds: [number, number]): ShaderMaterial {
  return material(shared, VERTEX, FRAGMENT, {
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
    uniforms: { lean: { value: lean }, kinds: { value: kinds } },
  });
}

function targetOf(size: number): WebGLRenderTarget {
  const depth = new DepthTexture(size, size, UnsignedShortType);
  depth.compareFunction = LessEqualCompare;
  depth.minFilter = depth.magFilter = LinearFilter;
  depth.colorSpace = NoColorSpace;
  return new WebGLRenderTarget(size, size, {
    depthTexture: depth,
    format: RedFormat, // of colours, which nobody reads
    stencilBuffer: false,
  });
}

// The lowest place of the ground and the highest of anything.
function heightsOf({ ground, solids }: GameMap): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const height of ground.heights) {
    low = Math.min(low, height);
    high = Math.max(high, height);
  }
  for (let at = 1; at < solids.corners.length; at += 3) high = Math.max(high, solids.corners[at]);
  return [low - 0.5, high + 0.5];
}

function powerOfTwo(value: number): number {
  return 2 ** Math.round(Math.log2(Math.max(256, value)));
}
