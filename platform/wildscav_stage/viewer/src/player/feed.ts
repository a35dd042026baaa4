// The latest deaths and arrivals, over the picture. The list of events has them too, so screen readers skip these.

import type { Course } from "../data/course";
import type { MatchEvent } from "../data/trails";
import { colorsOf } from "./colors";
import { make } from "./dom";
import { feedAt } from "./moments";

const SHOWN = 5; // s of a watcher's time
const MOST = 4; // lines

export class Feed {
  readonly element = make("ul", { className: "player-feed" });
  private shown: MatchEvent[] = [];

  constructor(private readonly course: Course) {
    this.element.setAttribute("aria-hidden", "true");
  }

  update(frame: number, speed: number): void {
    const frames = SHOWN * this.course.trails.frames_per_second * Math.max(1, speed);
    const events = feedAt(this.course, frame, frames, MOST);
    if (events.length === this.shown.length && events.every((event, at) => event === this.shown[at])) return;
    this.shown = events;
    this.element.replaceChildren(...events.map((event) => this.line(event)));
  }

  private line(event: MatchEvent): HTMLElement {
    if (event.kind === "target") return make("li", {}, this.name(event.seat), " reaches the target");
    if (event.other === null)
      return make("li", {}, this.name(event.seat), ` ${event.kind === "out" ? "is out" : "dies"}`);
    const verb = event.kind === "out" ? " knocks out " : " shoots ";
    return make("li", {}, this.name(event.other), verb, this.name(event.seat));
  }

  private name(number: number | null): HTMLElement {
    const seat = this.course.seats[number ?? 0];
    const dot = make("span", { className: "player-dot" });
    dot.style.backgroundColor = colorsOf(seat).color;
    return make("b", {}, dot, seat.name);
  }
}
