// The time line: a slider, behind which marks show when something happened.

import type { Course } from "../data/course";
import type { EventKind, MatchEvent } from "../data/trails";
import { clockText } from "./clock";
import { make } from "./dom";
import { describe, LOOKS } from "./moments";

const NEAR = 6; // px from a mark within which a click means its moment
const DRAGGED = 4; // px that make a click a drag
const THUMB = 10; // px, width of the handle, as in viewer.css
const THINNED: EventKind[] = ["pick_up", "hit", "note"]; // so many that only some are marked
const GAP = 5; // px between two marks of those

export class Timeline {
  readonly element: HTMLElement;
  private readonly marks = make("canvas", { className: "player-marks" });
  private readonly played = make("div", { className: "player-played" });
  private readonly tip = make("div", { className: "player-tip", hidden: true });
  private readonly range: HTMLInputElement;
  private events: MatchEvent[] = [];
  private shown: MatchEvent[] = []; // those that have marks
  private end = 0; // s
  private text = "";
  private readonly sizes = new ResizeObserver(() => this.drawMarks());

  // seek: told the seconds that a person asks for.
  constructor(
    private readonly course: Course,
    private readonly seek: (seconds: number) => void,
  ) {
    this.range = make("input", { type: "range", min: "0", className: "player-range" });
    this.range.step = String(1 / course.trails.frames_per_second);
    this.range.setAttribute("aria-label", "Time of the match");
    this.range.oninput = () => this.ask(Number(this.range.value));
    for (const element of [this.marks, this.tip]) element.setAttribute("aria-hidden", "true");
    this.listenForPointers();
    this.element = make("div", { className: "player-line" }, this.played, this.marks, this.range, this.tip);
    this.sizes.observe(this.marks);
  }

  // Mark these events.
  list(events: MatchEvent[]): void {
    this.events = events;
    this.drawMarks();
  }

  // Show a time, and the text for people who cannot see it.
  update(seconds: number, end: number, text: string): void {
    if (end !== this.end) {
      this.end = end;
      this.range.max = String(end);
      this.drawMarks();
    }
    this.range.value = String(seconds);
    this.played.style.transform = `scaleX(${end ? seconds / end : 0})`;
    if (text === this.text) return;
    this.text = text;
    this.range.setAttribute("aria-valuetext", text);
  }

  // Go to a time; a screen reader is told of it at once.
  private ask(seconds: number): void {
    this.seek(seconds);
    this.update(seconds, this.end, timeText(seconds, this.end));
  }

  dispose(): void {
    this.sizes.disconnect();
  }

  private drawMarks(): void {
    const ratio = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.marks;
    if (!width || !height) return;
    this.marks.width = Math.round(width * ratio);
    this.marks.height = Math.round(height * ratio);
    const context = this.marks.getContext("2d");
    if (!context) return;
    context.scale(ratio, ratio);
    this.shown = this.marked();
    for (const event of this.shown) {
      const { color, tall } = LOOKS[event.kind];
      context.fillStyle = color;
      context.fillRect(this.column(event.frame) - 1, height * (1 - tall), 2, height * tall);
      if (event.kind === "target") context.fillRect(this.column(event.frame) - 4, 0, 8, 5);
      if (event.kind === "death" || event.kind === "out") {
        context.fillRect(this.column(event.frame) - 3, 0, 6, 6);
      }
    }
  }

  // Lower marks first, so that taller ones lie on them.
  private marked(): MatchEvent[] {
    const last: Partial<Record<EventKind, number>> = {};
    const isApart = (event: MatchEvent) => {
      const column = this.column(event.frame);
      if (THINNED.includes(event.kind) && column - (last[event.kind] ?? -GAP) < GAP) return false;
      last[event.kind] = column;
      return true;
    };
    return this.events.filter(isApart).sort((one, other) => LOOKS[one.kind].tall - LOOKS[other.kind].tall);
  }

  // Where a frame lies, in px from the left: the handle's middle stands there too.
  private column(frame: number): number {
    const share = this.end ? this.course.seconds(frame) / this.end : 0;
    return THUMB / 2 + share * (this.marks.clientWidth - THUMB);
  }

  // Who points at a mark is told of it; a click beside it, without dragging, means it.
  private listenForPointers(): void {
    let from: number | null = null;
    this.range.onpointerdown = (press) => {
      from = press.offsetX;
    };
    this.range.onclick = (click) => {
      const mark = this.markAt(click.offsetX);
      if (from !== null && Math.abs(click.offsetX - from) < DRAGGED && mark) {
        this.seek(this.course.seconds(mark.frame));
      }
      from = null;
    };
    this.range.onpointermove = (move) => this.hint(move.offsetX);
    this.range.onpointerleave = () => {
      this.tip.hidden = true;
    };
  }

  private hint(column: number): void {
    const mark = this.markAt(column);
    const width = this.marks.clientWidth;
    const share = Math.min(1, Math.max(0, (column - THUMB / 2) / (width - THUMB)));
    const seconds = mark ? this.course.seconds(mark.frame) : share * this.end;
    this.tip.textContent = `${clockText(seconds)}${mark ? ` · ${describe(mark, this.course)}` : ""}`;
    this.tip.hidden = false;
    const half = this.tip.offsetWidth / 2;
    this.tip.style.left = `${Math.min(Math.max(half, column), width - half) - half}px`;
  }

  // The tallest mark near a place in px from the left, and of those the nearest.
  private markAt(column: number): MatchEvent | undefined {
    const away = (event: MatchEvent) => Math.abs(this.column(event.frame) - column);
    const near = this.shown.filter((event) => away(event) < NEAR);
    near.sort((one, other) => LOOKS[other.kind].tall - LOOKS[one.kind].tall || away(one) - away(other));
    return near[0];
  }
}

export function timeText(seconds: number, end: number): string {
  return `${clockText(seconds)} of ${clockText(end)}`;
}
