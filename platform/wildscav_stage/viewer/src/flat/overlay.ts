// What moves on the map, drawn on the picture of it: lengths are metres, north is up.

import type { Course, SeatState } from "../data/course";
import { CLOTHES, METRE } from "../data/trails";
import { drawName, LABEL_HEIGHT } from "../view/names";
import type { Way } from "../view/ways";

const SHOT = 9; // frames that a shot is seen

export interface Canvas {
  context: CanvasRenderingContext2D;
  pixel: number; // m, the side of a CSS pixel
}

export function drawBoxes({ context, pixel }: Canvas, course: Course, frame: number): void {
  const half = Math.max(0.4, 2.5 * pixel);
  context.lineWidth = Math.max(0.1, pixel);
  context.strokeStyle = "#10233a";
  for (const { x, z, dropped } of course.boxesAt(frame)) {
    context.fillStyle = dropped ? "#ffc85a" : "#6bdcff";
    context.beginPath();
    context.rect(x / METRE - half, z / METRE - half, 2 * half, 2 * half);
    context.fill();
    context.stroke();
  }
}

export function drawZone({ context, pixel }: Canvas, course: Course, frame: number, size: number): void {
  const zone = course.zoneAt(frame);
  if (!zone) return;
  const { now, next } = zone;
  context.beginPath();
  context.rect(-size * 3, -size * 3, size * 6, size * 6);
  context.arc(now.x, now.z, now.radius, 0, 2 * Math.PI, true);
  context.fillStyle = "rgba(96, 34, 128, 0.42)";
  context.fill("evenodd");
  for (const [circle, color, width] of [
    [now, "#bd5cff", 2],
    [next, "#ffffff", 1.5],
  ] as const) {
    context.beginPath();
    context.arc(circle.x, circle.z, circle.radius, 0, 2 * Math.PI);
    context.strokeStyle = color;
    context.lineWidth = width * pixel;
    context.stroke();
  }
}

export function drawTarget({ context, pixel }: Canvas, course: Course): void {
  const { target } = course.trails;
  if (!target) return;
  for (const [radius, color] of [
    [11, "#17140a"],
    [9, "#ffd633"],
    [6, "#17140a"],
    [4, "#ffd633"],
  ] as const) {
    context.beginPath();
    context.arc(target.x / METRE, target.z / METRE, radius * pixel, 0, 2 * Math.PI);
    context.fillStyle = color;
    context.fill();
  }
}

// The last seconds of everybody's way.
export function drawWays({ context, pixel }: Canvas, course: Course, ways: Way[]): void {
  context.lineWidth = 2 * pixel;
  context.lineCap = "round";
  for (const { seat, from, to, toOpacity } of ways) {
    const { x, z } = course.samples[seat];
    context.strokeStyle = colorOf(course.seats[seat].colors[CLOTHES]);
    context.globalAlpha = toOpacity;
    context.beginPath();
    context.moveTo(x[from] / METRE, z[from] / METRE);
    context.lineTo(x[to] / METRE, z[to] / METRE);
    context.stroke();
  }
  context.globalAlpha = 1;
}

export function drawShots({ context, pixel }: Canvas, course: Course, frame: number): void {
  context.strokeStyle = "#ffecaa";
  context.lineWidth = 2 * pixel;
  for (const shot of course.shotsBetween(frame - SHOT, frame + 1e-6)) {
    const { x, z } = course.at(shot.seat, shot.frame);
    context.globalAlpha = 1 - (0.7 * (frame - shot.frame)) / SHOT;
    context.beginPath();
    context.moveTo(x, z);
    context.lineTo(shot.x, shot.z);
    context.stroke();
  }
  context.globalAlpha = 1;
}

export function drawAgents(canvas: Canvas, course: Course, frame: number, hits: number[]): void {
  const { context, pixel } = canvas;
  course.seats.forEach((seat, place) => {
    const state = course.at(place, frame);
    context.save();
    context.translate(state.x, state.z);
    context.scale(pixel, pixel);
    if (state.health > 0) drawMarker(context, seat.colors[CLOTHES], state, hits[place]);
    else drawCross(context, seat.colors[CLOTHES]);
    drawLabel(context, seat.name, seat.colors[CLOTHES], state.health / seat.full_health);
    context.restore();
  });
}

// A circle with a tip that shows where an agent looks.
function drawMarker(
  context: CanvasRenderingContext2D,
  color: number[],
  { yaw }: SeatState,
  hit: number,
): void {
  context.save();
  context.rotate((-yaw * Math.PI) / 180);
  context.beginPath();
  context.arc(0, 0, 6.5, Math.PI * 0.25, Math.PI * 0.75, true);
  context.lineTo(0, 13);
  context.closePath();
  context.fillStyle = hit > 0 ? "#fff" : colorOf(color);
  context.strokeStyle = "#0a0c12";
  context.lineWidth = 1.6;
  context.lineJoin = "round";
  context.fill();
  context.stroke();
  context.restore();
}

function drawCross(context: CanvasRenderingContext2D, color: number[]): void {
  context.beginPath();
  for (const side of [-1, 1]) {
    context.moveTo(-5, -5 * side);
    context.lineTo(5, 5 * side);
  }
  context.lineWidth = 5;
  context.strokeStyle = "#0a0c12";
  context.stroke();
  context.lineWidth = 2.4;
  context.strokeStyle = colorOf(color.map((part) => Math.round(0.7 * part)));
  context.stroke();
}

function drawLabel(context: CanvasRenderingContext2D, name: string, color: number[], share: number): void {
  context.save();
  context.scale(1, -1);
  context.globalAlpha = share > 0 ? 1 : 0.55;
  const width = drawName(context, name, color, -15 - LABEL_HEIGHT - 6);
  if (share > 0) {
    context.fillStyle = "rgba(12, 16, 22, 0.82)";
    context.fillRect(-width / 2 + 1, -21, width - 2, 5);
    context.fillStyle = share > 0.5 ? "#5cdb59" : share > 0.25 ? "#fac233" : "#f74d40";
    context.fillRect(-width / 2 + 2, -20, (width - 4) * Math.min(1, share), 3);
  }
  context.restore();
}

function colorOf(color: number[]): string {
  return `rgb(${color.join(" ")})`;
}
