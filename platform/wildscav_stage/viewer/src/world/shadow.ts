// The shadows of the map. The sun stands still and so does the map, so they are computed once, as a height for
// each ray of the sun: of the highest surface on it. A ray has the number of the place where it crosses the
// lowest level of the map. The map of roofs is the same for rays straight down, and floors and roofs alone.

import {
  Camera,
  DepthTexture,
  DoubleSide,
  type Group,
  LessEqualCompare,
  LinearFilter,
  NoColorSpace,
  type Object3D,
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

export interface Shadows {
  dispose(): void;
}

// Draw the shadow maps of ground and solids, and let all surfaces use them.
export function castShadows(
  renderer: WebGLRenderer,
  map: GameMap,
  casters: Group[],
  shared: Shared,
): Shadows {
  const isTouched = matchMedia("(pointer: coarse)").matches;
  const most = Math.min(isTouched ? MOST_BY_TOUCH : MOST, renderer.capabilities.maxTextureSize);
  const size = Math.min(most, powerOfTwo(map.size / FINEST));
  const [low, high] = heightsOf(map);
  shared.shadowFrame.value.set(map.size / 2 + 1, low, high, 0);
  const { x, y, z } = shared.sun.value;
  const { floor, roof } = map.kinds;
  const bySun = drawCasters(renderer, casters, casterOf(shared, [x / y, z / y], [-1, -1]), size);
  const byRoofs = drawCasters(renderer, casters, casterOf(shared, [0, 0], [floor, roof]), size / COARSER);
  shared.shadowMap.value = bySun.depthTexture;
  shared.roofMap.value = byRoofs.depthTexture;
  shared.shadowFrame.value.w = 1;
  return {
    dispose: () => {
      bySun.dispose();
      byRoofs.dispose();
    },
  };
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

function drawCasters(
  renderer: WebGLRenderer,
  casters: Group[],
  caster: ShaderMaterial,
  size: number,
): WebGLRenderTarget {
  const target = targetOf(size);
  const scene = new Scene();
  scene.overrideMaterial = caster;
  const homes = casters.map((group) => group.parent as Object3D);
  const meshes = casters.flatMap((group) => group.children).filter((each) => each.name !== "beyond");
  const hidden = casters.flatMap((group) => group.children).filter((each) => each.name === "beyond");
  for (const each of hidden) each.visible = false;
  for (const each of meshes) each.frustumCulled = false;
  scene.add(...casters);
  renderer.setRenderTarget(target);
  renderer.clear();
  renderer.render(scene, new Camera());
  renderer.setRenderTarget(null);
  for (const each of meshes) each.frustumCulled = true;
  for (const each of hidden) each.visible = true;
  casters.forEach((group, place) => {
    homes[place].add(group);
  });
  caster.dispose();
  return target;
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
