// A map of level ground with cubes of some kinds on it.

import type { GameMap } from "../src/data/map";

const KINDS = { wall: 3, floor: 4, stair: 5, roof: 6, trunk: 7, crown: 8, rock: 9, furniture: 10, bush: 11 };
// The corners of a cube have the bits (x, y, z); triangles run as in the engine's meshes.
const TRIANGLES = [
  ...[0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1],
  ...[4, 5, 7, 4, 7, 6],
];

// cubes: a kind, the least corner and the side of each.
export function mapOf(cubes: [keyof typeof KINDS, number, number, number, number][]): GameMap {
  const corners = cubes.flatMap(([, x, y, z, side]) =>
    Array.from({ length: 8 }, (_, corner) => [
      x + side * (corner & 1),
      y + side * ((corner >> 1) & 1),
      z + side * (corner >> 2),
    ]).flat(),
  );
  return {
    size: 40,
    ground: {
      rows: 2,
      columns: 2,
      cell: 40,
      corner: [-20, -20],
      heights: new Float32Array(4),
      colors: new Uint8Array(12),
    },
    solids: {
      count: cubes.length,
      kind: Int32Array.from(cubes, ([kind]) => KINDS[kind]),
      topology: new Int32Array(cubes.length),
      first: Int32Array.from([...cubes, null], (_, place) => 8 * place),
      corners: Float32Array.from(corners),
      colors: new Uint8Array(3 * cubes.length),
    },
    topologies: [TRIANGLES],
    kinds: KINDS,
    whole: Promise.resolve(),
  } as unknown as GameMap;
}
