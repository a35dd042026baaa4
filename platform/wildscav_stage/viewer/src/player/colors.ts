// The colours by which people know seats: those of the bodies in the picture.

import { CLOTHES, type Seat } from "../data/trails";

const UNKNOWN: [number, number, number] = [200, 200, 200];
const DARK = "#16181a";

// The colour of a seat, and of letters that can be read on it.
export function colorsOf(seat: Seat): { color: string; ink: string } {
  const [red, green, blue] = seat.colors[CLOTHES] ?? seat.colors[0] ?? UNKNOWN;
  const luminance = 0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue);
  return { color: `rgb(${red} ${green} ${blue})`, ink: luminance > 0.18 ? DARK : "#ffffff" };
}

function linear(value: number): number {
  return (value / 255) ** 2.2;
}
