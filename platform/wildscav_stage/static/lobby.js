// Who is here, what they are called, and the links by which the host invites others.

const WHERE = { here: "here", away: "not connected", expected: "not here yet" };
const COPIED = 1600; // ms

export class Lobby {
  // section holds a list, a form with a name, and notes; send sends a message to the server.
  constructor(section, send) {
    this.section = section;
    this.send = send;
    this.list = section.querySelector("ul");
    this.form = section.querySelector("form");
    this.input = this.form.querySelector("input");
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#rename();
    });
    this.input.addEventListener("change", () => this.#rename());
    this.wanted = remembered();
  }

  // Take what the server says of everybody; seat is one's own.
  update(message, seat, standIn) {
    const own = message.people[seat];
    if (document.activeElement !== this.input) this.input.value = own.name;
    if (this.wanted && this.wanted !== own.name) this.send({ kind: "rename", name: this.wanted });
    this.wanted = "";
    this.list.replaceChildren(...message.people.map((person) => this.#row(person, seat, message.links)));
    this.list.hidden = this.form.hidden = message.people.length < 2;
    const missing = message.people.length > 1 && message.people.some(({ where }) => where !== "here");
    this.section.querySelector("#missing").textContent = missing
      ? `A robot (${standIn}) plays for whoever is not here when the match starts.` : "";
    this.#showWatching(message);
    this.say("");
  }

  say(text) {
    this.section.querySelector("#refusal").textContent = text;
  }

  #rename() {
    const name = this.input.value.trim();
    if (!name) return;
    remember(name);
    this.send({ kind: "rename", name });
  }

  // Show how many watch, and to the host the link by which they do.
  #showWatching({ spectators, watch_link: link, local_only: localOnly }) {
    const watching = this.section.querySelector("#watching");
    const count = spectators ? `${spectators} ${spectators === 1 ? "person watches" : "people watch"}. ` : "";
    watching.replaceChildren(count, ...(link ? ["Spectators see everybody's eyes: ", copyButton("Copy their link", link)] : []));
    this.section.querySelector("#local").hidden = !localOnly;
  }

  #row(person, seat, links) {
    const row = personRow(person, seat);
    const link = links?.[person.seat];
    if (link) row.append(copyButton("Copy link", link), this.#renewButton(person));
    return row;
  }

  #renewButton({ seat, name }) {
    const button = element("button", "New link");
    button.type = "button";
    button.title = `Make another link for this seat; the present one ends, and so does the page that has it open`;
    button.addEventListener("click", () => {
      if (confirm(`Make a new link for ${name}'s seat? The old one will no longer work.`)) this.send({ kind: "renew", seat });
    });
    return button;
  }
}

// A line of the list of people; seat is one's own.
export function personRow(person, seat) {
  const row = document.createElement("li");
  row.dataset.where = person.where;
  const roles = [person.seat === seat ? "you" : "", person.host ? "host" : ""].filter(Boolean);
  if (person.where !== "here" || !roles.length) roles.push(WHERE[person.where]);
  row.append(dot(), element("b", person.name), element("small", roles.join(", ")));
  return row;
}

function element(name, text) {
  const made = document.createElement(name);
  made.textContent = text;
  return made;
}

function dot() {
  const made = element("i", "");
  made.setAttribute("aria-hidden", "true");
  return made;
}

// A button that copies a link.
export function copyButton(label, link) {
  const button = element("button", label);
  button.type = "button";
  button.dataset.link = link;
  button.addEventListener("click", async () => {
    button.textContent = (await copied(link)) ? "Copied" : "Not copied";
    setTimeout(() => { button.textContent = label; }, COPIED);
  });
  return button;
}

// Browsers have a clipboard only on encrypted pages and on their own machine; elsewhere an older way works.
async function copied(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = document.body.appendChild(element("textarea", text));
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    if (!done) prompt("Copy this link:", text);
    return done;
  }
}

// The name that somebody chose is kept in the browser for the next game.
function remembered() {
  try { return localStorage.getItem("name") ?? ""; } catch { return ""; }
}

function remember(name) {
  try { localStorage.setItem("name", name); } catch { /* a browser may forbid it */ }
}
