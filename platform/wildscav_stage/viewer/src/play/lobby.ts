// Who is here, what they are called, how the host invites others, and what is played next.

import { make } from "../player/dom";
import type { People, Person, Room, Table } from "./messages";
import { remember, remembered } from "./settings";

const WHERE = { here: "here", away: "not connected", expected: "not here yet" };
const COPIED = 1600; // ms
const NAME = "name"; // the key under which a chosen name is kept for the next game
const MAX_ROBOTS = 8; // that the host can choose, unless there are more already

export class Lobby {
  private readonly list: HTMLElement;
  private readonly form: HTMLFormElement;
  private readonly input: HTMLInputElement;
  private readonly robots: HTMLSelectElement;
  private readonly kind: HTMLSelectElement;
  private readonly newMap: HTMLInputElement;
  private wanted = remembered(NAME);
  private told = ""; // what is shown of the next match
  private last: [People, string[]] | null = null; // from which that is made
  private codeEnds = 0; // id of the timer that forgets the code

  // section holds a list, a form with a name, and notes; send sends a message to the server.
  constructor(
    private readonly section: HTMLElement,
    private readonly send: (message: object) => void,
  ) {
    this.list = this.part("ul");
    this.form = this.part("form") as HTMLFormElement;
    this.input = this.part("form input") as HTMLInputElement;
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.rename();
    });
    this.input.addEventListener("change", () => this.rename());
    const arrange = () => this.arrange();
    this.robots = make("select", { ariaLabel: "Robots", onchange: arrange });
    this.kind = make("select", { ariaLabel: "Kind of robots", onchange: arrange });
    this.newMap = make("input", { type: "checkbox", onchange: arrange });
  }

  // Take what the server says of everybody; seat is one's own.
  update(message: People, { seat, stand_in: standIn, kinds }: Table): void {
    const { people } = message;
    if (seat === null) return;
    const own = people[seat];
    if (document.activeElement !== this.input) this.input.value = own.name;
    if (this.wanted && this.wanted !== own.name) this.send({ kind: "rename", name: this.wanted });
    this.wanted = "";
    this.list.replaceChildren(...people.map((person) => this.row(person, seat, message.links)));
    this.list.hidden = this.form.hidden = people.length < 2;
    const missing = people.length > 1 && people.some(({ where }) => where !== "here");
    this.part("#missing").textContent = missing
      ? `A robot (${standIn}) plays for whoever is not here when the match starts.`
      : "";
    this.showRoom(message.room);
    this.last = [message, people[seat].host ? kinds : []];
    this.showNext(...this.last);
    this.showWatching(message);
    this.say("");
  }

  // Say why something was refused, and show what holds again.
  say(text: string): void {
    this.part("#refusal").textContent = text;
    if (!text || !this.last) return;
    this.told = "";
    this.showNext(...this.last);
  }

  private part(path: string): HTMLElement {
    return this.section.querySelector(path) as HTMLElement;
  }

  private rename(): void {
    const name = this.input.value.trim();
    if (!name) return;
    remember(NAME, name);
    this.send({ kind: "rename", name });
  }

  // Show the code by which guests come, and forget it when it ends.
  private showRoom(room?: Room | null): void {
    clearTimeout(this.codeEnds);
    const part = this.part("#room");
    part.hidden = !room;
    if (!room) return;
    const { code, link, seconds } = room;
    const open = (label: string) => this.button(label, { kind: "room", open: true });
    if (!code) {
      part.replaceChildren("Nobody can join by a code. ", open("Make a code"));
      return;
    }
    const minutes = Math.ceil(seconds / 60);
    const words = make(
      "small",
      { title: "Whoever enters this code takes a free seat" },
      `code, ${minutes} min`,
    );
    const close = this.button("Close", { kind: "room", open: false });
    part.replaceChildren(make("b", {}, code), words, copyButton("Copy link", link), open("New code"), close);
    this.codeEnds = window.setTimeout(() => this.showRoom({ code: "", link, seconds: 0 }), 1000 * seconds);
  }

  // Show what is played next; to the host, who has kinds of robots to choose from, with choices.
  private showNext({ opponents, robots, new_map: newMap }: People, kinds: string[]): void {
    const part = this.part("#next");
    const told = JSON.stringify([opponents, robots, newMap, kinds]);
    if (told === this.told) return; // so that a list that is open stays open
    this.told = told;
    if (!kinds.length) {
      const against = opponents.length ? `Also in the match: ${opponents.join(", ")}.` : "";
      part.replaceChildren([against, newMap ? "The next map is another one." : ""].filter(Boolean).join(" "));
      return;
    }
    const mixed = new Set(robots).size > 1;
    const values = mixed ? [robots.join(), ...kinds] : kinds;
    const titles = mixed ? ["mixed", ...kinds] : kinds;
    const kind = this.kind.value; // of no robots
    this.kind.replaceChildren(...values.map((value, index) => make("option", { value }, titles[index])));
    this.kind.value = mixed ? values[0] : (robots[0] ?? (kinds.includes(kind) ? kind : kinds[0]));
    const counts = countsOfRobots(robots.length);
    this.robots.replaceChildren(
      ...counts.map((title, count) => make("option", { value: `${count}` }, title)),
    );
    this.robots.selectedIndex = robots.length;
    this.newMap.checked = newMap;
    const others = opponents.slice(0, opponents.length - robots.length);
    const first = others.length ? `${others.join(", ")}, ` : "";
    part.replaceChildren(
      `Also in the match: ${first}`,
      this.robots,
      this.kind,
      make("label", {}, this.newMap, "another map"),
    );
  }

  // Tell the server what the host has chosen.
  private arrange(): void {
    const kinds = this.kind.value.split(",");
    const robots = Array.from(
      { length: this.robots.selectedIndex },
      (_, index) => kinds[index % kinds.length],
    );
    this.send({ kind: "arrange", robots, new_map: this.newMap.checked });
  }

  private button(textContent: string, message: object): HTMLElement {
    return make("button", { type: "button", textContent, onclick: () => this.send(message) });
  }

  // Show how many watch, and to the host the link by which they do.
  private showWatching({ spectators, watch_link: link, local_only: localOnly }: People): void {
    const count = spectators ? `${spectators} ${spectators === 1 ? "person watches" : "people watch"}. ` : "";
    const invitation = link ? ["Spectators see everybody: ", copyButton("Copy their link", link)] : [];
    this.part("#watching").replaceChildren(count, ...invitation);
    this.part("#local").hidden = !localOnly;
  }

  private row(person: Person, seat: number, links?: Record<string, string>): HTMLElement {
    const row = personRow(person, seat);
    const link = links?.[person.seat];
    if (link) row.append(copyButton("Copy link", link), this.freeButton(person));
    return row;
  }

  private freeButton({ seat, name, where }: Person): HTMLElement {
    const isFree = where === "expected";
    const title = "Give this seat another link; the present one ends, and so does the page that has it open";
    const onclick = () => {
      if (isFree || confirm(`Free ${name}'s seat? Its link will no longer work.`))
        this.send({ kind: "free", seat });
    };
    return make("button", { type: "button", textContent: isFree ? "New link" : "Free", title, onclick });
  }
}

// The titles of the numbers of robots, from none up, that the host can choose while there are some.
export function countsOfRobots(present: number): string[] {
  return Array.from({ length: Math.max(MAX_ROBOTS, present) + 1 }, (_, count) =>
    count === 1 ? "1 robot" : `${count || "no"} robots`,
  );
}

// A line of the list of people; seat is one's own.
export function personRow(person: Person, seat: number | null): HTMLElement {
  const row = make("li");
  row.dataset.where = person.where;
  const is = (holds: boolean, role: string) => (holds ? role : "");
  const roles = [is(person.seat === seat, "you"), is(person.host, "host"), is(person.ready, "ready")].filter(
    Boolean,
  );
  if (person.where !== "here" || !roles.length) roles.push(WHERE[person.where]);
  const dot = make("i", { "aria-hidden": "true" });
  row.append(dot, make("b", {}, person.name), make("small", {}, roles.join(", ")));
  return row;
}

// A button that copies a link.
function copyButton(label: string, link: string): HTMLElement {
  const onclick = async () => {
    made.textContent = (await copied(link)) ? "Copied" : "Not copied";
    setTimeout(() => {
      made.textContent = label;
    }, COPIED);
  };
  const made = make("button", { type: "button", textContent: label, onclick });
  made.dataset.link = link;
  return made;
}

// Browsers have a clipboard only on encrypted pages and on their own machine; elsewhere an older way works.
async function copied(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = document.body.appendChild(make("textarea", { value: text }));
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    if (!done) prompt("Copy this link:", text);
    return done;
  }
}
