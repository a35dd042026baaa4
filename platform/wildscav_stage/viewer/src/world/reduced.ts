// Fewer triangles for a solid that is far away, of the same corners.

import type { GameMap } from "../data/map";

const BOX = 12; // triangles that a solid has at most to be drawn as it is
const DOWN = 0.9; // cosine between straight down and the normal of a face that nobody sees from afar
// The corners of an octahedron: two along each axis, numbered -x, +x, -y, +y, -z, +z.
const OCTAHEDRON = [
  [1, 3, 5],
  [5, 3, 0],
  [0, 3, 4],
  [4, 3, 1],
  [1, 5, 2],
  [5, 0, 2],
  [0, 4, 2],
  [4, 1, 2],
];

// The triangles of a solid from afar, as numbers of its corners. Furniture is not seen from there.
export function reducedTriangles(map: GameMap, solid: number): number[] {
  const { solids, topologies, kinds } = map;
  const kind = solids.kind[solid];
  const all = topologies[solids.topology[solid]];
  if (kind === kinds.furniture) return [];
  if (kind === kinds.crown || kind === kinds.bush || kind === kinds.rock) return octahedron(map, solid, all);
  if (all.length > 3 * BOX) return all;
  const first = solids.first[solid];
  const kept: number[] = [];
  for (let at = 0; at < all.length; at += 3) {
    const [a, b, c] = [all[at], all[at + 1], all[at + 2]];
    if (upward(solids.corners, first + a, first + b, first + c) > -DOWN) kept.push(a, b, c);
  }
  return kept;
}

// The triangles between the corners that are outermost along each axis.
function octahedron({ solids }: GameMap, solid: number, all: number[]): number[] {
  const first = solids.first[solid];
  const count = 1 + Math.max(...all);
  const outermost = [0, 0, 0, 0, 0, 0];
  for (let corner = 1; corner < count; corner++) {
    for (let axis = 0; axis < 3; axis++) {
      const at = (which: number) => solids.corners[3 * (first + which) + axis];
      if (at(corner) < at(outermost[2 * axis])) outermost[2 * axis] = corner;
      if (at(corner) > at(outermost[2 * axis + 1])) outermost[2 * axis + 1] = corner;
    }
  }
  return OCTAHEDRON.flatMap((triangle) => {
    const corners = triangle.map((place) => outermost[place]);
    return new Set(corners).size === 3 ? corners : [];
  });
}

// The upward part of the unit normal of a triangle.
function upward(corners: Float32Array, a: number, b: number, c: number): number {
  const side = (from: number, to: number, axis: number) => corners[3 * to + axis] - corners[3 * from + axis];
  const x = side(a, b, 1) * side(a, c, 2) - side(a, b, 2) * side(a, c, 1);
  const y = side(a, b, 2) * side(a, c, 0) - side(a, b, 0) * side(a, c, 2);
  const z = side(a, b, 0) * side(a, c, 1) - side(a, b, 1) * side(a, c, 0);
  return y / (Math.hypot(x, y, z) || 1);
}
