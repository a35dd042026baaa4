// How a person came to die, as far as their seat knows: see sight.py.

import { METRE } from "../data/trails";
import { bearingOf, type Place } from "./bearing";
import type { Now } from "./messages";

const EYE = 1.5; // m over the soles
const CHEST = 1.2; // likewise
const TURNING = 700; // ms in which the view turns to who did it

// Hits between a seat and all others since it came to life.
export class Hits {
  private readonly given = new Map<number, number>();
  private readonly taken = new Map<number, number>();

  note({ hits, hurt }: Now): void {
    for (const seat of hits ?? []) this.given.set(seat, 1 + (this.given.get(seat) ?? 0));
    for (const seat of hurt ?? []) this.taken.set(seat, 1 + (this.taken.get(seat) ?? 0));
  }

  with(seat: number): { given: number; taken: number } {
    return { given: this.given.get(seat) ?? 0, taken: this.taken.get(seat) ?? 0 };
  }

  forget(): void {
    this.given.clear();
    this.taken.clear();
  }
}

export interface Killer extends Place {
  seat: number;
  y: number; // m, of the soles
  health: number | null; // null if that is not told
}

export function killerOf(row: number[] | undefined): Killer | null {
  if (!row) return null;
  const [x, y, z] = row.slice(1, 4).map((value) => value / METRE);
  return { seat: row[0], x, y, z, health: row[4] ?? null };
}

// What a person reads about their death by somebody. killer: null if one did not see who it was.
export function wordsOf(name: string, killer: Killer | null, here: Place, hits: Hits, by: number): string[] {
  const { given, taken } = hits.with(by);
  const distance = killer && bearingOf(here, killer).distance;
  const where = distance === null ? "from outside your view" : `from ${distance.toFixed(0)} m away`;
  const left = killer?.health ? `, and has ${killer.health} health left` : "";
  return [`${name} shot you ${where}${left}.`, `Hits on you: ${taken}. Yours on ${name}: ${given}.`];
}

// Where the view of a dead body looks, some ms after its death: ever more at who did it. All in degrees.
export function turnedTo(
  killer: Killer,
  from: Place & { y: number; yaw: number; pitch: number },
  since: number,
): { yaw: number; pitch: number } {
  const { bearing, distance } = bearingOf(from, killer);
  const down = (Math.atan2(from.y + EYE - killer.y - CHEST, distance) * 180) / Math.PI;
  const share = Math.min(1, since / TURNING);
  const eased = share * share * (3 - 2 * share);
  const away = ((bearing - from.yaw + 540) % 360) - 180;
  return { yaw: from.yaw + eased * away, pitch: from.pitch + eased * (down - from.pitch) };
}
