// Water: the bed seen through it, bluer with depth, and the sky reflected in ripples, as in shading/water.py.

import { BufferAttribute, BufferGeometry, Mesh } from "three";
import type { GameMap } from "../data/map";
import { trianglesOf } from "../view/terrain";
import { material, type Shared } from "./shared";

const CORNERS = 4; // of a cell

const VERTEX = /* glsl */ `
in vec3 color; // of the bed
in float depth; // m
out vec3 place, base;
out float deep;
void main() {
  place = position;
  base = color;
  deep = depth;
  gl_Position = project(position);
}`;
const FRAGMENT = /* glsl */ `
in vec3 place, base;
in float deep;
vec3 rippled(float footprint) {
  float steep = 0.16 * sharpness(0.9, footprint);
  if (steep == 0.0 || detail == 0.0) return vec3(0.0, 1.0, 0.0);
  vec2 at = place.xz / 0.9;
  float east = noise(at * vec2(1.0, 0.6)) + 0.6 * noise(at * vec2(2.3, 1.7) + vec2(0.0, 31.0)) - 0.8;
  vec2 other = at + vec2(71.0, 0.0);
  float north = noise(other * vec2(1.0, 0.6)) + 0.6 * noise(at * vec2(2.3, 1.7) + vec2(71.0, 93.0)) - 0.8;
  return normalize(vec3(steep * east, 1.0, steep * north));
}
void main() {
  vec3 way = far == 0.0 ? vec3(0.0, -1.0, 0.0) : normalize(place - eye);
  float footprint = far == 0.0 ? pixel : pixel * distance(place, eye) / max(0.05, -way.y);
  float clear = square(0.9 / (0.9 + max(0.0, deep)));
  vec3 color = mix(vec3(26.0, 84.0, 132.0) / 255.0, base, clear);
  vec3 up = vec3(0.0, 1.0, 0.0);
  color *= lightOn(up, 0.6 + 0.4 * sunShare(place, up));
  vec3 normal = rippled(footprint);
  float facing = clamp(-dot(way, normal), 0.0, 1.0);
  float share = min(0.75, 0.02 + 0.98 * pow(1.0 - facing, 5.0));
  float rise = max(0.02, way.y + 2.0 * facing * normal.y);
  shown = vec4(throughAir(mix(color, haze(rise), share), place), 1.0);
}`;

export function createWater({ ground, water }: GameMap, shared: Shared): Mesh {
  const cells = water.levels.length;
  const places = new Float32Array(3 * CORNERS * cells);
  const beds = new Uint8Array(4 * CORNERS * cells);
  const depths = new Float32Array(CORNERS * cells);
  const triangles: number[] = [];
  for (let cell = 0; cell < cells; cell++) {
    for (let corner = 0; corner < CORNERS; corner++) {
      const [row, column] = [water.rows[cell] + (corner >> 1), water.columns[cell] + (corner & 1)];
      const at = CORNERS * cell + corner;
      const under = row * ground.columns + column;
      places[3 * at] = ground.corner[0] + ground.cell * column;
      places[3 * at + 1] = water.levels[cell];
      places[3 * at + 2] = ground.corner[1] + ground.cell * row;
      depths[at] = water.levels[cell] - ground.heights[under];
      for (let channel = 0; channel < 3; channel++)
        beds[4 * at + channel] = ground.colors[3 * under + channel];
    }
    triangles.push(...trianglesOf(CORNERS * cell, 2));
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.setAttribute("color", new BufferAttribute(beds, 4, true));
  geometry.setAttribute("depth", new BufferAttribute(depths, 1));
  geometry.setIndex(triangles);
  const mesh = new Mesh(geometry, material(shared, VERTEX, FRAGMENT));
  mesh.frustumCulled = false;
  return mesh;
}
