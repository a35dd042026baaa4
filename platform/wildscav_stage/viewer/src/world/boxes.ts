// The boxes of supplies that lie on the map, and a spark over each that is seen from afar.

import { DoubleSide, Group, Mesh, Vector3 } from "three";
import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import { METRE } from "../data/trails";
import { geometryOf, PerSquare, perCopy, squares } from "./parts";
import { material, type Shared } from "./shared";

const VERTEX = /* glsl */ `
in float part;
in vec4 stand; // where it stands, and whether an agent that died has left it
uniform vec3 colors[3];
out vec3 place, facing, base;
void main() {
  place = stand.xyz + position;
  facing = normal;
  base = colors[int(part)];
  if (stand.w > 0.5) base = mix(base, base.bgr, 0.75);
  gl_Position = project(place);
}`;
const FRAGMENT = /* glsl */ `
in vec3 place, facing, base;
void main() { shown = objectAt(place, facing, base, 0.75); }`;
const SPARK_VERTEX = /* glsl */ `
in vec4 stand;
uniform float size; // pixels
out vec2 corner;
out vec3 color;
void main() {
  corner = position.xy;
  color = stand.w > 0.5 ? vec3(1.0, 0.78, 0.35) : vec3(0.42, 0.86, 1.0);
  vec4 middle = project(stand.xyz + vec3(0.0, 0.95, 0.0));
  float away = far == 0.0 ? 1.0 : smoothstep(18.0, 40.0, middle.w) * (1.0 - smoothstep(0.6 * far, 0.9 * far, middle.w));
  gl_Position = middle + vec4(position.xy * size * away / viewport * 2.0 * middle.w, 0.0, 0.0);
}`;
const SPARK_FRAGMENT = /* glsl */ `
in vec2 corner;
in vec3 color;
void main() {
  float off = abs(corner.x) + abs(corner.y);
  if (off > 1.0) discard;
  shown = vec4(off > 0.62 ? vec3(0.06, 0.13, 0.2) : color, 0.92);
}`;

export interface Boxes {
  group: Group;
  // reach: m from a place, up to which they are shown as crates. sparkSize: pixels; 0 = none.
  show(frame: number, from: Vector3, reach: number, sparkSize: number): void;
}

export function createBoxes(map: GameMap, course: Course, shared: Shared): Boxes {
  const colors = map.boxColors.map((color) => new Vector3(...color).divideScalar(255));
  const sparkSize = { value: 0 };
  const group = new Group();
  let crates = geometryOf(map.box);
  let sparks = squares(0);
  const meshes = [
    new Mesh(crates, material(shared, VERTEX, FRAGMENT, { uniforms: { colors: { value: colors } } })),
    new Mesh(
      sparks,
      material(shared, SPARK_VERTEX, SPARK_FRAGMENT, {
        transparent: true,
        depthWrite: false,
        side: DoubleSide,
        uniforms: { size: sparkSize },
      }),
    ),
  ];
  meshes[1].renderOrder = 3;
  for (const mesh of meshes) mesh.frustumCulled = false;
  group.add(...meshes);
  let stand = new PerSquare(sparks, "stand", 0);
  let near = perCopy(crates, "stand", 4, 0);
  // A match that is being played gets more boxes.
  const makeRoom = (count: number) => {
    if (stand.count >= count) return;
    for (const mesh of meshes) mesh.geometry.dispose();
    [crates, sparks] = [geometryOf(map.box), squares(2 * count)];
    [meshes[0].geometry, meshes[1].geometry] = [crates, sparks];
    stand = new PerSquare(sparks, "stand", 2 * count);
    near = perCopy(crates, "stand", 4, 2 * count);
  };
  const show = (frame: number, from: Vector3, reach: number, size: number) => {
    const { boxes } = course.trails;
    makeRoom(boxes.length);
    let [count, crateCount] = [0, 0];
    for (const { x, z, height, dropped, appears, taken } of boxes) {
      if (appears > frame || (taken !== null && taken <= frame)) continue;
      const [east, up, north] = [x / METRE, height / METRE, z / METRE];
      stand.set(count++, east, up, north, dropped ? 1 : 0);
      const isNear = (east - from.x) ** 2 + (up - from.y) ** 2 + (north - from.z) ** 2 < reach * reach;
      if (isNear) near.setXYZW(crateCount++, east, up, north, dropped ? 1 : 0);
    }
    sparks.setDrawRange(0, 6 * count);
    crates.instanceCount = crateCount;
    stand.send(count);
    near.needsUpdate = true;
    sparkSize.value = size;
    meshes[1].visible = size > 0;
  };
  return { group, show };
}
