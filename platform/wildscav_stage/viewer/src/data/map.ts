// The map of a match: its file is described in platform/wildscav_stage/scene/map_file.py. Lengths are metres here,
// in the game's frame: x east, y up, z north. Colours are red, green and blue, 0-255, before light falls on them.

import { openPacked, type PackedFile } from "./arrays";

const MAP_VERSION = 2;
const METRE = 100; // units of the file

export type Color = [number, number, number];
export type Corner = [number, number, number];

export interface Light {
  sun: Corner; // unit vector towards it
  sunlight: Color; // of a surface of colour 1 that faces the sun
  skylight: Color; // the same of the sky
  direct: number; // share of the sun's that is used
  // Ambient light in the open and under roofs: its level, and how it grows with the upward part of a normal; and how it
  // grows with the eastern and the northern part.
  open: [number, number];
  roofed: [number, number];
  side: [number, number];
  zenith: Color;
  horizon: Color;
  below: Color;
  disc: Color;
  cloud: Color;
  ceiling: Color;
  deep: Color; // water
}

// The ground: heights and colours of the corners of its cells, row after row northwards.
export interface Ground {
  rows: number; // of corners
  columns: number;
  cell: number; // m
  corner: [number, number]; // x and z of the south-western corner, m
  heights: Float32Array; // m
  colors: Uint8Array; // three for each corner
}

export interface Solids {
  count: number; // of those that are there; others may be yet to come
  kind: Int32Array;
  topology: Int32Array; // see topologies
  first: Int32Array; // the first of its corners, and the end of the last one's
  corners: Float32Array; // x, y, z in m of all corners of all solids, one solid after the other
  colors: Uint8Array; // three for each solid
}

export interface GameMap {
  size: number; // m
  ground: Ground;
  water: { rows: Int32Array; columns: Int32Array; levels: Float32Array };
  solids: Solids;
  topologies: number[][]; // the triangles of a solid's surface, as its corners, three by three
  kinds: Record<string, number>;
  light: Light;
  body: Corner[][]; // the parts of a body: eight corners each, numbered by the bits (along, up, across), m
  box: Corner[][];
  boxColors: Color[];
  whole: Promise<void>; // settles when all solids are there, or cannot be had
}

interface Header {
  format: string;
  version: number;
  size: number;
  cell: number;
  corner: [number, number];
  kinds: Record<string, number>;
  topologies: number[][];
  light: Light;
  parts: { body: Corner[][]; box: Corner[][] };
  box_colors: Color[];
  chunks: number;
}

// Read the file of a map, which may be arriving: its solids come later, one part after the other. It throws an Error
// whose message a person can read.
export async function readMap(stream: ReadableStream<Uint8Array>): Promise<GameMap> {
  const file = await openPacked(stream);
  const header = file.fields as unknown as Header;
  if (header.format !== "wildscav-map" || header.version !== MAP_VERSION) {
    throw new Error(`this page reads maps of version ${MAP_VERSION}, not ${header.format} ${header.version}`);
  }
  await file.has("water");
  const [rows, columns, levels] = file.planes("water") as Int32Array[];
  const solids = roomForSolids(file, header);
  const whole = readSolids(file, header, solids);
  whole.catch(() => {}); // is handled by whoever waits for it
  return {
    size: header.size / METRE,
    ground: readGround(file, header),
    water: { rows, columns, levels: metres(levels) },
    solids,
    topologies: header.topologies,
    kinds: header.kinds,
    light: header.light,
    body: inMetres(header.parts.body),
    box: inMetres(header.parts.box),
    boxColors: header.box_colors,
    whole,
  };
}

function readGround(file: PackedFile, header: Header): Ground {
  const [rows, columns] = file.shape("heights");
  return {
    rows,
    columns,
    cell: header.cell / METRE,
    corner: [header.corner[0] / METRE, header.corner[1] / METRE],
    heights: metres(file.planes("heights")[0]),
    colors: interleaved(file.planes("ground")),
  };
}

function roomForSolids(file: PackedFile, { chunks }: Header): Solids {
  const total = (name: string) => {
    let sum = 0;
    for (let chunk = 0; chunk < chunks; chunk++) sum += file.shape(`${name} ${chunk}`)[0];
    return sum;
  };
  const solids = total("solids");
  return {
    count: 0,
    kind: new Int32Array(solids),
    topology: new Int32Array(solids),
    first: new Int32Array(solids + 1),
    corners: new Float32Array(3 * total("corners")),
    colors: new Uint8Array(3 * solids),
  };
}

async function readSolids(file: PackedFile, { chunks, topologies }: Header, solids: Solids): Promise<void> {
  const sizes = topologies.map((triangles) => 1 + Math.max(...triangles));
  for (let chunk = 0; chunk < chunks; chunk++) {
    await file.has(`corners ${chunk}`);
    addSolids(file, chunk, sizes, solids);
  }
  await file.end();
}

function addSolids(file: PackedFile, chunk: number, sizes: number[], solids: Solids): void {
  const [kind, topology, ...firsts] = file.planes(`solids ${chunk}`) as Int32Array[];
  const planes = file.planes(`corners ${chunk}`);
  solids.kind.set(kind, solids.count);
  solids.topology.set(topology, solids.count);
  solids.colors.set(interleaved(file.planes(`colors ${chunk}`)), 3 * solids.count);
  const start = solids.first[solids.count];
  let at = 0;
  for (let solid = 0; solid < kind.length; solid++) {
    for (const end = at + sizes[topology[solid]]; at < end; at++) {
      for (let axis = 0; axis < 3; axis++)
        solids.corners[3 * (start + at) + axis] = (planes[axis][at] + firsts[axis][solid]) / METRE;
    }
    solids.first[solids.count + solid + 1] = start + at;
  }
  solids.count += kind.length;
}

function metres(values: ArrayLike<number>): Float32Array {
  return Float32Array.from(values, (value) => value / METRE);
}

function interleaved(planes: ArrayLike<number>[]): Uint8Array {
  const values = new Uint8Array(planes.length * planes[0].length);
  planes.forEach((plane, channel) => {
    for (let place = 0; place < plane.length; place++) values[planes.length * place + channel] = plane[place];
  });
  return values;
}

function inMetres(parts: Corner[][]): Corner[][] {
  return parts.map((corners) => corners.map((corner) => corner.map((value) => value / METRE) as Corner));
}
