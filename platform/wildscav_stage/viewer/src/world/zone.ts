// The safe zone of a royale: a wall of light around it, and on the ground the circle that it shrinks to.

import { BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, Group, Mesh } from "three";
import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import { heightAt } from "../view/terrain";
import { cylinder } from "./parts";
import { material, type Shared } from "./shared";

const SIDES = 180;
const WALL = [-12, 45]; // m, from the ground at its middle to the top
const RING = [0.1, 0.0025]; // half the width of the next circle: m, and m per m of its radius
const OVER = 0.25; // m over the ground

const VERTEX = /* glsl */ `
out vec3 place;
out float rise;
void main() {
  rise = position.y;
  place = vec3(zone.x + position.x * zone.z, mix(bottom, top, position.y), zone.y + position.z * zone.z);
  gl_Position = project(place);
}`;
const FRAGMENT = /* glsl */ `
in vec3 place;
in float rise;
void main() {
  float angle = atan(place.x - zone.x, place.z - zone.y) * zone.z;
  float height = place.y;
  float bars = smoothstep(0.9, 1.0, abs(2.0 * fract(angle / 6.0) - 1.0));
  float rings = smoothstep(0.85, 1.0, abs(2.0 * fract(height / 6.0) - 1.0));
  float seen = (0.16 + 0.2 * max(bars, rings)) * (1.0 - smoothstep(0.3, 1.0, rise));
  shown = vec4(0.74, 0.36, 1.0, seen);
}`;
// The border from above, of constant width.
const BORDER_VERTEX = /* glsl */ `
void main() {
  float radius = zone.z + (2.0 * position.y - 1.0) * 1.2 * perPixel * pixel;
  gl_Position = project(vec3(zone.x + position.x * radius, top, zone.y + position.z * radius));
}`;
const BORDER_FRAGMENT = /* glsl */ `
void main() { shown = vec4(0.78, 0.42, 1.0, 0.95); }`;
const RING_VERTEX = /* glsl */ `
out vec3 place;
void main() { place = position; gl_Position = project(position); }`;
const RING_FRAGMENT = /* glsl */ `
in vec3 place;
void main() { shown = vec4(throughAir(vec3(1.0), place), 0.85); }`;

export interface Zone {
  group: Group;
  show(frame: number, isFromAbove: boolean): void;
}

export function createZone(map: GameMap, course: Course, shared: Shared): Zone {
  const range = { bottom: { value: 0 }, top: { value: 0 } };
  const bounds = "uniform float bottom, top;";
  const wall = new Mesh(
    cylinder(SIDES, [0, 1]),
    material(shared, bounds + VERTEX, FRAGMENT, {
      ...{ uniforms: range, transparent: true, depthWrite: false, side: DoubleSide },
    }),
  );
  const ring = new Mesh(
    new BufferGeometry(),
    material(shared, RING_VERTEX, RING_FRAGMENT, { transparent: true, depthWrite: false, side: DoubleSide }),
  );
  const border = new Mesh(
    wall.geometry,
    material(shared, bounds + BORDER_VERTEX, BORDER_FRAGMENT, {
      ...{ uniforms: range, transparent: true, depthTest: false, side: DoubleSide },
    }),
  );
  const places = new BufferAttribute(new Float32Array(6 * (SIDES + 1)), 3).setUsage(DynamicDrawUsage);
  ring.geometry.setAttribute("position", places);
  ring.geometry.setIndex(wall.geometry.index);
  wall.frustumCulled = ring.frustumCulled = border.frustumCulled = false;
  [ring.renderOrder, wall.renderOrder, border.renderOrder] = [3, 5, 4];
  const group = new Group();
  group.add(ring, wall, border);
  let drawn = "";
  const show = (frame: number, isFromAbove: boolean) => {
    const zone = course.zoneAt(frame);
    group.visible = zone !== null;
    if (!zone) {
      shared.zone.value.set(0, 0, 0, 0);
      return;
    }
    const { now, next } = zone;
    border.visible = isFromAbove;
    wall.visible = !isFromAbove;
    ring.material.depthTest = !isFromAbove;
    shared.zone.value.set(now.x, now.z, now.radius, 1);
    const ground = heightAt(map.ground, now.x, now.z);
    range.bottom.value = ground + WALL[0];
    range.top.value = ground + WALL[1];
    const key = `${next.x},${next.z},${next.radius}`;
    if (key !== drawn) layRing(places, map, next);
    drawn = key;
  };
  return { group, show };
}

// Lay a ring on the ground, as far as there is ground.
function layRing(
  places: BufferAttribute,
  map: GameMap,
  circle: { x: number; z: number; radius: number },
): void {
  for (let side = 0; side <= SIDES; side++) {
    const angle = (2 * Math.PI * side) / SIDES;
    for (const edge of [0, 1]) {
      const radius = Math.max(0, circle.radius + (2 * edge - 1) * (RING[0] + RING[1] * circle.radius));
      const [x, z] = [circle.x + Math.sin(angle) * radius, circle.z + Math.cos(angle) * radius];
      places.setXYZ(2 * side + edge, x, heightAt(map.ground, x, z) + OVER, z);
    }
  }
  places.needsUpdate = true;
}
