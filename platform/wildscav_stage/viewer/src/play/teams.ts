// How a person tells teams apart: by colours that nothing else in the world has, and by marks beside names.
//
// The colours are those of bright ones whose least difference, from each other and from the world, is greatest as
// people see them with usual eyes and without one kind of cones; tests/teams.test.ts measures it.

import type { Color } from "../data/map";
import type { Seat } from "../data/trails";

export const MATES: Color = [0, 25, 255];
export const OTHERS: Color[] = [
  [255, 0, 179],
  [198, 255, 64],
  [194, 102, 255],
  [64, 255, 255],
];
const MATES_MARK = "○";
const MARKS = ["▲", "●", "★", "✚", "▼", "⬢", "♣"]; // their number and that of the colours have no common factor
const DARK: Color = [40, 42, 46];
// Weight of the team's colour in each part of a body: legs, torso, helmet, visor, rifle, pack. Visor and rifle stay.
const SHARES = [0.5, 0.5, 1, 0.85, null, null, 0.6];

export type MarkedSeat = Seat & { mark: string };

// Seats as somebody in one of them knows them.
export function asKnownTo(own: number, seats: Seat[]): MarkedSeat[] {
  const home = seats[own].team;
  const others = [...new Set(seats.map(({ team }) => team))].filter((team) => team !== home);
  return seats.map((seat) => {
    const order = others.indexOf(seat.team);
    const color = order < 0 ? MATES : OTHERS[order % OTHERS.length];
    const mark = order < 0 ? MATES_MARK : MARKS[order % MARKS.length];
    return { ...seat, mark, colors: seat.colors.map((part, at) => dyed(part, color, SHARES[at] ?? null)) };
  });
}

function dyed(part: Color, color: Color, share: number | null): Color {
  if (share === null) return part;
  return DARK.map((dark, at) => Math.round(dark + share * (color[at] - dark))) as Color;
}
