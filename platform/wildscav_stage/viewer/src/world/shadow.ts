// The shadows of the map. The sun stands still and so does the map, so they are computed once, as a height for
// each ray of the sun: of the highest surface on it. A ray has the number of the place where it crosses the
// lowest level of the map.

import {
  Camera,
  DepthTexture,
  DoubleSide,
  Group,
  LessEqualCompare,
  LinearFilter,
  Mesh,
  NoColorSpace,
  type Object3D,
  Scene,
  UnsignedShortType,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import type { GameMap } from "../data/map";
import { material, type Shared } from "./shared";

const FINEST = 0.1; // m that a number of the map covers, where there is room
const MOST = 4096; // numbers along a side

const VERTEX = /* glsl */ `
void main() {
  vec3 at = inShadowMap(position);
  gl_Position = vec4(at.xy, 2.0 * at.z - 1.0, 1.0);
}`;
const FRAGMENT = /* glsl */ `
void main() { shown = vec4(1.0); }`;

export interface Shadows {
  dispose(): void;
}

// Draw the shadow map of what casts shadows, and let all surfaces use it.
export function castShadows(
  renderer: WebGLRenderer,
  map: GameMap,
  casters: Group[],
  shared: Shared,
): Shadows {
  const size = Math.min(MOST, renderer.capabilities.maxTextureSize, powerOfTwo(map.size / FINEST));
  const depth = new DepthTexture(size, size, UnsignedShortType);
  depth.compareFunction = LessEqualCompare;
  depth.minFilter = depth.magFilter = LinearFilter;
  depth.colorSpace = NoColorSpace;
  const target = new WebGLRenderTarget(size, size, { depthTexture: depth, stencilBuffer: false });
  const [low, high] = heightsOf(map);
  shared.shadowFrame.value.set(map.size / 2 + 1, low, high, 0);
  const caster = material(shared, VERTEX, FRAGMENT, {
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
  drawCasters(renderer, target, casters, caster);
  caster.dispose();
  shared.shadowMap.value = depth;
  shared.shadowFrame.value.w = 1;
  return { dispose: () => target.dispose() };
}

function drawCasters(
  renderer: WebGLRenderer,
  target: WebGLRenderTarget,
  casters: Group[],
  caster: Scene["overrideMaterial"],
): void {
  const scene = new Scene();
  scene.overrideMaterial = caster;
  const homes = casters.map((group) => group.parent as Object3D);
  const hidden = casters.flatMap((group) => group.children).filter((each) => each.name === "beyond");
  const setCulled = (isCulled: boolean) =>
    casters.forEach((group) => {
      for (const mesh of group.children) if (mesh instanceof Mesh) mesh.frustumCulled = isCulled;
    });
  for (const each of hidden) each.visible = false;
  setCulled(false);
  scene.add(...casters);
  renderer.setRenderTarget(target);
  renderer.clear();
  renderer.render(scene, new Camera());
  renderer.setRenderTarget(null);
  setCulled(true);
  for (const each of hidden) {
    each.visible = true;
    (each as Mesh).frustumCulled = false;
  }
  casters.forEach((group, place) => homes[place].add(group));
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
