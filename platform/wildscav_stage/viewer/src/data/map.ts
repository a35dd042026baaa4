// The map of a match: its file is described in platform/wildscav_stage/scene/map_file.py. Lengths are metres here,
// in the game's frame: x east, y up, z north. Colours are red, green and blue, 0-255, before light falls on them.

import { PackedFile } from "./arrays";

const MAP_VERSION = 1;
const METRE = 100; // units of the file

export type Color = [number, number, number];
export type Corner = [number, number, number];

export interface Light {
  sun: Corner; // unit vector towards it
  sunlight: Color; // of a surface of colour 1 that faces the sun
  skylight: Color; // the same from straight above; a third of it from below
  zenith: Color;
  horizon: Color;
  below: Color;
  disc: Color;
  cloud: Color;
  water: [number, number, number, number];
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
  count: number;
  kind: Int32Array;
  topology: Int32Array; // see topologies
  first: Int32Array; // the first of its corners
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
}

// Read the unzipped file of a map. It throws an Error whose message a person can read.
export function readMap(content: ArrayBuffer): GameMap {
  const file = new PackedFile(content);
  const header = file.fields as unknown as Header;
  if (header.format !== "wildscav-map" || header.version !== MAP_VERSION) {
    throw new Error(`this page reads maps of version ${MAP_VERSION}, not ${header.format} ${header.version}`);
  }
  const [rows, columns, levels] = file.planes("water") as Int32Array[];
  return {
    size: header.size / METRE,
    ground: readGround(file, header),
    water: { rows, columns, levels: metres(levels) },
    solids: readSolids(file, header.topologies),
    topologies: header.topologies,
    kinds: header.kinds,
    light: header.light,
    body: inMetres(header.parts.body),
    box: inMetres(header.parts.box),
    boxColors: header.box_colors,
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

function readSolids(file: PackedFile, topologies: number[][]): Solids {
  const [kind, topology, ...firsts] = file.planes("solids") as Int32Array[];
  const planes = file.planes("corners");
  const sizes = topologies.map((triangles) => 1 + Math.max(...triangles));
  const first = new Int32Array(kind.length);
  const corners = new Float32Array(3 * planes[0].length);
  let at = 0;
  for (let solid = 0; solid < kind.length; solid++) {
    first[solid] = at;
    for (const end = at + sizes[topology[solid]]; at < end; at++) {
      for (let axis = 0; axis < 3; axis++)
        corners[3 * at + axis] = (planes[axis][at] + firsts[axis][solid]) / METRE;
    }
  }
  return { count: kind.length, kind, topology, first, corners, colors: interleaved(file.planes("colors")) };
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
