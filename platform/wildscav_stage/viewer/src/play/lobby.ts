// Who is here, what they are called, and the links by which the host invites others.

import { make } from "../player/dom";
import type { People, Person } from "./messages";
import { remember, remembered } from "./settings";

const WHERE = { here: "here", away: "not connected", expected: "not here yet" };
const COPIED = 1600; // ms
const NAME = "name"; // the key under which a chosen name is kept for the next game

export class Lobby {
  private readonly list: HTMLElement;
  private readonly form: HTMLFormElement;
  private readonly input: HTMLInputElement;
  private wanted = remembered(NAME);

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
  }

  // Take what the server says of everybody; seat is one's own.
  update(message: People, seat: number, standIn: string): void {
    const { people } = message;
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
    this.showWatching(message);
    this.say("");
  }

  say(text: string): void {
    this.part("#refusal").textContent = text;
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
    if (link) row.append(copyButton("Copy link", link), this.renewButton(person));
    return row;
  }

  private renewButton({ seat, name }: Person): HTMLElement {
    const title =
      "Make another link for this seat; the present one ends, and so does the page that has it open";
    const onclick = () => {
      if (confirm(`Make a new link for ${name}'s seat? The old one will no longer work.`))
        this.send({ kind: "renew", seat });
    };
    return make("button", { type: "button", textContent: "New link", title, onclick });
  }
}

// A line of the list of people; seat is one's own.
export function personRow(person: Person, seat: number | null): HTMLElement {
  const row = make("li");
  row.dataset.where = person.where;
  const roles = [person.seat === seat ? "you" : "", person.host ? "host" : ""].filter(Boolean);
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
