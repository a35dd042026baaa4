// The map as a picture from above, north up: ground with the sun on it, water, shadows, and what stands there.

import type { Corner, GameMap } from "../data/map";
import { lit } from "../view/light";
import { endOf, normalOf, trianglesOf } from "../view/polyhedra";
import { heightAt, normalsOf } from "../view/terrain";

const LARGEST = 2048; // pixels along a side
const FINEST = 10; // pixels in a metre
const PER_CELL = 4; // pixels of the ground along a side of a cell
const CLEAR = 0.9; // m of depth at which a quarter of the bed's colour is still seen
const SHADE = 0.36; // opacity of shadows
const UP: Corner = [0, 1, 0];

type Context = CanvasRenderingContext2D;

export function drawMap(map: GameMap): HTMLCanvasElement {
  const scale = Math.min(FINEST, LARGEST / map.size);
  const side = Math.round(scale * map.size);
  const canvas = canvasOf(side, side);
  const context = contextOf(canvas);
  context.imageSmoothingQuality = "high";
  context.drawImage(drawGround(map), 0, 0, side, side);
  const place = (context: Context) =>
    context.setTransform(
      scale,
      0,
      0,
      -scale,
      -scale * map.ground.corner[0],
      side + scale * map.ground.corner[1],
    );
  const shadows = canvasOf(side, side);
  place(contextOf(shadows));
  drawShadows(map, contextOf(shadows));
  context.globalAlpha = SHADE;
  context.drawImage(shadows, 0, 0);
  context.globalAlpha = 1;
  place(context);
  drawSolids(map, context, 0.7 / scale);
  return canvas;
}

function canvasOf(width: number, height: number): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  return canvas;
}

function contextOf(canvas: HTMLCanvasElement): Context {
  // Drawn by the processor, which is quick at many small shapes.
  return canvas.getContext("2d", { willReadFrequently: true }) as Context;
}

// The ground and the water on it, some pixels for each cell.
function drawGround(map: GameMap): HTMLCanvasElement {
  const { ground, light } = map;
  const [width, height] = [PER_CELL * (ground.columns - 1), PER_CELL * (ground.rows - 1)];
  const canvas = canvasOf(width, height);
  const image = new ImageData(width, height);
  const shaded = shadedCorners(map);
  const levels = new Float32Array(ground.rows * ground.columns).fill(-Infinity);
  map.water.levels.forEach((level, at) => {
    levels[map.water.rows[at] * ground.columns + map.water.columns[at]] = level;
  });
  const deep = lit(light.deep, UP, light);
  for (let y = 0; y < height; y++) {
    const north = (height - 0.5 - y) / PER_CELL;
    for (let x = 0; x < width; x++) {
      const east = (x + 0.5) / PER_CELL;
      const corner = Math.floor(north) * ground.columns + Math.floor(east);
      const at = 4 * (y * width + x);
      blend(shaded, corner, ground.columns, east % 1, north % 1, image.data, at);
      image.data[at + 3] = 255;
      if (levels[corner] === -Infinity) continue;
      const own = heightAt(
        ground,
        ground.corner[0] + ground.cell * east,
        ground.corner[1] + ground.cell * north,
      );
      if (own >= levels[corner]) continue;
      const clear = (CLEAR / (CLEAR + levels[corner] - own)) ** 2;
      for (let channel = 0; channel < 3; channel++)
        image.data[at + channel] = deep[channel] + (image.data[at + channel] - deep[channel]) * clear;
    }
  }
  contextOf(canvas).putImageData(image, 0, 0);
  return canvas;
}

// The colours of all corners with light on them.
function shadedCorners({ ground, light }: GameMap): Uint8Array {
  const normals = normalsOf(ground);
  const shaded = new Uint8Array(ground.colors.length);
  for (let at = 0; at < shaded.length; at += 3) {
    const normal: Corner = [normals[at], normals[at + 1], normals[at + 2]];
    shaded.set(lit(ground.colors.subarray(at, at + 3), normal, light), at);
  }
  return shaded;
}

// Write what is between the colours of the four corners of a cell.
function blend(
  colors: Uint8Array,
  corner: number,
  columns: number,
  east: number,
  north: number,
  written: Uint8ClampedArray,
  at: number,
): void {
  const [southWest, northWest] = [3 * corner, 3 * (corner + columns)];
  for (let channel = 0; channel < 3; channel++) {
    const [sw, se] = [colors[southWest + channel], colors[southWest + 3 + channel]];
    const [nw, ne] = [colors[northWest + channel], colors[northWest + 3 + channel]];
    const south = sw + (se - sw) * east;
    written[at + channel] = south + (nw + (ne - nw) * east - south) * north;
  }
}

function drawShadows(map: GameMap, context: Context): void {
  const { solids, light, ground } = map;
  const { corners } = solids;
  const [east, north] = [light.sun[0] / light.sun[1], light.sun[2] / light.sun[1]];
  for (let solid = 0; solid < solids.count; solid++) {
    if (isInside(map, solids.kind[solid])) continue;
    const first = 3 * solids.first[solid];
    const level = heightAt(ground, corners[first], corners[first + 2]);
    context.beginPath();
    const triangles = trianglesOf(map, solid);
    for (let place = 0; place < triangles.length; place += 3) {
      const [a, b, c] = [triangles[place], triangles[place + 1], triangles[place + 2]];
      const normal = normalOf(corners, a, b, c);
      // Those that face the sun cover the whole shadow once.
      if (normal[0] * light.sun[0] + normal[1] * light.sun[1] + normal[2] * light.sun[2] <= 0) continue;
      for (const at of [a, b, c]) {
        const above = Math.max(0, corners[at + 1] - level);
        const [x, z] = [corners[at] - east * above, corners[at + 2] - north * above];
        if (at === a) context.moveTo(x, z);
        else context.lineTo(x, z);
      }
    }
    context.fill();
  }
}

function drawSolids(map: GameMap, context: Context, line: number): void {
  const { solids } = map;
  const drawn = Array.from({ length: solids.count }, (_, solid) => solid).filter(
    (solid) => !isInside(map, solids.kind[solid]),
  );
  const tops = Float32Array.from({ length: solids.count }, (_, solid) => topOf(map, solid));
  drawn.sort((one, other) => tops[one] - tops[other]);
  context.lineWidth = line;
  context.lineJoin = "round";
  for (const solid of drawn) drawSolid(map, solid, context);
}

// Furniture and stairs are under roofs.
function isInside({ kinds }: GameMap, kind: number): boolean {
  return kind === kinds.furniture || kind === kinds.stair;
}

function topOf({ solids }: GameMap, solid: number): number {
  let top = -Infinity;
  for (let at = 3 * solids.first[solid], end = endOf(solids, solid); at < end; at += 3)
    top = Math.max(top, solids.corners[at + 1]);
  return top;
}

// Draw the faces of a solid that look upwards.
function drawSolid(map: GameMap, solid: number, context: Context): void {
  const { corners, colors } = map.solids;
  const base = colors.subarray(3 * solid, 3 * solid + 3);
  const triangles = trianglesOf(map, solid);
  for (let place = 0; place < triangles.length; place += 3) {
    const [a, b, c] = triangles.slice(place, place + 3);
    const normal = normalOf(corners, a, b, c);
    if (normal[1] < 0.02) continue;
    const color = `rgb(${lit(base, normal, map.light).join(" ")})`;
    context.fillStyle = context.strokeStyle = color;
    context.beginPath();
    context.moveTo(corners[a], corners[a + 2]);
    context.lineTo(corners[b], corners[b + 2]);
    context.lineTo(corners[c], corners[c + 2]);
    context.closePath();
    context.fill();
    context.stroke();
  }
}
