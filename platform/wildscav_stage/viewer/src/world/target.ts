// The target of a navigation: a beam of light, seen from everywhere.

import { DoubleSide, Group, Mesh } from "three";
import type { Course } from "../data/course";
import { METRE } from "../data/trails";
import { cylinder, squares } from "./parts";
import { material, type Shared } from "./shared";

const SIDES = 24;
const RADIUS = 0.45; // m
const RISE = 40; // m

const VERTEX = /* glsl */ `
uniform vec3 target;
out float rise;
out vec2 facing;
void main() {
  rise = position.y;
  float wide = ${RADIUS} + (position.y < 0.02 ? 0.5 : 0.0);
  vec3 place = target + vec3(position.x * wide, position.y * ${RISE}.0, position.z * wide);
  facing = vec2(dot(normalize(position.xz), normalize(eye.xz - place.xz + 1e-4)), 0.0);
  gl_Position = project(place);
}`;
const FRAGMENT = /* glsl */ `
in float rise;
in vec2 facing;
void main() {
  float edge = 0.35 + 0.65 * abs(facing.x);
  shown = vec4(mix(vec3(1.0, 0.86, 0.3), vec3(1.0, 0.98, 0.8), edge), edge * 0.62 * square(1.0 - rise));
}`;
const MARK_VERTEX = /* glsl */ `
uniform vec3 target;
out vec2 at;
void main() {
  at = position.xy;
  vec4 middle = project(target + vec3(0.0, 0.6, 0.0));
  gl_Position = middle + vec4(position.xy * 28.0 * perPixel / viewport * middle.w, 0.0, 0.0);
}`;
const MARK_FRAGMENT = /* glsl */ `
in vec2 at;
void main() {
  float off = length(at);
  if (off > 1.0) discard;
  vec3 color = off < 0.28 || (off > 0.5 && off < 0.86) ? vec3(1.0, 0.84, 0.2) : vec3(0.08, 0.07, 0.03);
  shown = vec4(color, off < 0.28 || off > 0.44 ? 0.95 : 0.25);
}`;

// The beam, and a mark of constant size; nothing in a match without a target.
export function createTarget(course: Course, shared: Shared): Group {
  const group = new Group();
  const { target } = course.trails;
  if (!target) return group;
  const place = [target.x / METRE, target.height / METRE, target.z / METRE];
  const options = {
    uniforms: { target: { value: place } },
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
  };
  const beam = new Mesh(cylinder(SIDES, [0, 0.02, 1]), material(shared, VERTEX, FRAGMENT, options));
  const square = squares(1);
  square.setDrawRange(0, Infinity);
  const mark = new Mesh(
    square,
    material(shared, MARK_VERTEX, MARK_FRAGMENT, { ...options, depthTest: false }),
  );
  beam.frustumCulled = mark.frustumCulled = false;
  [beam.renderOrder, mark.renderOrder] = [5, 7];
  group.add(beam, mark);
  return group;
}
