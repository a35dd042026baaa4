// The ground of the map, in square pieces of which only those in view are drawn, and the land beyond its edge.

import { BufferAttribute, BufferGeometry, Group, Mesh, type ShaderMaterial, Sphere, Vector3 } from "three";
import type { GameMap, Ground } from "../data/map";
import { normalsOf } from "../view/terrain";
import type { Building } from "./building";
import type { Caster } from "./shadow";
import { material, type Shared } from "./shared";

const PIECE = 32; // cells along a side of a piece
const STEPS = [1, 2, 4]; // cells along a side of a triangle: from nearby, from some way off, and from afar
const SOME_WAY = 2.5; // times as far as there are all triangles, up to where there are some
const SKIRT = 2; // m
const WEIGHT = 0.3; // of pieces among what is to be made: ground is seen from farther than what stands on it
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
const MANY = 100; // corners along a side of the map, beyond which only every so many of its edge are used
const EVERY = 3;
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
  if (coarse > 0.0) bright += coarse * (noise(at / 2.3) - 0.5);
  if (medium > 0.0) bright += medium * (noise(at / 0.45) - 0.5);
#if DETAIL == 2
  float fine = 0.34 * sharpness(0.11, footprint);
  if (fine > 0.0) bright += fine * (noise(at / 0.11) - 0.5);
#endif
  return bright;
}
void main() {
  vec3 normal = normalize(facing), ray = place - eye, color = base;
  float way = length(ray);
  float footprint = far == 0.0 ? 4.0 * pixel : pixel * way / max(0.2, -dot(ray, normal) / way);
  color *= grains(place.xz, footprint);
  color *= isBeyond > 0.0 ? lightOn(normal, 1.0, 1.0) : lightOn(normal, sunShare(place, normal), skyShare(place, normal));
  shown = vec4(throughAir(color, place), 1.0);
}`;

export interface GroundPieces {
  group: Group;
  casters(): Caster[];
  // Draw pieces within so many m with all their triangles, and those some times as far with fewer.
  see(from: Vector3, reach: number): void;
}

export function createGround(map: GameMap, shared: Shared, building: Building): GroundPieces {
  const { ground } = map;
  const group = new Group();
  const normals = normalsOf(ground);
  const own = material(shared, VERTEX, FRAGMENT, { uniforms: { isBeyond: { value: 0 } } });
  const pieces: Piece[] = [];
  const add = (row: number, column: number) => {
    const piece = createPiece(ground, normals, row, column, own);
    pieces.push(piece);
    group.add(piece.mesh);
    piece.mesh.updateMatrixWorld(true);
  };
  for (let row = 0; row < ground.rows - 1; row += PIECE) {
    for (let column = 0; column < ground.columns - 1; column += PIECE) {
      const x = ground.corner[0] + ground.cell * (column + PIECE / 2);
      const z = ground.corner[1] + ground.cell * (row + PIECE / 2);
      building.add({ x, z, weight: WEIGHT, make: () => add(row, column) });
    }
  }
  const beyond = material(shared, VERTEX, FRAGMENT, { uniforms: { isBeyond: { value: 1 } } });
  const apron = new Mesh(landBeyond(map, normals), beyond);
  apron.frustumCulled = false;
  group.add(apron);
  const see = (from: Vector3, reach: number) => {
    for (const { mesh, starts } of pieces) {
      const { center, radius } = mesh.geometry.boundingSphere as Sphere;
      const away = center.distanceTo(from) - radius;
      const level = away <= reach ? 0 : away <= SOME_WAY * reach ? 1 : 2;
      mesh.geometry.setDrawRange(starts[level], starts[level + 1] - starts[level]);
    }
  };
  const casters = () =>
    pieces.map(({ mesh, starts }) => ({ mesh, start: 0, count: starts[1], isRoof: false }));
  return { group, casters, see };
}

interface Piece {
  mesh: Mesh;
  starts: number[]; // of each level in the index, then its end
}

// A piece has its corners row after row, then those along its edge once more, lower: the skirt.
function createPiece(
  ground: Ground,
  normals: Float32Array,
  row: number,
  column: number,
  own: ShaderMaterial,
): Piece {
  const rows = Math.min(PIECE, ground.rows - 1 - row) + 1;
  const columns = Math.min(PIECE, ground.columns - 1 - column) + 1;
  const edge = edgeOf({ rows, columns });
  const corners = [...Array(rows * columns).keys(), ...edge];
  const places = new Float32Array(3 * corners.length);
  const facing = new Int16Array(4 * corners.length);
  const paints = new Uint8Array(4 * corners.length);
  let [low, high] = [Infinity, -Infinity];
  corners.forEach((corner, at) => {
    const [r, c] = [row + Math.floor(corner / columns), column + (corner % columns)];
    const from = r * ground.columns + c;
    const height = ground.heights[from];
    [low, high] = [Math.min(low, height), Math.max(high, height)];
    places[3 * at] = ground.corner[0] + ground.cell * c;
    places[3 * at + 1] = at < rows * columns ? height : height - SKIRT;
    places[3 * at + 2] = ground.corner[1] + ground.cell * r;
    for (let part = 0; part < 3; part++) {
      facing[4 * at + part] = 32767 * normals[3 * from + part];
      paints[4 * at + part] = ground.colors[3 * from + part];
    }
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.setAttribute("normal", new BufferAttribute(facing, 4, true));
  geometry.setAttribute("color", new BufferAttribute(paints, 4, true));
  const triangles: number[] = [];
  const starts = STEPS.map((step) => {
    const start = triangles.length;
    addTriangles(triangles, rows, columns, step);
    addSkirt(triangles, edge, rows, columns, step);
    return start;
  });
  geometry.setIndex(triangles);
  const middle = 3 * (Math.floor(rows / 2) * columns + Math.floor(columns / 2));
  const across = (ground.cell * Math.hypot(rows + 1, columns + 1)) / 2;
  geometry.boundingSphere = new Sphere(
    new Vector3(places[middle], (low + high) / 2, places[middle + 2]),
    Math.hypot(across, (high - low) / 2 + SKIRT),
  );
  return { mesh: new Mesh(geometry, own), starts: [...starts, triangles.length] };
}

// The triangles between every so many corners.
function addTriangles(triangles: number[], rows: number, columns: number, step: number): void {
  for (let row = 0; row < rows - 1; row += step) {
    const north = Math.min(rows - 1, row + step);
    for (let column = 0; column < columns - 1; column += step) {
      const east = Math.min(columns - 1, column + step);
      const [southWest, southEast] = [row * columns + column, row * columns + east];
      const [northWest, northEast] = [north * columns + column, north * columns + east];
      triangles.push(southWest, northEast, southEast, southWest, northWest, northEast);
    }
  }
}

// What hides the gaps towards pieces with more or fewer triangles.
function addSkirt(triangles: number[], edge: number[], rows: number, columns: number, step: number): void {
  const isKept = (corner: number) => {
    const [row, column] = [Math.floor(corner / columns), corner % columns];
    const isAt = (place: number, last: number) => place % step === 0 || place === last;
    return isAt(row, rows - 1) && isAt(column, columns - 1);
  };
  const kept = edge.flatMap((corner, place) => (isKept(corner) ? [place] : []));
  kept.forEach((place, at) => {
    const next = kept[(at + 1) % kept.length];
    const [a, b] = [edge[place], edge[next]];
    const [under, nextUnder] = [rows * columns + place, rows * columns + next];
    triangles.push(a, b, nextUnder, a, nextUnder, under);
  });
}

// Land that goes on from the edge of the map, ever flatter and paler, until the haze hides it.
function landBeyond(map: GameMap, normals: Float32Array): BufferGeometry {
  const { ground, water } = map;
  const every = ground.columns > MANY ? EVERY : 1;
  const edge = edgeOf(ground).filter((at) => {
    const [row, column] = [Math.floor(at / ground.columns), at % ground.columns];
    const isAt = (place: number, last: number) => place % every === 0 || place === last;
    return isAt(row, ground.rows - 1) && isAt(column, ground.columns - 1);
  });
  const wet = new Map<number, number>();
  for (let cell = 0; cell < water.levels.length; cell++)
    wet.set(water.rows[cell] * ground.columns + water.columns[cell], water.levels[cell]);
  const level = edge.reduce((sum, at) => sum + ground.heights[at], 0) / edge.length;
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
function edgeOf({ rows, columns }: { rows: number; columns: number }): number[] {
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
