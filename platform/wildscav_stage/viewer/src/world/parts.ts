// The geometry of an object that stands at the origin and faces north, made of convex parts.

import { BufferAttribute, DynamicDrawUsage, InstancedBufferAttribute, InstancedBufferGeometry } from "three";
import type { Corner } from "../data/map";

// Four corners of each face of a part, one after the other around it; they have the bits (along, up, across).
const FACES = [
  [0, 1, 5, 4],
  [2, 3, 7, 6],
  [0, 2, 6, 4],
  [1, 3, 7, 5],
  [0, 1, 3, 2],
  [4, 5, 7, 6],
];
const TRIANGLES = [0, 1, 2, 0, 2, 3];

// Positions, normals and the number of the part, without a vertex in two faces.
export function geometryOf(parts: Corner[][]): InstancedBufferGeometry {
  const [places, normals, numbers]: [number[], number[], number[]] = [[], [], []];
  parts.forEach((corners, part) => {
    const middle = [0, 1, 2].map((axis) => corners.reduce((sum, corner) => sum + corner[axis], 0) / 8);
    for (const face of FACES) {
      const { ring, normal } = outward(
        face.map((corner) => corners[corner]),
        middle,
      );
      for (const at of TRIANGLES) {
        places.push(...ring[at]);
        normals.push(...normal);
        numbers.push(part);
      }
    }
  });
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
  geometry.setAttribute("normal", new BufferAttribute(new Float32Array(normals), 3));
  geometry.setAttribute("part", new BufferAttribute(new Float32Array(numbers), 1));
  geometry.instanceCount = 0;
  return geometry;
}

// Numbers that each of so many copies has, to be written before each picture.
export function perCopy(
  geometry: InstancedBufferGeometry,
  name: string,
  size: number,
  count: number,
): InstancedBufferAttribute {
  const values = new InstancedBufferAttribute(new Float32Array(size * Math.max(1, count)), size);
  values.setUsage(DynamicDrawUsage);
  geometry.setAttribute(name, values);
  return values;
}

// A square from -1 to 1, to be copied: the corner of labels, markers and lines.
export function square(): InstancedBufferGeometry {
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute(
    "position",
    new BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), 3),
  );
  geometry.setIndex(TRIANGLES);
  geometry.instanceCount = 0;
  return geometry;
}

function outward(ring: number[][], middle: number[]): { ring: number[][]; normal: number[] } {
  const [a, b, c] = ring;
  const [first, second] = [minus(b, a), minus(c, a)];
  const cross = [
    first[1] * second[2] - first[2] * second[1],
    first[2] * second[0] - first[0] * second[2],
    first[0] * second[1] - first[1] * second[0],
  ];
  const away = minus(a, middle);
  const isInward = cross[0] * away[0] + cross[1] * away[1] + cross[2] * away[2] < 0;
  const length = (isInward ? -1 : 1) * Math.hypot(...cross);
  return { ring: isInward ? [...ring].reverse() : ring, normal: cross.map((part) => part / length) };
}

function minus(first: number[], second: number[]): number[] {
  return first.map((part, axis) => part - second[axis]);
}
