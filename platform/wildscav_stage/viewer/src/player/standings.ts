// The standings beside the picture. A click on an agent follows it.

import type { Course } from "../data/course";
import type { Seat } from "../data/trails";
import { colorsOf } from "./colors";
import { make } from "./dom";
import { counted } from "./moments";
import { type Standing, Tally } from "./ranking";

interface Row {
  item: HTMLLIElement;
  button: HTMLButtonElement;
  place: HTMLElement;
  facts: HTMLElement;
  bar: HTMLElement;
  shown: string;
}

export class Standings {
  readonly element = make("ol", { className: "player-seats" });
  private readonly rows: Row[];
  private readonly tally: Tally;
  private order = "";

  constructor(
    private readonly course: Course,
    private readonly follow: (seat: number) => void,
  ) {
    this.tally = new Tally(course);
    this.rows = course.seats.map((seat) => this.row(seat));
    this.element.setAttribute("aria-label", "Standings");
  }

  // Take in the events that have come since.
  extend(): void {
    this.tally.update();
  }

  update(frame: number): void {
    const standings = this.tally.at(frame);
    for (const standing of standings) this.show(this.rows[standing.seat.seat], standing);
    this.arrange(standings.map(({ seat }) => seat.seat));
  }

  mark(followed: number | null): void {
    this.rows.forEach(({ button }, seat) => {
      button.setAttribute("aria-pressed", String(seat === followed));
    });
  }

  private row(seat: Seat): Row {
    const place = make("span", { className: "player-place" });
    const facts = make("span", { className: "player-facts" });
    const bar = make("span", { className: "player-bar" });
    const health = make("span", { className: "player-health" }, bar);
    health.setAttribute("aria-hidden", "true");
    const name = make("span", { className: "player-name", textContent: seat.name, title: seat.name });
    const kind =
      seat.kind === "submission" ? [] : [make("span", { className: "player-kind", textContent: "robot" })];
    const button = make(
      "button",
      { type: "button", className: "player-seat", onclick: () => this.follow(seat.seat) },
      place,
      badge(seat),
      make("span", { className: "player-who" }, name, ...kind),
      facts,
      health,
    );
    return { item: make("li", {}, button), button, place, facts, bar, shown: "" };
  }

  private show(row: Row, standing: Standing): void {
    const facts = this.facts(standing);
    const shown = `${standing.place} ${standing.health} ${facts}`;
    if (row.shown === shown) return;
    row.shown = shown;
    row.place.textContent = `${standing.place}.`;
    row.facts.textContent = facts;
    row.button.classList.toggle("player-dead", standing.health <= 0);
    const share = Math.max(0, standing.health / standing.seat.full_health);
    row.bar.style.width = `${100 * share}%`;
    row.bar.classList.toggle("player-low", share < 0.35);
  }

  private facts({ health, supplies, kills, distance, reached }: Standing): string {
    const { target, boxes } = this.course.trails;
    const facts = [health > 0 ? `${health} hp` : "dead"];
    if (reached !== null) facts.push("at the target");
    else if (target && distance !== null) facts.push(`${Math.round(distance)} m to the target`);
    if (boxes.length || supplies) facts.push(counted(supplies, "supply", "supplies"));
    if (this.course.seats.length > 1) facts.push(counted(kills, "kill"));
    return facts.join(" · ");
  }

  // Put the rows into an order; whoever has the focus keeps it.
  private arrange(seats: number[]): void {
    const order = seats.join();
    if (order === this.order) return;
    this.order = order;
    const focused = document.activeElement;
    let next = this.element.firstElementChild;
    for (const { item } of seats.map((seat) => this.rows[seat])) {
      if (item === next) next = item.nextElementSibling;
      else this.element.insertBefore(item, next);
    }
    if (focused instanceof HTMLElement && this.element.contains(focused))
      focused.focus({ preventScroll: true });
  }
}

// The number of a seat on its colour.
export function badge(seat: Seat): HTMLElement {
  const { color, ink } = colorsOf(seat);
  const element = make("span", { className: "player-badge", textContent: String(seat.seat) });
  element.style.backgroundColor = color;
  element.style.color = ink;
  return element;
}
