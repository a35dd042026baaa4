// The bodies of all agents, and their shadows. The dead lie on their backs and are grey.

import {
  DataTexture,
  EqualStencilFunc,
  Group,
  IncrementStencilOp,
  Mesh,
  NearestFilter,
  RGBAFormat,
} from "three";
import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import type { Moment } from "../view/moment";
import { heightAt } from "../view/terrain";
import { geometryOf, perCopy } from "./parts";
import { material, type Shared } from "./shared";

const ON_GROUND = 0.3; // m above it, up to which a shadow lies along the ground
const STEP = 0.5; // m, over which the slope of the ground is measured

const POSE = /* glsl */ `
in float part;
in vec4 stand; // where it stands, and its yaw in radians
in vec4 state; // seat, 1 if it is dead or -1 if nobody can hurt it, the flash of a hit, how much larger it is drawn
vec3 lain(vec3 at) { return state.y > 0.5 ? vec3(at.x, at.z, -at.y) : at; }
vec3 turned(vec3 at) {
  float east = sin(stand.w), north = cos(stand.w);
  return vec3(at.x * north + at.z * east, at.y, at.z * north - at.x * east);
}
vec3 posed() {
  vec3 at = lain(position) + (state.y > 0.5 ? vec3(0.0, 0.24, 0.9) : vec3(0.0));
  return stand.xyz + state.w * turned(at);
}`;
const VERTEX = /* glsl */ `
${POSE}
uniform sampler2D colors; // parts across, seats down
out vec3 place, facing, base;
void main() {
  place = posed();
  facing = turned(lain(normal));
  base = texelFetch(colors, ivec2(int(part), int(state.x)), 0).rgb;
  if (state.y > 0.5) base = mix(vec3(dot(base, vec3(0.3, 0.5, 0.2))), vec3(0.42), 0.6);
  if (state.y < -0.5) base = mix(base, vec3(1.0), 0.5); // as in the engine's pictures
  base = mix(base, vec3(1.6, 0.5, 0.4), 0.8 * state.z);
  gl_Position = project(place);
}`;
const FRAGMENT = /* glsl */ `
in vec3 place, facing, base;
void main() { shown = objectAt(place, facing, base, 0.0); }`;
const SHADOW_VERTEX = /* glsl */ `
${POSE}
in vec2 slope; // of the ground, to the east and to the north
out vec3 place;
void main() {
  vec3 at = posed();
  float above = at.y - stand.y - dot(slope, at.xz - stand.xz);
  place = at - sun * (above / (sun.y - dot(slope, sun.xz))) + vec3(0.0, 0.03, 0.0);
  gl_Position = project(place);
}`;
const SHADOW_FRAGMENT = /* glsl */ `
in vec3 place;
void main() {
  float seen = far == 0.0 ? 1.0 : 1.0 - square(min(1.0, distance(place, eye) / far));
  shown = vec4(0.0, 0.0, 0.05, 0.36 * seen * sunShare(place, vec3(0.0, 1.0, 0.0)));
}`;

export interface Agents {
  group: Group;
  // hidden: the seat whose body is not shown. scale: how much larger than they are.
  show(moment: Moment, hidden: number | null, scale: number): void;
  dispose(): void;
}

export function createAgents(map: GameMap, course: Course, shared: Shared): Agents {
  const count = course.seats.length;
  const geometry = geometryOf(map.body);
  const stand = perCopy(geometry, "stand", 4, count);
  const state = perCopy(geometry, "state", 4, count);
  const slope = perCopy(geometry, "slope", 2, count);
  const colors = colorsOf(map, course);
  const body = material(shared, VERTEX, FRAGMENT, { uniforms: { colors: { value: colors } } });
  const group = new Group();
  group.add(new Mesh(geometry, body), shadowOf(geometry, shared));
  for (const mesh of group.children) mesh.frustumCulled = false;
  const show = ({ states, flashes }: Moment, hidden: number | null, scale: number) => {
    let copies = 0;
    for (let seat = 0; seat < count; seat++) {
      if (seat === hidden) continue;
      const { x, y, z, yaw, health, isSafe } = states[seat];
      stand.setXYZW(copies, x, y, z, (yaw * Math.PI) / 180);
      state.setXYZW(copies, seat, health > 0 ? (isSafe ? -1 : 0) : 1, flashes[seat], scale);
      const height = heightAt(map.ground, x, z);
      const isOnGround = Math.abs(y - height) < ON_GROUND;
      const toEast = (heightAt(map.ground, x + STEP, z) - heightAt(map.ground, x - STEP, z)) / (2 * STEP);
      const toNorth = (heightAt(map.ground, x, z + STEP) - heightAt(map.ground, x, z - STEP)) / (2 * STEP);
      slope.setXY(copies, isOnGround ? toEast : 0, isOnGround ? toNorth : 0);
      copies++;
    }
    geometry.instanceCount = copies;
    stand.needsUpdate = state.needsUpdate = slope.needsUpdate = true;
  };
  return { group, show, dispose: () => colors.dispose() };
}

// Each place on the ground is darkened once, however many parts of bodies are between it and the sun.
function shadowOf(geometry: Mesh["geometry"], shared: Shared): Mesh {
  const shadow = material(shared, SHADOW_VERTEX, SHADOW_FRAGMENT, {
    transparent: true,
    depthWrite: false,
    polygonOffset: true,
    polygonOffsetFactor: -2,
    polygonOffsetUnits: -2,
    stencilWrite: true,
    stencilFunc: EqualStencilFunc,
    stencilRef: 0,
    stencilZPass: IncrementStencilOp,
  });
  const mesh = new Mesh(geometry, shadow);
  mesh.renderOrder = 2;
  return mesh;
}

function colorsOf(map: GameMap, course: Course): DataTexture {
  const parts = map.body.length;
  const values = new Uint8Array(4 * parts * Math.max(1, course.seats.length)).fill(255);
  course.seats.forEach((seat, row) => {
    seat.colors.forEach((color, part) => {
      values.set(color, 4 * (row * parts + part));
    });
  });
  const texture = new DataTexture(values, parts, Math.max(1, course.seats.length), RGBAFormat);
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}
