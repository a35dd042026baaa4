// What an agent says, over the picture. The list of events has it too, so screen readers skip this.

import type { Course } from "../data/course";
import { colorsOf } from "./colors";
import { make } from "./dom";

const SHORTEST = 3; // s that a caption is shown at least
const LETTER = 0.05; // s for each letter
const LONGEST = 300; // letters that are shown

export class Caption {
  readonly element = make("p", { className: "player-caption" });

  constructor(private readonly course: Course) {
    this.element.setAttribute("aria-hidden", "true");
  }

  // seat: whose words are shown; null for those of whoever spoke last.
  update(frame: number, seat: number | null): void {
    const text = saidAt(this.course, frame, seat);
    const shown = text ? `${text.name}: ${text.words}` : "";
    if (this.element.textContent === shown) return;
    this.element.replaceChildren();
    if (!text) return;
    const name = make("b", { textContent: text.name });
    name.style.color = colorsOf(this.course.seats[text.seat]).color;
    this.element.append(name, `: ${text.words}`);
  }
}

// What is said in a frame, and by whom; null if nothing is.
export function saidAt(
  course: Course,
  frame: number,
  seat: number | null,
): { seat: number; name: string; words: string } | null {
  const note = course.events.findLast(
    (event) => event.kind === "note" && event.frame <= frame && (seat === null || event.seat === seat),
  );
  if (!note?.text || note.seat === null) return null;
  if (course.seconds(frame - note.frame) > SHORTEST + LETTER * Math.min(LONGEST, note.text.length))
    return null;
  const words = note.text.length > LONGEST ? `${note.text.slice(0, LONGEST)}…` : note.text;
  return { seat: note.seat, name: course.seats[note.seat].name, words };
}
