// Houses, trees, rocks and furniture: all solids of a square piece of the map are one geometry.

import { BufferAttribute, BufferGeometry, Group, Mesh, type ShaderMaterial, Sphere, Vector3 } from "three";
import type { GameMap } from "../data/map";
import { endOf, normalOf } from "../view/polyhedra";
import type { Building } from "./building";
import { distantTriangles, floorsAmong, reducedTriangles } from "./reduced";
import type { Caster } from "./shadow";
import { material, type Shared } from "./shared";
import { TEXTURES } from "./textures";

const PIECE = 50; // m along a side of a piece
const SOME_WAY = 2.5; // times as far as there are all triangles, up to where there are some
const FARTHEST = 1e6; // m, in place of no limit
const UPRIGHT = 1e-3; // the rise of a face's normal below which it stands upright

const VERTEX = /* glsl */ `
in vec4 color; // and the kind
in vec2 axis; // along which boards lie: x and z
out vec3 place, ray;
flat out vec3 base;
flat out vec2 along;
flat out int kind;
void main() {
  place = position;
  ray = position - eye;
  base = color.rgb;
  along = normalize(axis);
  kind = int(color.a * 255.0 + 0.5);
  gl_Position = project(position);
}`;
const FRAGMENT = /* glsl */ `
in vec3 place, ray;
flat in vec3 base;
flat in vec2 along;
flat in int kind;
uniform vec3 focus; // m, the followed agent
uniform float reach; // m, from where on plants and rocks have fewer triangles, which lie within what casts their shadows
const float WITHIN = 1.5; // m, at most
${TEXTURES}
// Whether a place hides the followed agent from a camera that is behind a wall.
bool isCut() {
  vec3 way = focus - eye;
  float share = dot(ray, way) / dot(way, way);
  float aside = length(ray - share * way) - 1.1 * share - 0.25;
  float grid = fract(dot(floor(gl_FragCoord.xy), vec2(0.5, 0.25)));
  return share < 1.0 - 0.5 / length(way) && aside < -0.5 * grid * share;
}
void main() {
#ifdef CUT
  if (isCut()) discard;
#endif
  vec3 normal = normalize(cross(dFdx(ray), dFdy(ray)));
  float way = length(ray), facing = dot(normal, ray) / way;
  if (far == 0.0 ? normal.y < 0.0 : facing > 0.0) normal = -normal;
  float footprint = far == 0.0 ? pixel : pixel * way / max(0.2, abs(facing));
  vec3 color = textured(kind, base, normal, place, along, footprint);
  bool isReduced = way > reach && (kind == CROWN || kind == BUSH || kind == ROCK);
  float shine = sunShare(isReduced ? place + WITHIN * sun : place, normal);
  color *= lightOn(normal, shine, skyShare(place, normal));
  shown = vec4(throughAir(color, place), 1.0);
}`;

export interface Solids {
  group: Group;
  // Prepare those that have come since to be made.
  extend(): void;
  casters(): Caster[];
  // Draw pieces within so many m with all their triangles, and those some times as far with fewer.
  see(from: Vector3, reach: number, withRoofs: boolean): void;
  // Leave out what hides a place from the camera; null leaves out nothing.
  cut(focus: Vector3 | null): void;
}

export function createSolids(map: GameMap, shared: Shared, building: Building): Solids {
  const focus = { value: new Vector3() };
  const within = { value: 0 };
  const own = material(shared, VERTEX, FRAGMENT, { uniforms: { reach: within } });
  const open = material(shared, VERTEX, FRAGMENT, {
    uniforms: { focus, reach: within },
    defines: { CUT: 1 },
  });
  const pieces: Piece[] = [];
  const group = new Group();
  let known = 0; // solids
  const extend = () => {
    if (known === map.solids.count) return;
    for (const [[column, row], members] of piecesOf(map, known)) {
      const add = () => {
        const piece = createPiece(map, members, own);
        pieces.push(piece);
        group.add(piece.mesh);
        piece.mesh.updateMatrixWorld(true);
      };
      building.add({ x: PIECE * (column + 0.5), z: PIECE * (row + 0.5), weight: 1, make: add });
    }
    known = map.solids.count;
  };
  const see = (from: Vector3, reach: number, withRoofs: boolean) => {
    within.value = Math.min(reach, FARTHEST);
    for (const { mesh, ranges } of pieces) {
      const { center, radius } = mesh.geometry.boundingSphere as Sphere;
      const away = center.distanceTo(from) - radius;
      const range = ranges[away <= reach ? 2 : away <= SOME_WAY * reach ? 1 : 0];
      mesh.geometry.setDrawRange(range.start, withRoofs ? range.all : range.withoutRoofs);
    }
  };
  const cut = (place: Vector3 | null) => {
    if (place) focus.value.copy(place);
    for (const { mesh } of pieces) mesh.material = place ? open : own;
  };
  const casters = () =>
    pieces.map(({ mesh, ranges, isRoofed }) => {
      const { start, all } = ranges[2];
      return { mesh, start, count: all, isRoof: isRoofed };
    });
  return { group, extend, casters, see, cut };
}

// The column and the row of each piece and the numbers of the solids in it, from one solid on.
function piecesOf({ solids }: GameMap, from: number): Iterable<[[number, number], number[]]> {
  const pieces = new Map<number, [[number, number], number[]]>();
  for (let solid = from; solid < solids.count; solid++) {
    const at = 3 * solids.first[solid];
    const [column, row] = [at, at + 2].map((place) => Math.floor(solids.corners[place] / PIECE));
    const key = column * 4096 + row;
    const piece = pieces.get(key);
    if (piece) piece[1].push(solid);
    else pieces.set(key, [[column, row], [solid]]);
  }
  return pieces.values();
}

interface Range {
  start: number; // in the index
  withoutRoofs: number;
  all: number;
}

interface Piece {
  mesh: Mesh;
  ranges: Range[]; // from afar, from some way off, and from nearby
  isRoofed: boolean; // whether floors or roofs are in it
}

function createPiece(map: GameMap, members: number[], own: ShaderMaterial): Piece {
  const { solids, topologies, kinds } = map;
  const ordered = [
    ...members.filter((solid) => solids.kind[solid] !== kinds.roof),
    ...members.filter((solid) => solids.kind[solid] === kinds.roof),
  ];
  const { geometry, firsts } = cornersOf(map, ordered);
  const triangles: number[] = [];
  const add = (trianglesOf: (solid: number) => number[]): Range => {
    const start = triangles.length;
    let withoutRoofs = 0;
    ordered.forEach((solid, place) => {
      for (const corner of trianglesOf(solid)) triangles.push(firsts[place] + corner);
      if (solids.kind[solid] !== kinds.roof) withoutRoofs = triangles.length - start;
    });
    return { start, withoutRoofs, all: triangles.length - start };
  };
  const floors = floorsAmong(map, members);
  const ranges = [
    add((solid) => distantTriangles(map, solid, floors)),
    add((solid) => reducedTriangles(map, solid)),
    add((solid) => topologies[solids.topology[solid]]),
  ];
  geometry.setIndex(new BufferAttribute(new Uint32Array(triangles), 1));
  const isRoofed = members.some((solid) => [kinds.floor, kinds.roof].includes(solids.kind[solid]));
  return { mesh: new Mesh(geometry, own), ranges, isRoofed };
}

// The corners of solids one after the other, and where those of each begin.
function cornersOf(map: GameMap, members: number[]): { geometry: BufferGeometry; firsts: number[] } {
  const { solids } = map;
  const count = members.reduce((sum, solid) => sum + endOf(solids, solid) / 3 - solids.first[solid], 0);
  const places = new Float32Array(3 * count);
  const paints = new Uint8Array(4 * count);
  const axes = new Int16Array(2 * count);
  const firsts: number[] = [];
  let at = 0;
  for (const solid of members) {
    firsts.push(at);
    const own = solids.corners.subarray(3 * solids.first[solid], endOf(solids, solid));
    places.set(own, 3 * at);
    const [east, north] = axisOf(map, solid);
    for (const last = at + own.length / 3; at < last; at++) {
      paints.set(solids.colors.subarray(3 * solid, 3 * solid + 3), 4 * at);
      paints[4 * at + 3] = solids.kind[solid];
      axes[2 * at] = Math.round(32767 * east);
      axes[2 * at + 1] = Math.round(32767 * north);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.setAttribute("color", new BufferAttribute(paints, 4, true));
  geometry.setAttribute("axis", new BufferAttribute(axes, 2, true));
  geometry.boundingSphere = sphereAround(places);
  return { geometry, firsts };
}

// The level part of the normal of a solid's first upright face; east without one.
function axisOf(map: GameMap, solid: number): [number, number] {
  const { corners, first, topology } = map.solids;
  const triangles = map.topologies[topology[solid]];
  const corner = (at: number) => 3 * (first[solid] + triangles[at]);
  for (let at = 0; at < triangles.length; at += 3) {
    const [x, y, z] = normalOf(corners, corner(at), corner(at + 1), corner(at + 2));
    if (Math.abs(y) < UPRIGHT) return [x, z];
  }
  return [1, 0];
}

function sphereAround(places: Float32Array): Sphere {
  const low = new Vector3(Infinity, Infinity, Infinity);
  const high = new Vector3(-Infinity, -Infinity, -Infinity);
  const each = new Vector3();
  for (let at = 0; at < places.length; at += 3) {
    each.fromArray(places, at);
    low.min(each);
    high.max(each);
  }
  return new Sphere(low.clone().add(high).multiplyScalar(0.5), low.distanceTo(high) / 2);
}
