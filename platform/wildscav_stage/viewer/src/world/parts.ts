// The geometry of an object that stands at the origin and faces north, made of convex parts.

import {
  BufferAttribute,
  BufferGeometry,
  DynamicDrawUsage,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
} from "three";
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
const SQUARE = [-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0];

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

// So many squares from -1 to 1, for labels, markers and lines; of these as many are drawn as setDrawRange says.
// They are no copies of one, since software takes long for each copy.
export function squares(count: number): BufferGeometry {
  const geometry = new BufferGeometry();
  const corners = new Float32Array(SQUARE.length * Math.max(1, count));
  const triangles = new Uint32Array(TRIANGLES.length * Math.max(1, count));
  for (let at = 0; at < corners.length; at++) corners[at] = SQUARE[at % SQUARE.length];
  for (let at = 0; at < triangles.length; at++)
    triangles[at] = 4 * Math.floor(at / TRIANGLES.length) + TRIANGLES[at % TRIANGLES.length];
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.setDrawRange(0, 0);
  return geometry;
}

// The side of an upright cylinder of radius 1, with rings of corners at some heights.
export function cylinder(sides: number, heights: number[]): BufferGeometry {
  const places: number[] = [];
  const triangles: number[] = [];
  for (let side = 0; side <= sides; side++) {
    const angle = (2 * Math.PI * side) / sides;
    for (const height of heights) places.push(Math.sin(angle), height, Math.cos(angle));
  }
  for (let side = 0; side < sides; side++) {
    for (let level = 0; level < heights.length - 1; level++) {
      const at = heights.length * side + level;
      const next = at + heights.length;
      triangles.push(at, at + 1, next, at + 1, next + 1, next);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(places), 3));
  geometry.setIndex(triangles);
  return geometry;
}

// Four numbers of each square, to be written before each picture.
export class PerSquare {
  private readonly values: BufferAttribute;

  constructor(
    geometry: BufferGeometry,
    name: string,
    readonly count: number,
  ) {
    this.values = new BufferAttribute(new Float32Array(16 * Math.max(1, count)), 4);
    this.values.setUsage(DynamicDrawUsage);
    geometry.setAttribute(name, this.values);
  }

  set(at: number, x: number, y: number, z: number, w: number): void {
    for (let corner = 4 * at; corner < 4 * at + 4; corner++) this.values.setXYZW(corner, x, y, z, w);
  }

  // Hand the numbers of the first squares to the graphics processor.
  send(squares: number): void {
    this.values.clearUpdateRanges();
    this.values.addUpdateRange(0, 16 * squares);
    this.values.needsUpdate = true;
  }
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
