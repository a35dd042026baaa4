// Fewer triangles for solids that are far away, of the same corners.

import type { GameMap } from "../data/map";
import { endOf, normalOf, planesOf } from "../view/polyhedra";

const BOX = 36; // corners of the triangles of a box
const OUTSIDE = 0.35; // m from a wall, where one is in the house or out of it
const LEAST = 0.35; // m, the least side of a face of a wall that is seen from afar
// An octahedron's triangles, between corners that are outermost along an axis: -x, +x, -y, +y, -z, +z. The
// upper half comes first.
const OCTAHEDRON = [1, 3, 5, 5, 3, 0, 0, 3, 4, 4, 3, 1, 1, 5, 2, 5, 0, 2, 0, 4, 2, 4, 1, 2];
const HALF = 12;

// The triangles of a solid from some way off: plants and rocks are octahedra, and furniture is not seen.
export function reducedTriangles(map: GameMap, solid: number): number[] {
  const { solids, topologies, kinds } = map;
  const kind = solids.kind[solid];
  if (kind === kinds.furniture) return [];
  if (kind === kinds.crown || kind === kinds.bush || kind === kinds.rock)
    return octahedron(map, solid, false);
  return topologies[solids.topology[solid]];
}

// The triangles from afar, which show the outside of houses alone. floors: the planes of those nearby.
export function distantTriangles(map: GameMap, solid: number, floors: Float32Array[]): number[] {
  const { solids, kinds } = map;
  const kind = solids.kind[solid];
  if (kind === kinds.furniture || kind === kinds.stair || kind === kinds.floor) return [];
  if (kind === kinds.wall) return outerFaces(map, solid, floors);
  if (kind === kinds.roof) return facesAbove(map, solid);
  return octahedron(map, solid, kind === kinds.bush || kind === kinds.rock);
}

// The planes of the upright faces of floors, which say whether a place is in a house.
export function floorsAmong(map: GameMap, members: number[]): Float32Array[] {
  return members
    .filter((solid) => map.solids.kind[solid] === map.kinds.floor)
    .map((solid) => planesOf(map, solid));
}

function octahedron({ solids }: GameMap, solid: number, isHalf: boolean): number[] {
  const { corners } = solids;
  const first = 3 * solids.first[solid];
  const outermost = [first, first, first, first, first, first];
  for (let corner = first, end = endOf(solids, solid); corner < end; corner += 3) {
    for (let axis = 0; axis < 3; axis++) {
      if (corners[corner + axis] < corners[outermost[2 * axis] + axis]) outermost[2 * axis] = corner;
      if (corners[corner + axis] > corners[outermost[2 * axis + 1] + axis]) outermost[2 * axis + 1] = corner;
    }
  }
  const kept: number[] = [];
  for (let at = 0; at < (isHalf ? HALF : OCTAHEDRON.length); at += 3) {
    const [a, b, c] = [0, 1, 2].map((place) => (outermost[OCTAHEDRON[at + place]] - first) / 3);
    if (a !== b && b !== c && c !== a) kept.push(a, b, c);
  }
  return kept;
}

// The faces of a wall that look out of its house, without its ends.
function outerFaces(map: GameMap, solid: number, floors: Float32Array[]): number[] {
  const { solids, topologies } = map;
  const { corners } = solids;
  const first = 3 * solids.first[solid];
  const triangles = topologies[solids.topology[solid]];
  if (triangles.length > BOX) return triangles;
  const kept: number[] = [];
  for (let at = 0; at < triangles.length; at += 3) {
    const a = first + 3 * triangles[at];
    const b = first + 3 * triangles[at + 1];
    const c = first + 3 * triangles[at + 2];
    if (isNarrow(corners, a, b, c)) continue;
    const normal = normalOf(corners, a, b, c);
    if (Math.abs(normal[1]) > 0.5) continue;
    const x = (corners[a] + corners[b] + corners[c]) / 3 + OUTSIDE * normal[0];
    const z = (corners[a + 2] + corners[b + 2] + corners[c + 2]) / 3 + OUTSIDE * normal[2];
    if (!floors.some((floor) => isOver(floor, x, z)))
      kept.push(triangles[at], triangles[at + 1], triangles[at + 2]);
  }
  return kept;
}

// Whether the level extent of a triangle is small.
function isNarrow(corners: Float32Array, a: number, b: number, c: number): boolean {
  return (
    levelSquare(corners, a, b) < LEAST * LEAST &&
    levelSquare(corners, b, c) < LEAST * LEAST &&
    levelSquare(corners, c, a) < LEAST * LEAST
  );
}

function levelSquare(corners: Float32Array, one: number, other: number): number {
  const [x, z] = [corners[one] - corners[other], corners[one + 2] - corners[other + 2]];
  return x * x + z * z;
}

function isOver(planes: Float32Array, x: number, z: number): boolean {
  for (let at = 0; at < planes.length; at += 4) {
    if (Math.abs(planes[at + 1]) > 0.5) continue;
    if (planes[at] * x + planes[at + 2] * z > planes[at + 3]) return false;
  }
  return true;
}

// All but the faces that look downwards.
function facesAbove({ solids, topologies }: GameMap, solid: number): number[] {
  const first = 3 * solids.first[solid];
  const triangles = topologies[solids.topology[solid]];
  const kept: number[] = [];
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b, c] = [triangles[at], triangles[at + 1], triangles[at + 2]];
    if (normalOf(solids.corners, first + 3 * a, first + 3 * b, first + 3 * c)[1] > -0.1) kept.push(a, b, c);
  }
  return kept;
}
