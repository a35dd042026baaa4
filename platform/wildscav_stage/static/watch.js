// The page of a spectator: a match through anybody's eyes, or from above.

import { Connection } from "./connection.js";
import { fillTable, Hud } from "./hud.js";
import { personRow } from "./lobby.js";

const find = (id) => document.getElementById(id);
const game = find("game");
const canvas = find("picture").getContext("2d", { alpha: false });
const hud = new Hud();

canvas.fillStyle = "#0a1113";
canvas.fillRect(0, 0, canvas.canvas.width, canvas.canvas.height);

let table = null; // what is played here
let match = null; // what its beginning told
let names = [];
let view = null; // the seat whose eyes are seen through; null for the overview
let pictures = []; // when pictures were shown, ms

const connection = new Connection({
  onMessage: (message) => handlers[message.kind]?.(message),
  onPicture: showPicture,
  onLost: () => showPanel("lost", "Connection lost", "Trying to connect again …"),
  onClose: (code, reason) => showPanel("closed", "Not connected", reason ? `The server closed the connection: ${reason}.`
    : "The game does not answer. It may have ended; if it was started anew, its links have changed."),
});

const handlers = {
  table: (message) => {
    table = message;
    names = message.names;
    if (view !== null) connection.send({ kind: "watch", seat: view });
  },
  people: ({ people }) => find("lobby").querySelector("ul").replaceChildren(...people.map((person) => personRow(person, null))),
  lobby: () => showPanel("lobby", `Wildscav: ${table.track}`, "You watch the match as soon as the host starts it.", true),
  preparing: () => showPanel("preparing", "Making the map …", "The match starts in a few seconds.", true),
  countdown: ({ seconds }) => showPanel("countdown", `The match starts in ${seconds} …`, "", true),
  begin: (message) => {
    match = message;
    hud.begin(match, view, true);
    game.toggleAttribute("data-weapon", match.weapon);
    game.toggleAttribute("data-supplies", match.supplies);
    game.dataset.state = "watching";
    find("panel").hidden = true;
    find("hud").hidden = find("views").hidden = false;
    if (message.paused) hud.notice("Paused", 600_000);
  },
  paused: ({ paused }) => hud.notice(paused ? "Paused" : "", 600_000),
  scores: ({ rows }) => {
    names = [...rows].sort((a, b) => a.seat - b.seat).map(({ name }) => name);
    hud.showScores(rows);
    showViews();
  },
  failed: ({ message }) => showPanel("failed", "The match was not played", message, true),
  over: (message) => {
    showPanel("over", "The match is over", "You watch the next one as soon as the host starts it.");
    fillTable(find("result"), message.metrics.map(({ title, unit }) => (unit ? `${title} (${unit})` : title)), message.rows, null);
    find("result").hidden = false;
  },
};

function showPanel(state, title, words, people = false) {
  game.dataset.state = state;
  find("title").textContent = title;
  find("words").textContent = words;
  find("lobby").hidden = !people;
  find("result").hidden = true;
  find("hud").hidden = find("views").hidden = true;
  find("panel").hidden = false;
}

// Show a button for each view.
function showViews() {
  const bar = find("views");
  const titles = ["From above", ...names];
  while (bar.children.length > titles.length) bar.lastChild.remove();
  titles.forEach((title, index) => {
    const button = bar.children[index] ?? bar.appendChild(makeButton(index));
    button.lastChild.textContent = title;
    button.setAttribute("aria-pressed", String((view ?? -1) === index - 1));
  });
}

function makeButton(index) {
  const button = document.createElement("button");
  button.type = "button";
  const key = document.createElement("kbd");
  key.textContent = index;
  button.append(...(index < 10 ? [key] : []), document.createTextNode(""));
  button.addEventListener("click", () => choose(index));
  return button;
}

function choose(index) {
  if (index > names.length) return;
  view = index === 0 ? null : index - 1;
  connection.send({ kind: "watch", seat: view });
  hud.begin(match, view, true);
  showViews();
}

async function showPicture(head, blob) {
  const image = await createImageBitmap(blob);
  canvas.drawImage(image, 0, 0);
  image.close();
  connection.send({ kind: "seen", picture: head.picture });
  const now = performance.now();
  pictures = [...pictures.filter((when) => now - when < 1000), now];
  find("delay").textContent = `${head.delay === null ? "" : `picture there and back ${head.delay.toFixed(0)} ms, `}${pictures.length} pictures a second`;
  game.dataset.view = head.seat === null ? "overview" : "eyes";
  game.dataset.seat = head.seat ?? "";
  showLabels(head.labels ?? []);
  if (head.seat === null) hud.showTime(head);
  else if (match) hud.show(head);
}

// Write names over those who are seen from above.
function showLabels(labels) {
  const drawn = find("labels");
  while (drawn.children.length > labels.length) drawn.lastChild.remove();
  labels.forEach(({ seat, x, y }, index) => {
    const label = drawn.children[index] ?? drawn.appendChild(document.createElement("b"));
    label.textContent = names[seat] ?? "";
    label.style.left = `${100 * x}%`;
    label.style.top = `${100 * y}%`;
  });
}

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || game.dataset.state !== "watching") return;
  const count = names.length + 1;
  const now = (view ?? -1) + 1;
  if (/^[0-9]$/.test(event.key)) choose(Number(event.key));
  else if (event.key === "ArrowRight") choose((now + 1) % count);
  else if (event.key === "ArrowLeft") choose((now + count - 1) % count);
});
