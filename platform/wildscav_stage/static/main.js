// The page: it shows what the server sends, and sends what the person does.

import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { fillTable, Hud } from "./hud.js";
import { Lobby } from "./lobby.js";
import { Sounds } from "./sounds.js";

const REPLACED = 4001, RENEWED = 4002; // close codes: the link was opened elsewhere, or has ended
const HOST = 0; // the seat that starts matches
const KEPT = 60; // delays that their median is of
const find = (id) => document.getElementById(id);
const game = find("game");
const canvas = find("picture").getContext("2d", { alpha: false });
const controls = new Controls(find("picture"), find("stick"), document.querySelectorAll("#buttons button"));
const hud = new Hud();
const sounds = new Sounds();
const hasMouse = matchMedia("(pointer: fine)").matches;
const GOALS = {
  navigation: "Find the way to the target, as fast as you can. The compass points to it: ◆.",
  gathering: "Gather as many supplies as you can. The compass shows boxes nearby: ▪.",
  capture: "Find the hidden target.",
  battle: "Gather supplies, and fight for those that others carry.",
  royale: "Be the last who stands. Stay inside the safe zone.",
};

canvas.fillStyle = "#0a1113";
canvas.fillRect(0, 0, canvas.canvas.width, canvas.canvas.height);

let table = null; // what is played here
let number = 0; // of the last input
let inputAt = new Map(); // when inputs were sent, ms, by their numbers
let delays = [];
let pictures = []; // when pictures were shown, ms
let lastInput = performance.now();
let lastSent = "";

const connection = new Connection({
  onMessage: (message) => handlers[message.kind](message),
  onPicture: showPicture,
  onLost: () => {
    const meanwhile = !table ? "" : table.may_pause ? "The match waits for you. " : "Your seat stands idle until you are back. ";
    showPanel("lost", "Connection lost", `${meanwhile}Trying to connect again …`);
  },
  onClose: (code, reason) => {
    if (code === REPLACED) return showPanel("closed", "Opened elsewhere", "You play on in the page that opened your link last.", "Play here");
    if (code === RENEWED) return showPanel("closed", "This link was replaced", "The host has made a new link for this seat. Ask the host for it.");
    const why = reason ? `The server closed the connection: ${reason}.`
      : "The game does not answer. It may have ended; if it was started anew, its links have changed.";
    return showPanel("closed", "Not connected", why, "Try again");
  },
});
const lobby = new Lobby(find("lobby"), (message) => connection.send(message));

const handlers = {
  table: (message) => {
    table = message;
    find("escape").textContent = table.may_pause ? "free the mouse, pause" : "free the mouse";
  },
  people: (message) => {
    lobby.update(message, table.seat, table.stand_in);
    find("lobby").hidden = !showsPeople();
  },
  refused: ({ message }) => lobby.say(`${message[0].toUpperCase()}${message.slice(1)}.`),
  lobby: () => {
    game.toggleAttribute("data-weapon", ["battle", "royale"].includes(table.track));
    game.toggleAttribute("data-supplies", table.track !== "navigation" && table.track !== "capture");
    const others = table.names.slice(table.people);
    const against = others.length ? ` ${table.people > 1 ? "Robots and agents" : "Against you"}: ${others.join(", ")}.` : "";
    const fingers = matchMedia("(pointer: coarse)").matches ? " Walk with the stick, and swipe over the picture to look around." : "";
    const waits = isHost() ? "" : " The host starts the match.";
    showPanel("lobby", `Wildscav: ${table.track}`, `${GOALS[table.track] ?? ""}${against}${fingers}${waits}`, startButton("Play"), { keys: true });
  },
  preparing: () => showPanel("preparing", "Making the map …", "This takes a few seconds."),
  countdown: ({ seconds }) => {
    showPanel("countdown", `The match starts in ${seconds} …`, GOALS[table.track] ?? "", "", { keys: true });
    sounds.playTick();
  },
  elsewhere: () => showPanel("elsewhere", "A match is being played", "It began without you. You take part in the next one."),
  begin: (message) => {
    hud.begin(message, table.seat);
    [delays, pictures, inputAt] = [[], [], new Map()];
    game.toggleAttribute("data-weapon", message.weapon);
    game.toggleAttribute("data-supplies", message.supplies);
    if (message.paused) handlers.paused(message);
    else play();
  },
  paused: ({ paused }) => {
    if (paused) showPanel("paused", "Paused", "The match waits for you.", "Go on", { keys: true });
    else play();
  },
  scores: ({ rows }) => hud.showScores(rows),
  failed: ({ message }) => showPanel("failed", "The match was not played", message, startButton("Try again")),
  over: showEnd,
};

const isHost = () => table.seat === HOST;
const startButton = (text) => (isHost() ? text : "");
const showsPeople = () => (table?.people > 1 || (table && isHost())) && ["lobby", "preparing", "elsewhere", "over", "failed"].includes(game.dataset.state);

function play() {
  game.dataset.state = "playing";
  find("panel").hidden = true;
  find("hud").hidden = false;
  find("touch").hidden = !matchMedia("(pointer: coarse)").matches;
  controls.enabled = true;
  if (hasMouse && !document.pointerLockElement) hud.notice("Click the picture to look around with the mouse", 4000);
}

function showPanel(state, title, words, button = "", { keys = false } = {}) {
  game.dataset.state = state;
  controls.enabled = false;
  controls.release();
  // Browsers give the mouse on a click only, so the one on Play keeps it while the map is made.
  if (document.pointerLockElement && state !== "preparing") document.exitPointerLock();
  find("title").textContent = title;
  find("words").textContent = words;
  find("go").textContent = button;
  find("go").hidden = !button;
  find("keys").hidden = !keys || matchMedia("(pointer: coarse)").matches;
  find("result").hidden = find("record").hidden = true;
  find("touch").hidden = true;
  find("lobby").hidden = !showsPeople();
  find("panel").hidden = false;
  find("hud").hidden = state !== "paused";
}

function headline({ ending, time, rows }) {
  const seconds = `${time.toFixed(1)} s`;
  const first = rows[0].seat === table.seat;
  if (table.track === "navigation" || table.track === "capture") {
    if (ending !== "goal") return "Time is up";
    return rows.length > 1 && !first ? `${rows[0].name} was faster` : `You reached the target in ${seconds}`;
  }
  if (rows.length === 1) return `You have ${rows[0].values[0]} supplies after ${seconds}`;
  const place = 1 + rows.findIndex(({ seat }) => seat === table.seat);
  return first ? "You won" : `You are number ${place} of ${rows.length}`;
}

function showEnd(message) {
  showPanel("over", headline(message), `${message.ending === "time_up" ? "The time is up." : "The match is over."}${isHost() ? "" : " The host starts the next one."}`,
    startButton("Play again"));
  fillTable(find("result"), message.metrics.map(({ title, unit }) => (unit ? `${title} (${unit})` : title)), message.rows, table.seat);
  find("record").querySelector("code").textContent = message.record ?? "";
  find("record").querySelector("pre").textContent = message.commands?.join("\n") ?? "";
  find("result").hidden = false;
  find("record").hidden = !message.record; // where it lies is the host's business
  find("panel").scrollTop = 0;
  find("go").focus({ preventScroll: true });
  sounds.playEnd();
}

async function showPicture(head, blob) {
  const image = await createImageBitmap(blob);
  canvas.drawImage(image, 0, 0);
  image.close();
  connection.send({ kind: "seen", picture: head.picture });
  measure(head.input);
  hud.show(head);
  sounds.play(head);
}

function measure(input) {
  const now = performance.now();
  for (const [sent, when] of inputAt) {
    if (sent > input) break;
    if (sent === input) delays.push(now - when);
    inputAt.delete(sent);
  }
  delays = delays.slice(-KEPT);
  pictures = [...pictures.filter((when) => now - when < 1000), now];
  const middle = delays.length ? [...delays].sort((a, b) => a - b)[delays.length >> 1] : null;
  hud.showDelay(middle, pictures.length);
}

// Send that nothing is held.
function letGo() {
  controls.release();
  number += 1;
  lastSent = "";
  connection.send({ kind: "input", number, ...controls.take(0) });
}

// Send what the person does, at each frame of the display; what is merely held is not repeated.
function sendInput(now) {
  requestAnimationFrame(sendInput);
  const input = controls.take(Math.min(0.1, (now - lastInput) / 1000));
  lastInput = now;
  const text = JSON.stringify(input);
  if (game.dataset.state !== "playing" || (text === lastSent && !input.turn && !input.look)) return;
  lastSent = text;
  number += 1;
  inputAt.set(number, performance.now());
  connection.send({ kind: "input", number, ...input });
}
requestAnimationFrame(sendInput);

find("go").addEventListener("click", () => {
  sounds.unlock();
  controls.lock();
  if (game.dataset.state === "closed") {
    showPanel("connecting", "Wildscav", "Connecting …");
    connection.open();
  } else {
    connection.send(game.dataset.state === "paused" ? { kind: "pause", paused: false } : { kind: "start" });
  }
});
find("picture").addEventListener("click", () => {
  if (controls.enabled && !controls.locked) controls.lock();
});
document.addEventListener("pointerlockchange", () => {
  if (!document.pointerLockElement) askToPause();
});
document.addEventListener("visibilitychange", () => {
  if (!document.hidden) return;
  if (game.dataset.state === "playing") letGo(); // a hidden page draws nothing, and so sends nothing
  askToPause();
});
addEventListener("keydown", (event) => {
  if (event.target instanceof HTMLInputElement) return;
  if (event.code === "KeyM") sounds.on = !sounds.on;
  if (event.code === "Escape") askToPause();
});

function askToPause() {
  if (game.dataset.state === "playing" && table.may_pause) connection.send({ kind: "pause", paused: true });
}
