// The faces of solids, from the corners of their triangles.

import type { Corner, GameMap, Solids } from "../data/map";

// The outward unit normal of a triangle, given where its corners' coordinates begin.
export function normalOf(corners: Float32Array, a: number, b: number, c: number): Corner {
  // Written out, since it is asked for hundreds of thousands of triangles.
  const x1 = corners[b] - corners[a];
  const y1 = corners[b + 1] - corners[a + 1];
  const z1 = corners[b + 2] - corners[a + 2];
  const x2 = corners[c] - corners[a];
  const y2 = corners[c + 1] - corners[a + 1];
  const z2 = corners[c + 2] - corners[a + 2];
  const x = y1 * z2 - z1 * y2;
  const y = z1 * x2 - x1 * z2;
  const z = x1 * y2 - y1 * x2;
  const length = Math.sqrt(x * x + y * y + z * z) || 1;
  return [x / length, y / length, z / length];
}

// Where the coordinates of the corners of a solid's triangles begin, three by three.
export function trianglesOf({ solids, topologies }: GameMap, solid: number): number[] {
  const first = 3 * solids.first[solid];
  return topologies[solids.topology[solid]].map((corner) => first + 3 * corner);
}

// Where the coordinates of the corner after a solid's last begin.
export function endOf(solids: Solids, solid: number): number {
  return 3 * solids.first[solid + 1];
}

// The planes of a solid's triangles: outward unit normals and their offsets.
export function planesOf(map: GameMap, solid: number): Float32Array {
  const { corners } = map.solids;
  const triangles = trianglesOf(map, solid);
  const planes = new Float32Array((4 * triangles.length) / 3);
  for (let place = 0; place < triangles.length; place += 3) {
    const [a, b, c] = [triangles[place], triangles[place + 1], triangles[place + 2]];
    const normal = normalOf(corners, a, b, c);
    planes.set(normal, (4 * place) / 3);
    planes[(4 * place) / 3 + 3] =
      normal[0] * corners[a] + normal[1] * corners[a + 1] + normal[2] * corners[a + 2];
  }
  return planes;
}
