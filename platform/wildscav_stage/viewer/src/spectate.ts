// The page of a spectator: a match from above, or with anybody.

import { createFlatStage } from "./flat";
import { Clock } from "./play/clock";
import { Connection, RENEWED, WHY_RENEWED } from "./play/connection";
import { find } from "./play/dom";
import { fillTable, Hud, titlesOf } from "./play/hud";
import { WatchedCourse } from "./play/live_course";
import { personRow } from "./play/lobby";
import type { All, Begin, Handlers, Message, Table } from "./play/messages";
import { showReplay } from "./play/replay";
import { eachPicture, hasWebGL, Picture, withMap } from "./play/scene";
import { make } from "./player/dom";
import type { StageMaker, View } from "./stage";
import { createStage } from "./world";

const SEATED = 4006; // close code: whoever waited for a seat has it now
const BEHIND = 7; // frames that everybody is shown in the past

const game = find("game");
const hud = new Hud();

let table!: Table; // what is played here
let begun: Begin | null = null; // the present match
let course: WatchedCourse | null = null;
let clock = new Clock(BEHIND);
let picture: Picture | null = null;
let latest: All | null = null;
let names: string[] = [];
let view: View = { kind: "above", seat: 0 };
let makeStage: StageMaker = hasWebGL() ? createStage : createFlatStage;

new Connection({
  receive: (message) => (handlers[message.kind] as ((message: Message) => void) | undefined)?.(message),
  lose: () => showPanel("lost", "Connection lost", "Trying to connect again …"),
  close: (code, reason) => {
    if (code === SEATED) return location.replace(`../play/${location.pathname.split("/").pop()}`);
    if (code === RENEWED) return showPanel("closed", "This link was replaced", WHY_RENEWED);
    const why = reason
      ? `The server closed the connection: ${reason}.`
      : "The game does not answer. It may have ended; if it was started anew, its links have changed.";
    showPanel("closed", "Not connected", why);
  },
});

const handlers: Handlers = {
  table: (message) => {
    table = message;
    names = message.names;
  },
  people: ({ people }) =>
    find("lobby ul").replaceChildren(...people.map((person) => personRow(person, null))),
  lobby: () => {
    const late = table.delay ? `, ${table.delay} s behind those who play` : "";
    const words = `You watch the match as soon as the host starts it${late}.`;
    showPanel("lobby", `Wildscav: ${table.track}`, words, true);
  },
  preparing: () => showPanel("preparing", "Making the map …", "The match starts in a few seconds.", true),
  countdown: ({ seconds }) => showPanel("countdown", `The match starts in ${seconds} …`, "", true),
  begin: (message) => {
    begun = message;
    endMatch();
    course = new WatchedCourse(message, table.track);
    names = message.seats.map(({ name }) => name);
    hud.begin(message, followed(), true);
    game.toggleAttribute("data-weapon", message.weapon);
    game.toggleAttribute("data-supplies", message.supplies);
    game.dataset.state = "watching";
    find("panel").hidden = true;
    find("hud").hidden = find("views").hidden = false;
    showViews();
    if (message.paused) hud.notice("Paused", 600_000);
  },
  all: (moment) => {
    if (!course || !begun) return;
    const isFirst = latest === null;
    latest = moment;
    course.learn(moment);
    clock.note(moment.frame, performance.now());
    hud.showTime(moment.frame);
    for (const [seat, by] of moment.deaths ?? []) hud.showDeath(seat, by);
    if (isFirst) show(begun, course);
  },
  paused: ({ paused }) => hud.notice(paused ? "Paused" : "", 600_000),
  scores: ({ rows }) => begun && hud.showScores(rows),
  failed: ({ message }) => showPanel("failed", "The match was not played", message, true),
  over: (message) => {
    begun = null;
    endMatch();
    const words = "You watch the next one as soon as the host starts it.";
    showPanel("over", "The match is over", words);
    fillTable(find("result"), titlesOf(message.metrics), message.rows, null);
    find("result").hidden = false;
    showReplay(message);
  },
};

function show(begin: Begin, own: WatchedCourse): void {
  withMap(
    begin.map,
    (map) => {
      if (begun !== begin || course !== own) return;
      const lose = () => {
        endPicture();
        makeStage = createFlatStage;
        find("picture").replaceWith(find("picture").cloneNode()); // one draws in 3D or flat
        show(begin, own);
      };
      picture = new Picture(map, own, makeStage, lose);
      const { kinds } = picture.stage;
      choose(kinds.includes(view.kind) ? view : { ...view, kind: kinds[0] });
      if (kinds.length === 1) hud.notice("The browser does not draw in 3D, so this is from above", 6000);
    },
    (why) => showPanel("failed", "The match cannot be shown", why),
  );
}

function endPicture(): void {
  picture?.dispose();
  picture = null;
}

function endMatch(): void {
  endPicture();
  course = latest = null;
  clock = new Clock(BEHIND);
}

function showPanel(state: string, title: string, words: string, people = false): void {
  game.dataset.state = state;
  find("title").textContent = title;
  find("words").textContent = words;
  find("lobby").hidden = !people;
  find("result").hidden = find("replay").hidden = true;
  find("hud").hidden = find("views").hidden = true;
  find("panel").hidden = false;
}

// The views that the browser can show, in the order of their buttons.
function views(): [string, View][] {
  const behind = view.kind === "behind" ? "behind" : "eyes";
  if (makeStage === createFlatStage) return [["From above", { kind: "above", seat: view.seat }]];
  return [
    ["From above", { kind: "above", seat: view.seat }],
    ...names.map((name, seat): [string, View] => [name, { kind: behind, seat }]),
    ["Fly", { kind: "free", seat: view.seat }],
  ];
}

const isSame = (one: View, other: View) =>
  one.kind === other.kind && (one.seat === other.seat || one.kind === "above" || one.kind === "free");

function showViews(): void {
  const all = views();
  find("views").replaceChildren(
    ...all.map(([title, own], index) => {
      const key = own.kind === "free" ? "F" : String(index);
      const shown = index < 10 || key === "F" ? [make("kbd", {}, key), title] : [title];
      const properties = { type: "button", onclick: () => choose(own), "aria-pressed": isSame(own, view) };
      return make("button", properties, ...shown);
    }),
    make("span", {}, table.delay ? `${table.delay} s behind` : ""),
  );
}

function choose(chosen: View): void {
  view = chosen;
  if (picture) picture.stage.view = view;
  game.dataset.view = followed() === null ? "overview" : view.kind;
  game.dataset.seat = String(followed() ?? "");
  if (begun) hud.begin(begun, followed(), true);
  showViews();
}

// The seat that is seen through or followed.
function followed(): number | null {
  return view.kind === "eyes" || view.kind === "behind" ? view.seat : null;
}

eachPicture((now) => {
  if (!picture || !course || game.dataset.state !== "watching") return;
  const frame = clock.frame(now);
  picture.draw(frame, now);
  const seat = followed();
  const own = seat === null ? null : course.rows.of(seat);
  if (own) hud.show(own, course.at(view.seat, frame), course);
  hud.showPace(latest?.ping ?? null, picture.rate, null);
});

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || game.dataset.state !== "watching") return;
  const all = views();
  const here = all.findIndex(([, own]) => isSame(own, view));
  const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  const numbered = all.filter(([, { kind }]) => kind !== "free");
  if (/^[0-9]$/.test(event.key) && numbered[Number(event.key)]) choose(numbered[Number(event.key)][1]);
  else if (event.code === "KeyF") choose(all[all.length - 1][1]);
  else if (event.code === "KeyV" && followed() !== null)
    choose({ ...view, kind: view.kind === "eyes" ? "behind" : "eyes" });
  else if (step && view.kind !== "free") choose(all[(here + all.length + step) % all.length][1]);
});
