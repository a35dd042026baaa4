// The ground of the map, in square pieces of which only those in view are drawn, and the land beyond its edge.

import { BufferAttribute, BufferGeometry, Group, Mesh, type ShaderMaterial, Sphere, Vector3 } from "three";
import type { GameMap, Ground } from "../data/map";
import { normalsOf, trianglesOf } from "../view/terrain";
import { material, type Shared } from "./shared";

const PIECE = 32; // cells along a side of a piece
// Beyond the edge: how far out in m, and how much of the edge's height and colour is left there.
const RINGS = [
  [0, 1, 1],
  [2, 0.96, 0.7],
  [14, 0.75, 0.2],
  [60, 0.35, 0],
  [250, 0.1, 0],
  [1200, 0, 0],
  [6000, 0, 0],
];
const PALE = [112, 132, 92]; // the colour of that land
const BANK = 0.3; // m that the land beyond the edge rises over water

const VERTEX = /* glsl */ `
in vec4 color;
out vec3 place, facing, base;
void main() {
  place = position;
  facing = normal;
  base = color.rgb;
  gl_Position = project(position);
}`;
const FRAGMENT = /* glsl */ `
in vec3 place, facing, base;
uniform float isBeyond;
float grains(vec2 at, float footprint) {
  float bright = 1.0;
  float coarse = 0.20 * sharpness(2.3, footprint), medium = 0.26 * sharpness(0.45, footprint);
  float fine = detail < 2.0 ? 0.0 : 0.34 * sharpness(0.11, footprint);
  if (coarse > 0.0) bright += coarse * (noise(at / 2.3) - 0.5);
  if (medium > 0.0) bright += medium * (noise(at / 0.45) - 0.5);
  if (fine > 0.0) bright += fine * (noise(at / 0.11) - 0.5);
  return bright;
}
void main() {
  vec3 normal = normalize(facing), ray = place - eye, color = base;
  float way = length(ray);
  float footprint = far == 0.0 ? pixel : pixel * way / max(0.05, -dot(ray, normal) / way);
  if (detail > 0.0) color *= grains(place.xz, footprint);
  color *= lightOn(normal, isBeyond > 0.0 ? 1.0 : sunShare(place, normal));
  shown = vec4(throughAir(color, place), 1.0);
}`;

export function createGround(map: GameMap, shared: Shared): Group {
  const { ground } = map;
  const group = new Group();
  const corners = cornersOf(ground);
  const own = material(shared, VERTEX, FRAGMENT, { uniforms: { isBeyond: { value: 0 } } });
  for (let row = 0; row < ground.rows - 1; row += PIECE)
    for (let column = 0; column < ground.columns - 1; column += PIECE)
      group.add(piece(ground, corners, row, column, own));
  const beyond = material(shared, VERTEX, FRAGMENT, { uniforms: { isBeyond: { value: 1 } } });
  const apron = new Mesh(landBeyond(map), beyond);
  apron.frustumCulled = false;
  apron.name = "beyond";
  group.add(apron);
  return group;
}

// The attributes of all corners, which the pieces share.
function cornersOf(ground: Ground): Record<string, BufferAttribute> {
  const { rows, columns, cell, corner, heights, colors } = ground;
  const count = rows * columns;
  const places = new Float32Array(3 * count);
  const paints = new Uint8Array(4 * count);
  for (let at = 0; at < count; at++) {
    places[3 * at] = corner[0] + cell * (at % columns);
    places[3 * at + 1] = heights[at];
    places[3 * at + 2] = corner[1] + cell * Math.floor(at / columns);
    for (let channel = 0; channel < 3; channel++) paints[4 * at + channel] = colors[3 * at + channel];
  }
  const normals = Int16Array.from(normalsOf(ground), (part) => 32767 * part);
  return {
    position: new BufferAttribute(places, 3),
    normal: new BufferAttribute(normals, 3, true),
    color: new BufferAttribute(paints, 4, true),
  };
}

function piece(
  ground: Ground,
  corners: Record<string, BufferAttribute>,
  row: number,
  column: number,
  own: ShaderMaterial,
): Mesh {
  const { columns, cell, corner, heights } = ground;
  const lastRow = Math.min(row + PIECE, ground.rows - 1);
  const lastColumn = Math.min(column + PIECE, columns - 1);
  const triangles: number[] = [];
  let [low, high] = [Infinity, -Infinity];
  for (let r = row; r < lastRow; r++) {
    for (let c = column; c < lastColumn; c++) {
      const at = r * columns + c;
      triangles.push(...trianglesOf(at, columns));
      low = Math.min(low, heights[at], heights[at + columns + 1]);
      high = Math.max(high, heights[at], heights[at + columns + 1]);
    }
  }
  const geometry = new BufferGeometry();
  for (const [name, values] of Object.entries(corners)) geometry.setAttribute(name, values);
  geometry.setIndex(triangles);
  const [x, z] = [corner[0] + (cell * (column + lastColumn)) / 2, corner[1] + (cell * (row + lastRow)) / 2];
  const across = (cell * Math.hypot(lastColumn - column, lastRow - row)) / 2;
  geometry.boundingSphere = new Sphere(
    new Vector3(x, (low + high) / 2, z),
    Math.hypot(across, (high - low) / 2 + 2),
  );
  return new Mesh(geometry, own);
}

// Land that goes on from the edge of the map, ever flatter and paler, until the haze hides it.
function landBeyond(map: GameMap): BufferGeometry {
  const { ground, water } = map;
  const edge = edgeOf(ground);
  const wet = new Map<number, number>();
  for (let cell = 0; cell < water.levels.length; cell++)
    wet.set(water.rows[cell] * ground.columns + water.columns[cell], water.levels[cell]);
  const level = edge.reduce((sum, at) => sum + ground.heights[at], 0) / edge.length;
  const normals = normalsOf(ground);
  const [places, facing, paints]: [number[], number[], number[]] = [[], [], []];
  for (const [outward, height, share] of RINGS) {
    for (const at of edge) {
      const [row, column] = [Math.floor(at / ground.columns), at % ground.columns];
      const x = ground.corner[0] + ground.cell * column;
      const z = ground.corner[1] + ground.cell * row;
      const scale = 1 + outward / (map.size / 2);
      const shore = outward > 0 ? shoreOf(wet, ground, row, column) : -Infinity;
      const own = Math.max(ground.heights[at], shore + BANK);
      places.push(x * scale, level + (own - level) * height, z * scale);
      const steep = outward > 0 ? 0.25 * height : 1;
      facing.push(normals[3 * at] * steep, Math.max(0.5, normals[3 * at + 1]), normals[3 * at + 2] * steep);
      for (let channel = 0; channel < 3; channel++)
        paints.push((share * ground.colors[3 * at + channel] + (1 - share) * PALE[channel]) / 255);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
  geometry.setAttribute("normal", new BufferAttribute(new Float32Array(facing), 3));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(paints), 3));
  geometry.setIndex(ringTriangles(edge.length));
  return geometry;
}

// The corners along the edge of the map, counter-clockwise from above with north up.
function edgeOf({ rows, columns }: Ground): number[] {
  const edge: number[] = [];
  for (let column = 0; column < columns - 1; column++) edge.push(column);
  for (let row = 0; row < rows - 1; row++) edge.push(row * columns + columns - 1);
  for (let column = columns - 1; column > 0; column--) edge.push((rows - 1) * columns + column);
  for (let row = rows - 1; row > 0; row--) edge.push(row * columns);
  return edge;
}

// The level of water in a cell beside a corner; -inf if it is dry.
function shoreOf(wet: Map<number, number>, ground: Ground, row: number, column: number): number {
  let level = -Infinity;
  for (const r of [row - 1, row])
    for (const c of [column - 1, column]) level = Math.max(level, wet.get(r * ground.columns + c) ?? level);
  return level;
}

function ringTriangles(count: number): number[] {
  const triangles: number[] = [];
  for (let ring = 0; ring < RINGS.length - 1; ring++) {
    for (let at = 0; at < count; at++) {
      const [a, b] = [ring * count + at, ring * count + ((at + 1) % count)];
      triangles.push(a, b, b + count, a, b + count, a + count);
    }
  }
  return triangles;
}
