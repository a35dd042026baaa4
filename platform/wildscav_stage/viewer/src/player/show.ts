// A player in an element of a page: loads its match, says how that goes, and follows it while it is being played.

import { Course } from "../data/course";
import type { GameMap } from "../data/map";
import type { News, Trails } from "../data/trails";
import type { StageMaker } from "../stage";
import { readMoment } from "./address";
import { Clock } from "./clock";
import { make } from "./dom";
import { Broadcast } from "./live";
import { pause, Refusal, type Source, sourceOf } from "./loading";
import { Player } from "./player";

const SOON = 100; // ms between two looks for the match beside which this one is shown
const PATIENCE = 10_000; // ms for which a match waits for its map

const players: Player[] = [];
const failed = new WeakSet<Element>(); // the elements of matches that cannot be shown

// The player to which the address of the page and keys pressed nowhere belong.
const first = () => players.find(({ root }) => root.isConnected);

// Fill an element with the player of its match. It never fails: what goes wrong is said in the element.
export async function show(root: HTMLElement, makers: StageMaker[]): Promise<void> {
  const message = make("p", { className: "player-message", role: "status" });
  const tell = (text: string) => message.replaceChildren(text);
  tell("The match is loading …");
  root.classList.add("player");
  root.replaceChildren(message);
  const source = sourceOf(root);
  failed.delete(root);
  try {
    const map = source.map((text) => players.find((each) => each.root === root)?.screen.say(text));
    map.catch(() => {}); // is handled below, but perhaps later than the browser complains
    const open = (lead: Player | null) => (trails: Trails, news: News[]) => {
      const course = new Course(trails, namesOf(root));
      for (const each of news) course.extend(each);
      const player = enter(root, course, makers, lead);
      const shown = showMap(player, source, map);
      Promise.race([shown, pause(PATIENCE)]).then(() => {
        if (!lead) player.start(first() === player ? readMoment(location.hash) : null);
      });
      showNotes(player, source);
      return player;
    };
    if ("live" in root.dataset) await watch(source, open(null), tell);
    else {
      const trails = await recorded(source, tell);
      open(await leadOf(root))(trails, []);
    }
  } catch (error) {
    console.warn(error);
    forget(root);
    failed.add(root);
    tell(`The match cannot be shown: ${(error as Error).message}. `);
    message.append(again(() => show(root, makers)));
    root.replaceChildren(message);
  }
}

function again(onclick: () => void): HTMLButtonElement {
  return make("button", { type: "button", textContent: "Try again", onclick });
}

async function recorded(source: Source, tell: (text: string) => void): Promise<Trails> {
  const trails = await source.trails(tell);
  if (!trails.samples.frames.length) throw new Error("nothing of it was recorded");
  return trails;
}

// Of an element with `data-with`: the player in the element before it, once it is there. They share time and views.
async function leadOf(root: HTMLElement): Promise<Player | null> {
  if (!("with" in root.dataset)) return null;
  while (root.isConnected) {
    const other = root.previousElementSibling as Element;
    const lead = players.find((player) => player.root === other);
    if (lead) return lead;
    if (failed.has(other)) throw new Error("the other one cannot be shown");
    await pause(SOON);
  }
  throw new Error("it has left the page");
}

function enter(root: HTMLElement, course: Course, makers: StageMaker[], lead: Player | null): Player {
  forget(root);
  const clock = lead?.clock ?? new Clock();
  if (!lead) clock.isOpen = !course.trails.over;
  const player = new Player(root, course, clock, makers, () => first() === player, lead);
  players.push(player);
  return player;
}

// Players of an element, and those whose elements have left the page, draw no more and let go of what they hold.
function forget(given: HTMLElement): void {
  for (const player of players.filter(({ root }) => root === given || !root.isConnected)) {
    player.dispose();
    players.splice(players.indexOf(player), 1);
  }
}

async function showMap(player: Player, source: Source, map: Promise<GameMap>): Promise<void> {
  const { screen } = player;
  screen.say("The map is loading …");
  try {
    const shown = await map;
    player.showMap(shown);
    await shown.whole;
  } catch (error) {
    const retry = () =>
      showMap(
        player,
        source,
        source.map((text) => screen.say(text)),
      );
    screen.say(make("span", {}, `The map cannot be shown: ${(error as Error).message}. `, again(retry)));
  }
}

// A match can be watched without what its agents said.
async function showNotes(player: Player, source: Source): Promise<void> {
  const notes = await source.notes().catch(console.warn);
  if (notes?.length) player.addNotes(notes);
}

function namesOf(root: HTMLElement): Record<number, string> {
  try {
    return JSON.parse(root.dataset.names ?? "{}");
  } catch {
    return {};
  }
}

// Show a match while it is being played, and its record when it is over, if that may be seen.
async function watch(
  source: Source,
  open: (trails: Trails, news: News[]) => Player,
  tell: (text: string) => void,
): Promise<void> {
  let player: Player | null = null;
  tell("The match has not begun yet …");
  const broadcast = new Broadcast(source, {
    begin: (trails, news) => {
      if (player) player.begin(trails, news);
      else player = open(trails, news);
    },
    extend: (news) => player?.extend(news),
    say: (text) => (player ? player.sayState(text) : text && tell(text)),
    isWanted: () => !player || player.root.isConnected,
  });
  let whyNot = await broadcast.follow().catch(refusal);
  const trails = await recorded(source, tell).catch((error: Error) => {
    whyNot ??= error;
  });
  const shown = player as Player | null;
  if (!trails && !shown) throw whyNot;
  if (!trails) return shown?.giveUp(`The match cannot be followed: ${whyNot?.message}.`);
  if (!shown) {
    open(trails, []);
    return;
  }
  shown.begin(trails, []);
  shown.say("The match is over. ", make("a", { href: "", textContent: "See its result" }));
}

function refusal(error: Error): Error {
  if (error instanceof Refusal) return error;
  throw error;
}

window.addEventListener("hashchange", () => {
  const moment = readMoment(location.hash);
  if (moment) first()?.goTo(moment);
});
