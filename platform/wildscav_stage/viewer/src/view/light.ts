// The light of the engine's cameras on a surface, as rendering/shading/light does it in the open air.

import type { Color, Corner, Light } from "../data/map";

export const DIRECT = 0.9; // share of the sun's light that cameras use
// Ambient light: its least, how it grows with the upward part of a normal, and with the eastern and northern.
export const AMBIENT = { level: 0.9, rise: 0.3, east: -0.1, north: -0.04 };

// Under a floor or a roof it comes from all walls.
export const ROOFED = { level: 0.94, rise: 0.06 };

// The colour 0-255 of a surface, given its colour without light and its unit normal.
export function lit(base: ArrayLike<number>, normal: Corner, light: Light, sunShare = 1): Color {
  const facing = normal[0] * light.sun[0] + normal[1] * light.sun[1] + normal[2] * light.sun[2];
  const direct = DIRECT * sunShare * Math.max(0, facing);
  const { level, rise, east, north } = AMBIENT;
  const ambient = level + rise * normal[1] + east * normal[0] + north * normal[2];
  const channel = (at: number) =>
    Math.min(255, Math.round(base[at] * (direct * light.sunlight[at] + ambient * light.skylight[at])));
  return [channel(0), channel(1), channel(2)];
}
