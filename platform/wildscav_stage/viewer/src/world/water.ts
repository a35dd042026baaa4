// Water: the bed seen through it, bluer with depth, and the sky reflected in ripples, as in shading/water.py.

import { BufferAttribute, BufferGeometry, DataTexture, LinearFilter, Mesh, RGBAFormat } from "three";
import type { GameMap } from "../data/map";
import { trianglesOf } from "../view/terrain";
import { material, type Shared } from "./shared";

const DEEPEST = 6; // m of depth that the map of beds can tell

const VERTEX = /* glsl */ `
uniform vec4 frame; // x and z of the south-western corner, and how much of the map of beds is in a m to each side
out vec3 place;
out vec2 at;
void main() {
  place = position;
  at = (position.xz - frame.xy) * frame.zw;
  gl_Position = project(position);
}`;
const FRAGMENT = /* glsl */ `
in vec3 place;
in vec2 at;
uniform sampler2D beds; // their colours, and how deep they lie
vec3 rippled(float footprint) {
  float steep = 0.16 * sharpness(0.9, footprint);
  if (steep == 0.0) return vec3(0.0, 1.0, 0.0);
  vec2 wave = place.xz / 0.9;
  float east = noise(wave * vec2(1.0, 0.6)) + 0.6 * noise(wave * vec2(2.3, 1.7) + vec2(0.0, 31.0)) - 0.8;
  vec2 other = wave + vec2(71.0, 0.0);
  float north = noise(other * vec2(1.0, 0.6)) + 0.6 * noise(wave * vec2(2.3, 1.7) + vec2(71.0, 93.0)) - 0.8;
  return normalize(vec3(steep * east, 1.0, steep * north));
}
void main() {
  vec3 way = far == 0.0 ? vec3(0.0, -1.0, 0.0) : normalize(place - eye);
  float footprint = far == 0.0 ? pixel : pixel * distance(place, eye) / max(0.2, -way.y);
  vec4 bed = texture(beds, at);
  float clear = square(0.9 / (0.9 + ${DEEPEST}.0 * bed.a));
  vec3 color = mix(deep, bed.rgb, clear);
  vec3 up = vec3(0.0, 1.0, 0.0);
  color *= lightOn(up, 0.6 + 0.4 * sunShare(place, up), 1.0);
  vec3 normal = rippled(footprint);
  float facing = clamp(-dot(way, normal), 0.0, 1.0);
  float share = min(0.75, 0.02 + 0.98 * pow(1.0 - facing, 5.0));
  float rise = max(0.02, way.y + 2.0 * facing * normal.y);
  shown = vec4(throughAir(mix(color, haze(rise), share), place), 1.0);
}`;

export interface Water {
  mesh: Mesh;
  dispose(): void;
}

export function createWater(map: GameMap, shared: Shared): Water {
  const { ground } = map;
  const places: number[] = [];
  const triangles: number[] = [];
  for (const { row, column, rows, columns, level } of rectanglesOf(map)) {
    const first = places.length / 3;
    const [x, z] = [ground.corner[0] + ground.cell * column, ground.corner[1] + ground.cell * row];
    const [east, north] = [x + ground.cell * columns, z + ground.cell * rows];
    places.push(x, level, z, east, level, z, x, level, north, east, level, north);
    triangles.push(...trianglesOf(first, 2));
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
  geometry.setIndex(triangles);
  const beds = bedsOf(map);
  const scale = [1 / (ground.cell * ground.columns), 1 / (ground.cell * ground.rows)];
  // The first texel's middle is the south-western corner.
  const [x, z] = [ground.corner[0] - ground.cell / 2, ground.corner[1] - ground.cell / 2];
  const uniforms = { beds: { value: beds }, frame: { value: [x, z, ...scale] } };
  const mesh = new Mesh(geometry, material(shared, VERTEX, FRAGMENT, { uniforms }));
  mesh.frustumCulled = false;
  return { mesh, dispose: () => beds.dispose() };
}

interface Rectangle {
  row: number;
  column: number;
  rows: number;
  columns: number;
  level: number;
}

// Wet cells, as few rectangles: cells of a row are joined, then rows that are alike.
function rectanglesOf({ water }: GameMap): Rectangle[] {
  const all: Rectangle[] = [];
  const open = new Map<string, Rectangle>(); // by their columns and level, those that end at the present row
  for (let cell = 0; cell < water.levels.length; ) {
    const [row, column, level] = [water.rows[cell], water.columns[cell], water.levels[cell]];
    let columns = 0;
    while (
      water.rows[cell] === row &&
      water.columns[cell] === column + columns &&
      water.levels[cell] === level
    ) {
      columns++;
      cell++;
    }
    const key = `${column},${columns},${level}`;
    const below = open.get(key);
    if (below && below.row + below.rows === row) {
      below.rows++;
      continue;
    }
    const rectangle = { row, column, rows: 1, columns, level };
    all.push(rectangle);
    open.set(key, rectangle);
  }
  return all;
}

// The colours of the ground at all corners, and how deep under water they are.
function bedsOf({ ground, water }: GameMap): DataTexture {
  const values = new Uint8Array(4 * ground.rows * ground.columns);
  for (let at = 0; at < ground.rows * ground.columns; at++)
    values.set(ground.colors.subarray(3 * at, 3 * at + 3), 4 * at);
  water.levels.forEach((level, cell) => {
    for (const [north, east] of [
      [0, 0],
      [0, 1],
      [1, 0],
      [1, 1],
    ]) {
      const at = (water.rows[cell] + north) * ground.columns + water.columns[cell] + east;
      const depth = (255 * (level - ground.heights[at])) / DEEPEST;
      values[4 * at + 3] = Math.min(255, Math.max(values[4 * at + 3], depth));
    }
  });
  const texture = new DataTexture(values, ground.columns, ground.rows, RGBAFormat);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
