// The light of the engine's cameras on a surface, as rendering/shading/light does it in the open air.

import type { Color, Corner, Light } from "../data/map";

// The colour 0-255 of a surface, given its colour without light and its unit normal.
export function lit(base: ArrayLike<number>, normal: Corner, light: Light, sunShare = 1): Color {
  const { sun, direct, open, side } = light;
  const facing = normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2];
  const sunny = direct * sunShare * Math.max(0, facing);
  const ambient = open[0] + open[1] * normal[1] + side[0] * normal[0] + side[1] * normal[2];
  const channel = (at: number) =>
    Math.min(255, Math.round(base[at] * (sunny * light.sunlight[at] + ambient * light.skylight[at])));
  return [channel(0), channel(1), channel(2)];
}
