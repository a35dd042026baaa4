// The list of events, which screen readers get too, and the kinds that it shows.

import type { Course } from "../data/course";
import type { EventKind, MatchEvent } from "../data/trails";
import { clockText } from "./clock";
import { make } from "./dom";
import { describe, KINDS, LOOKS } from "./moments";

const MOST = 200; // events that are listed as a whole; of more, as many before and after the present moment

export class EventList {
  readonly filters = make("div", { className: "player-filters", role: "group" });
  readonly element = make("ol", { className: "player-events", tabIndex: 0 });
  listed: MatchEvent[] = [];
  private readonly shownKinds = new Set<EventKind>(KINDS);
  private first = -1; // of the listed events, in the list
  private frame = 0; // of the present moment
  private current: Element | null = null;

  // changed: told when other events are listed; the list is empty until `extend`.
  constructor(
    private readonly course: Course,
    private readonly seek: (frame: number) => void,
    private readonly changed: () => void,
  ) {
    this.filters.setAttribute("aria-label", "Kinds of events");
    this.element.setAttribute("aria-label", "Events");
    this.element.onkeydown = (press) => this.moveAmong(press);
  }

  // Take in the events that have come since.
  extend(): void {
    const present = KINDS.filter((kind) => this.course.events.some((event) => event.kind === kind));
    if (present.length !== this.filters.childElementCount) {
      this.filters.replaceChildren(...present.map((kind) => this.filter(kind)));
    }
    this.choose();
  }

  // List the events of the kinds that are shown. Those that are in the list stay, and so does the focus.
  private choose(): void {
    const before = this.listed[this.first + this.element.childElementCount - 1];
    this.listed = this.course.events.filter((event) => this.shownKinds.has(event.kind));
    const last = this.first + this.element.childElementCount - 1;
    if (before && this.listed[last] === before) this.append(last + 1);
    else this.first = -1;
    this.update(this.frame);
    this.changed();
  }

  // Mark the last event that has happened; of very many events, list those around it.
  update(frame: number): void {
    this.frame = frame;
    const now = this.listed.findLastIndex((event) => event.frame <= frame);
    const page = MOST / 2;
    const first = this.listed.length <= MOST ? 0 : Math.max(0, (Math.floor(now / page) - 1) * page);
    if (first !== this.first) this.fill(first);
    const item = this.element.children[now - first] ?? null;
    if (item === this.current) return;
    this.current?.firstElementChild?.removeAttribute("aria-current");
    item?.firstElementChild?.setAttribute("aria-current", "true");
    this.current = item;
    if (item instanceof HTMLElement && !this.element.contains(document.activeElement)) {
      this.element.scrollTop = item.offsetTop - this.element.clientHeight / 2;
    }
  }

  private fill(first: number): void {
    this.first = first;
    this.element.replaceChildren();
    this.append(first);
    this.current = null;
  }

  private append(from: number): void {
    const some = this.listed.slice(from, this.first + 2 * MOST);
    this.element.append(...some.map((event) => this.item(event)));
  }

  private item(event: MatchEvent): HTMLLIElement {
    const at = clockText(this.course.seconds(event.frame));
    const jump = make(
      "button",
      { type: "button", tabIndex: -1, onclick: () => this.seek(event.frame) },
      make("span", { className: "player-at", textContent: at }),
      swatch(event.kind),
      make("span", { textContent: describe(event, this.course) }),
    );
    return make("li", {}, jump);
  }

  private filter(kind: EventKind): HTMLLabelElement {
    const box = make("input", { type: "checkbox", checked: this.shownKinds.has(kind) });
    box.onchange = () => {
      if (box.checked) this.shownKinds.add(kind);
      else this.shownKinds.delete(kind);
      this.choose();
    };
    return make("label", {}, box, swatch(kind), LOOKS[kind].title);
  }

  // The list is one stop of the tab key; the arrows lead through its events, from the present one on.
  private moveAmong(press: KeyboardEvent): void {
    const step = { ArrowDown: 1, ArrowUp: -1 }[press.key];
    if (!step) return;
    press.preventDefault();
    const items = [...this.element.children];
    const at = items.findIndex((item) => item.contains(document.activeElement));
    const next = at < 0 ? items.indexOf(this.current as Element) : at + step;
    const button = items[Math.min(Math.max(0, next), items.length - 1)]?.firstElementChild;
    if (button instanceof HTMLElement) button.focus();
  }
}

function swatch(kind: EventKind): HTMLElement {
  const element = make("span", { className: `player-swatch player-swatch-${kind}` });
  element.style.backgroundColor = LOOKS[kind].color;
  return element;
}
