// The page of a person who plays: it shows what the server tells, and sends what the person does.

import { type Act, Bindings } from "./play/bindings";
import { Connection, RENEWED, WHY_RENEWED } from "./play/connection";
import { Controls, type Input } from "./play/controls";
import { find } from "./play/dom";
import { fillTable, Hud, titlesOf } from "./play/hud";
import { KeyForm, listKeys } from "./play/key_form";
import { Lobby } from "./play/lobby";
import { Match } from "./play/match";
import type { Begin, Handlers, Message, Now, Over, Table } from "./play/messages";
import { METRICS } from "./play/practice";
import { showReplay } from "./play/replay";
import { eachPicture, hasWebGL, withMap } from "./play/scene";
import { settingsIn } from "./play/settings";
import { Sounds } from "./play/sounds";
import { Teacher } from "./play/teacher";
import { asKnownTo } from "./play/teams";

const REPLACED = 4001; // close code: the link was opened elsewhere
const HOST = 0; // the seat that starts matches
const NO_3D = "This browser cannot draw the match: it has no WebGL 2.";
const GOALS: Record<string, string> = {
  navigation: "Find the way to the target, as fast as you can. The compass points to it: ◆.",
  gathering: "Gather as many supplies as you can. The compass shows boxes nearby: ▪.",
  capture: "Find the hidden target.",
  battle: "Gather supplies, and fight for those that others carry.",
  royale: "Be the last who stands. Stay inside the safe zone.",
};
const RANGE =
  "Shoot at targets that stand, walk and strafe, 10 to 60 m away. They never shoot back, and you never run out of rounds.";
// States in which guests say that they are ready, and those in which it is shown who is here.
const VOTING = ["lobby", "over", "failed"];
const WAITING = [...VOTING, "preparing", "elsewhere"];

const game = find("game");
const settings = settingsIn(find("settings") as HTMLFormElement);
const buttons = document.querySelectorAll<HTMLElement>("#buttons button");
const bindings = new Bindings();
const controls = new Controls(find("picture"), find("stick"), buttons, settings, bindings, command);
const hud = new Hud(bindings);
const sounds = new Sounds(settings);
const isTouched = matchMedia("(pointer: coarse)").matches;
const teacher = new Teacher(bindings, isTouched);
const canDraw = hasWebGL();

let table!: Table; // what is played here
let begun: Begin | null = null; // the present match
let match: Match | null = null;
let waiting: [Now, number][] | null = null; // moments of a match whose map is being loaded, and when they came, ms
let isLoading = false; // whether the match waits until it can be shown
let names: string[] = []; // of the seats in the last match
let asked = 0; // pauses and their ends that the server has not answered
let isReady = false; // whether one wants the next match to start
let number = 0; // of the last input
let lastSent = "";

const connection = new Connection({
  receive: (message) => (handlers[message.kind] as ((message: Message) => void) | undefined)?.(message),
  lose: () => {
    const idle = "Your seat stands idle until you are back. ";
    const meanwhile = !table ? "" : table.may_pause ? "The match waits for you. " : idle;
    showPanel("lost", "Connection lost", `${meanwhile}Trying to connect again …`);
  },
  close: (code, reason) => {
    if (code === REPLACED) {
      const words = "You play on in the page that opened your link last.";
      return showPanel("closed", "Opened elsewhere", words, "Play here");
    }
    if (code === RENEWED) return showPanel("closed", "This link was replaced", WHY_RENEWED);
    const why = reason
      ? `The server closed the connection: ${reason}.`
      : "The game does not answer. It may have ended; if it was started anew, its links have changed.";
    showPanel("closed", "Not connected", why, "Try again");
  },
});
new KeyForm(find("bindings"), bindings, () => {
  listKeys(find("keys"), bindings);
  teacher.show();
});
const lobby = new Lobby(find("lobby"), (message) => connection.send(message));

const handlers: Handlers = {
  table: (message) => {
    table = message;
    number = asked = 0;
    lastSent = "";
    game.toggleAttribute("data-range", table.is_range);
    find("escape").textContent = table.may_pause ? "free the mouse, pause" : "free the mouse";
  },
  people: (message) => {
    lobby.update(message, table);
    isReady = message.people[table.seat as number].ready;
    if (canDraw && isVoting()) showStart(startButton(""));
    find("lobby").hidden = !showsPeople();
  },
  refused: ({ message }) => lobby.say(`${message[0].toUpperCase()}${message.slice(1)}.`),
  lobby: () => {
    game.toggleAttribute("data-weapon", ["battle", "royale"].includes(table.track));
    const hasSupplies = !["navigation", "capture"].includes(table.track) && !table.is_range;
    game.toggleAttribute("data-supplies", hasSupplies);
    const fingers = isTouched ? " Walk with the stick, and swipe over the picture to look around." : "";
    const waits = isHost()
      ? ""
      : " The host starts the match; without the host, it starts when all are ready.";
    const words = table.is_range ? RANGE : `${goal()}${fingers}${waits}`;
    const title = `Wildscav: ${table.is_range ? "shooting range" : table.title}`;
    if (canDraw) showPanel("lobby", title, words, startButton("Play"), true);
    else showPanel("lobby", title, `${NO_3D} Open the link in another one.`);
  },
  preparing: () => showPanel("preparing", "Making the map …", "This takes a few seconds."),
  countdown: ({ seconds }) => {
    showPanel("countdown", `The match starts in ${seconds} …`, goal(), "", true);
    sounds.tick();
  },
  elsewhere: () => {
    const words = "It began without you. You take part in the next one, and can watch until then.";
    showPanel("elsewhere", "A match is being played", words, "Watch");
  },
  begin: (told) => {
    const message = { ...told, seats: asKnownTo(table.seat as number, told.seats) };
    begun = message;
    asked = 0;
    lastSent = "";
    endMatch();
    hud.begin(message, table.seat);
    const { weapon } = message;
    const supplies = message.supplies && !table.is_range;
    teacher.begin({ track: table.track, weapon, supplies });
    names = message.seats.map(({ name }) => name);
    game.toggleAttribute("data-weapon", weapon);
    game.toggleAttribute("data-supplies", supplies);
    isLoading = table.may_pause && !message.paused;
    if (isLoading) pause(true);
    else if (message.paused) showPause(true);
    else play();
  },
  now: (moment) => {
    if (match) match.take(moment);
    else if (waiting) waiting.push([moment, performance.now()]);
    else if (begun) beginMatch(begun, moment);
  },
  paused: ({ paused }) => {
    asked = Math.max(0, asked - 1);
    match?.pause(paused);
    // What was asked for later counts.
    if (!asked && !isLoading && game.dataset.state !== "failed") showPause(paused);
  },
  scores: ({ rows }) => begun && !table.is_range && hud.showScores(rows),
  failed: ({ message }) => {
    begun = null;
    endMatch();
    showPanel("failed", "The match was not played", message, startButton("Try again"));
  },
  over: showEnd,
};

const goal = () => GOALS[table.track] ?? "";
const isHost = () => table.seat === HOST;
const startButton = (text: string) =>
  isHost() ? text : isReady ? "Ready: wait for the others" : "I am ready";
// A match that cannot be shown is still being played.
const isVoting = () => !isHost() && !begun && VOTING.includes(game.dataset.state as string);
const isPlaying = () => game.dataset.state === "playing";
const showsPeople = () =>
  Boolean(table) && (table.people > 1 || isHost()) && WAITING.includes(game.dataset.state as string);

// Begin with the first moment; those that come until the map is there wait for it.
function beginMatch(begin: Begin, first: Now): void {
  const own: [Now, number][] = [[first, performance.now()]];
  waiting = own;
  withMap(
    begin.map,
    (map) => {
      if (waiting !== own) return;
      const lose = () => cannotShow("The browser stopped drawing in 3D.");
      match = new Match(begin, table, table.seat as number, map, settings, hud, sounds, lose);
      for (const [moment, came] of own) match.learn(moment, came);
      if (isLoading) pause(document.hidden);
      isLoading = false;
    },
    (why) => waiting === own && cannotShow(canDraw ? why : NO_3D),
  );
}

// The match goes on without a picture until the page is loaded anew.
function cannotShow(why: string): void {
  showPanel("failed", "The match cannot be shown", why, "Try again");
  if (table.may_pause) pause(false);
}

function pause(paused: boolean): void {
  asked += 1;
  connection.send({ kind: "pause", paused });
}

function endMatch(): void {
  match?.dispose();
  match = waiting = null;
}

function play(): void {
  game.dataset.state = "playing";
  find("panel").hidden = true;
  find("hud").hidden = false;
  find("touch").hidden = !isTouched;
  controls.enabled = true;
  if (!isTouched && !document.pointerLockElement)
    hud.notice("Click the picture to look around with the mouse", 4000);
}

function showPause(paused: boolean): void {
  if (paused) {
    showPanel("paused", "Paused", "The match waits for you.", "Go on", true);
    find("go").focus({ preventScroll: true });
  } else play();
}

function showPanel(state: string, title: string, words: string, button = "", keys = false): void {
  game.dataset.state = state;
  controls.enabled = false;
  controls.release();
  // Browsers give the mouse on a click only, so the one on Play keeps it while the map is made.
  if (document.pointerLockElement && state !== "preparing") document.exitPointerLock();
  find("title").textContent = title;
  find("words").textContent = words;
  showStart(button);
  find("keys").hidden = !keys || isTouched;
  find("settings").hidden = !keys;
  find("bindings").hidden = !keys || isTouched;
  find("teach").hidden = !keys || !teacher.hasTaught;
  find("result").hidden = find("record").hidden = find("replay").hidden = true;
  find("touch").hidden = true;
  find("lobby").hidden = !showsPeople();
  find("panel").hidden = false;
  find("hud").hidden = state !== "paused";
}

function showStart(button: string): void {
  find("go").textContent = button;
  find("go").hidden = !button;
}

function headline({ ending, time, rows, played }: Over): string {
  if (!played.includes(table.seat as number)) return "The match is over";
  const first = rows[0].seat === table.seat;
  if (table.track === "navigation" || table.track === "capture") {
    if (ending !== "goal") return "Time is up";
    const isBeaten = rows.length > 1 && !first;
    return isBeaten ? `${rows[0].name} was faster` : `You reached the target in ${time.toFixed(1)} s`;
  }
  if (rows.length === 1) return `You have ${rows[0].values[0]} supplies after ${time.toFixed(1)} s`;
  const place = 1 + rows.findIndex(({ seat }) => seat === table.seat);
  return first ? "You won" : `You are number ${place} of ${rows.length}`;
}

function showEnd(message: Over): void {
  const practice = table.is_range ? match?.practice : undefined;
  begun = null;
  endMatch();
  const ending = message.ending === "time_up" ? "The time is up." : "The match is over.";
  const waits = isHost()
    ? ""
    : " The host starts the next one; without the host, it starts when all are ready.";
  const title = practice?.summary ?? (table.is_range ? "The practice is over" : headline(message));
  showPanel("over", title, `${ending}${waits}`, message.next && startButton(message.next));
  const rows = practice?.rows(names) ?? message.rows;
  const own = message.played.includes(table.seat as number) ? table.seat : null; // a robot may have had it
  fillTable(find("result"), titlesOf(practice ? METRICS : message.metrics), rows, own);
  find("record code").textContent = message.record ?? "";
  find("record pre").textContent = message.commands?.join("\n") ?? "";
  find("result").hidden = false;
  showReplay(message);
  find("record").hidden = !message.record; // where it lies is the host's business
  find("panel").scrollTop = 0;
  find("go").focus({ preventScroll: true });
  sounds.end();
}

// Send what the person does; only steps and turns are repeated while they last.
function send(input: Input): void {
  const text = JSON.stringify(input);
  if (text === lastSent && !(input.turn || input.look || input.forward || input.right)) return;
  lastSent = text;
  number += 1;
  match?.send(number, input);
  connection.send({ kind: "input", number, ...input });
}

eachPicture((now, length) => {
  if (!isPlaying() && game.dataset.state !== "paused") return;
  const input = controls.take(Math.min(0.1, length / 1000), begun?.rules.turn_speed);
  if (isPlaying()) send(input);
  match?.draw(input, now, length);
  if (match?.own && isPlaying())
    teacher.watch(input, match.own, match.spot, match.targetDistance, now, length / 1000);
});

find("go").addEventListener("click", () => {
  const { state } = game.dataset;
  sounds.unlock();
  if (state === "elsewhere") return location.assign(`../watch/${location.pathname.split("/").pop()}`);
  if (isVoting()) return connection.send({ kind: "ready", ready: !isReady });
  controls.lock();
  if (game.dataset.state === "closed") {
    showPanel("connecting", "Wildscav", "Connecting …");
    connection.open();
  } else if (game.dataset.state === "paused") pause(false);
  else if (begun) location.reload();
  else connection.send({ kind: "start" });
});
find("picture").addEventListener("click", () => {
  if (controls.enabled && !controls.locked) controls.lock();
});
document.addEventListener("pointerlockchange", () => {
  if (!document.pointerLockElement) askToPause();
});
document.addEventListener("visibilitychange", () => {
  if (!document.hidden) return;
  controls.release();
  if (isPlaying()) send(controls.take(0)); // a hidden page draws nothing, and so sends nothing
  askToPause();
});
addEventListener("keydown", (event) => {
  const { target } = event; // the whole document, too, where a program presses keys
  if (target instanceof Element && target.closest("input, select, textarea")) return;
  if (!controls.enabled && !event.repeat && bindings.actOf(event.code) === "sound") command("sound");
  if (event.code === "Escape") askToPause();
});

function command(act: Act): void {
  if (act === "sound") sounds.on = !sounds.on;
  if (act === "skip") teacher.skip();
}

function askToPause(): void {
  if (isPlaying() && table.may_pause) pause(true);
}
