// The name and the health of each agent above its head, of constant size on the screen, and from above a marker
// that shows where it looks.

import { CanvasTexture, DoubleSide, Group, LinearFilter, Mesh } from "three";
import type { Course } from "../data/course";
import { CLOTHES } from "../data/trails";
import type { Moment } from "../view/moment";
import { drawName, LABEL_HEIGHT as HEIGHT, LABEL_WIDTH as WIDTH } from "../view/names";
import { PerSquare, squares } from "./parts";
import { material, type Shared } from "./shared";

const HEAD = 2.15; // m over the soles
// CSS pixels: the height of the bar of health, and half the side of a marker.
const BAR = 7;
const MARKER = 15;
const COLUMNS = 6;
const DENSITY = 2; // pixels of the texture in a CSS pixel, where there is room
const MOST = 4096; // pixels along a side of the texture

const VERTEX = /* glsl */ `
in vec4 head; // m, and its seat
in vec4 state; // width in pixels, health 0-1, opacity, pixels that it is moved up
uniform vec2 cell; // pixels: the size of a label in the texture, and its columns and rows there
uniform vec2 cells;
out vec2 at; // CSS pixels from the upper left corner
out vec2 corner; // of the label in the texture
flat out vec2 size;
flat out vec2 health;
void main() {
  size = vec2(state.x, ${HEIGHT}.0 + ${BAR}.0);
  at = vec2(0.5 + 0.5 * position.x, 0.5 - 0.5 * position.y) * size;
  corner = vec2(mod(head.w, cells.x), floor(head.w / cells.x));
  health = state.yz;
  vec4 middle = project(head.xyz);
  vec2 shift = vec2(position.x * size.x, position.y * size.y + size.y + 2.0 * state.w) * perPixel;
  gl_Position = middle + vec4(shift / viewport * middle.w, 0.0, 0.0);
}`;
const FRAGMENT = /* glsl */ `
in vec2 at, corner;
flat in vec2 size;
flat in vec2 health;
uniform sampler2D names;
uniform vec2 cell, cells;
void main() {
  if (at.y < ${HEIGHT}.0) {
    vec4 own = texture(names, (corner + at / cell) / cells);
    if (own.a < 0.02) discard;
    shown = vec4(own.rgb / own.a, own.a * health.y);
    return;
  }
  if (health.x <= 0.0 || at.y < ${HEIGHT}.0 + 1.0 || at.x < 1.0 || at.x > size.x - 1.0) discard;
  float along = (at.x - 2.0) / (size.x - 4.0);
  vec3 color = health.x > 0.5 ? vec3(0.36, 0.86, 0.35) : health.x > 0.25 ? vec3(0.98, 0.76, 0.2) : vec3(0.97, 0.3, 0.25);
  bool isFull = along >= 0.0 && along < health.x && at.y > ${HEIGHT}.0 + 1.8 && at.y < size.y - 0.8;
  shown = vec4(isFull ? color : vec3(0.05, 0.07, 0.1), isFull ? 1.0 : 0.8 * health.y);
}`;
const MARKER_VERTEX = /* glsl */ `
in vec4 head, state;
in vec4 paint; // colour, and the yaw in radians
out vec2 at;
flat out vec4 color;
void main() {
  vec2 way = vec2(sin(paint.w), cos(paint.w));
  at = position.xy;
  color = vec4(paint.rgb, state.y > 0.0 ? 1.0 : 0.0);
  vec4 middle = project(head.xyz);
  vec2 turned = vec2(position.x * way.y + position.y * way.x, position.y * way.y - position.x * way.x);
  gl_Position = middle + vec4(turned * ${MARKER}.0 * 2.0 * perPixel / viewport * middle.w, 0.0, 0.0);
}`;
const MARKER_FRAGMENT = /* glsl */ `
in vec2 at;
flat in vec4 color;
void main() {
  // How far outside the circle and the tip ahead of it, which it touches.
  float off = length(at), body = off - 0.44;
  float tip = at.y < 0.2 ? 1.0 : (abs(at.x) * 1.3 + at.y - 0.86) * 0.6;
  float outside = min(body, tip);
  if (color.a == 0.0) {
    float cross = min(abs(at.x - at.y), abs(at.x + at.y));
    if (cross > 0.28 || off > 0.6) discard;
    shown = vec4(cross < 0.14 ? color.rgb * 0.7 : vec3(0.05), 0.8);
    return;
  }
  if (outside > 0.12) discard;
  shown = vec4(outside < 0.0 ? color.rgb : vec3(0.04, 0.05, 0.08), 1.0);
}`;

export interface Labels {
  group: Group;
  // hidden: a seat without a label. withMarkers: show where they look, as seen from above.
  show(moment: Moment, hidden: number | null, withMarkers: boolean): void;
  dispose(): void;
}

export function createLabels(course: Course, shared: Shared): Labels {
  const count = course.seats.length;
  const names = namesOf(course);
  const geometry = squares(count);
  const head = new PerSquare(geometry, "head", count);
  const state = new PerSquare(geometry, "state", count);
  const paint = new PerSquare(geometry, "paint", count);
  const over = { transparent: true, depthTest: false, depthWrite: false, side: DoubleSide } as const;
  const labels = new Mesh(
    geometry,
    material(shared, VERTEX, FRAGMENT, {
      ...over,
      uniforms: {
        names: { value: names.texture },
        cell: { value: [WIDTH, HEIGHT] },
        cells: { value: names.cells },
      },
    }),
  );
  const markers = new Mesh(geometry, material(shared, MARKER_VERTEX, MARKER_FRAGMENT, over));
  labels.frustumCulled = markers.frustumCulled = false;
  labels.renderOrder = 9;
  markers.renderOrder = 8;
  const group = new Group();
  group.add(labels, markers);
  const show = ({ states }: Moment, hidden: number | null, withMarkers: boolean) => {
    let copies = 0;
    for (let seat = 0; seat < count; seat++) {
      if (seat === hidden) continue;
      const { x, y, z, yaw, health } = states[seat];
      const share = Math.max(0, health / course.seats[seat].full_health);
      const [red, green, blue] = course.seats[seat].colors[CLOTHES];
      head.set(copies, x, y + (health > 0 ? HEAD : 0.9), z, seat);
      state.set(copies, names.widths[seat], share, share > 0 ? 1 : 0.55, withMarkers ? 11 : 2);
      paint.set(copies, red / 255, green / 255, blue / 255, (yaw * Math.PI) / 180);
      copies++;
    }
    geometry.setDrawRange(0, 6 * copies);
    for (const each of [head, state, paint]) each.send(copies);
    markers.visible = withMarkers;
  };
  return { group, show, dispose: () => names.texture.dispose() };
}

// The names of all seats on one picture, and how wide each is in CSS pixels.
function namesOf(course: Course): { texture: CanvasTexture; widths: number[]; cells: [number, number] } {
  const rows = Math.max(1, Math.ceil(course.seats.length / COLUMNS));
  const density = Math.min(DENSITY, MOST / (rows * HEIGHT));
  const canvas = document.createElement("canvas");
  canvas.width = COLUMNS * WIDTH * density;
  canvas.height = Math.ceil(rows * HEIGHT * density);
  const context = canvas.getContext("2d") as CanvasRenderingContext2D;
  context.scale(density, canvas.height / (rows * HEIGHT));
  const widths = course.seats.map((seat, place) => {
    context.save();
    context.translate((place % COLUMNS) * WIDTH, Math.floor(place / COLUMNS) * HEIGHT);
    const width = drawName(context, seat.name, seat.colors[CLOTHES]);
    context.restore();
    return width;
  });
  const texture = new CanvasTexture(canvas);
  texture.flipY = false;
  texture.premultiplyAlpha = true;
  texture.generateMipmaps = false;
  texture.minFilter = texture.magFilter = LinearFilter;
  return { texture, widths, cells: [COLUMNS, rows] };
}
