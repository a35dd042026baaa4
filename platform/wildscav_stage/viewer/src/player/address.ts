// Links to a moment of a match: what stands behind "#" in the address of its page, as in #t=73.2&view=behind&seat=3.

import type { View, ViewKind } from "../stage";

const KINDS: ViewKind[] = ["free", "behind", "eyes", "above"];

export interface Moment {
  seconds: number | null;
  view: ViewKind | null;
  seat: number | null;
}

// The moment that an address names; null if it names none. What it says wrongly counts as not said.
export function readMoment(hash: string): Moment | null {
  const said = new URLSearchParams(hash.replace(/^#/, ""));
  const seconds = numberOf(said.get("t"));
  const view = KINDS.find((kind) => kind === said.get("view")) ?? null;
  const seat = numberOf(said.get("seat"));
  const moment = { seconds, view, seat: seat !== null && Number.isInteger(seat) ? seat : null };
  return moment.seconds === null && moment.view === null && moment.seat === null ? null : moment;
}

// isPinned: whether a seat is followed whatever happens; else whoever has most to do is.
export function writeMoment(seconds: number, view: View, isPinned: boolean): string {
  const followed = isPinned && followsSeat(view.kind) ? `&seat=${view.seat}` : "";
  return `#t=${Math.round(seconds * 100) / 100}&view=${view.kind}${followed}`;
}

export function followsSeat(kind: ViewKind): boolean {
  return kind === "behind" || kind === "eyes";
}

function numberOf(text: string | null): number | null {
  if (!text || !/^\d+(\.\d+)?$/.test(text)) return null;
  const number = Number(text);
  return Number.isFinite(number) ? number : null;
}
