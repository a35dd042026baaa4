// A player in an element of a page: loads its match, says how that goes, and asks for more while it is being played.

import { Course } from "../data/course";
import type { Trails } from "../data/trails";
import type { StageMaker } from "../stage";
import { readMoment } from "./address";
import { Clock } from "./clock";
import { make } from "./dom";
import { POLL, pause, RETRY, type Source, sourceOf } from "./loading";
import { Player } from "./player";

const PATIENCE = 10_000; // ms for which a match waits for its map

const players: Player[] = [];
const groups = new Map<string, Clock>();

// The player to which the address of the page and keys pressed nowhere belong.
const first = () => players.find(({ root }) => root.isConnected);

// Fill an element with the player of its match. It never fails: what goes wrong is said in the element.
export async function show(root: HTMLElement, makers: StageMaker[]): Promise<void> {
  const message = make("p", {
    className: "player-message",
    role: "status",
    textContent: "The match is loading …",
  });
  const tell = (text: string) => {
    message.textContent = text;
  };
  root.classList.add("player");
  root.replaceChildren(message);
  const source = sourceOf(root);
  try {
    const map = source.map((text) => players.find((each) => each.root === root)?.screen.say(text));
    map.catch(() => {}); // is handled below, but perhaps later than the browser complains
    const trails = await firstTrails(source, tell);
    const player = enter(root, new Course(trails, namesOf(root)), makers);
    const shown = showMap(player, map);
    await Promise.race([shown, pause(PATIENCE)]);
    player.start(first() === player ? readMoment(location.hash) : null);
    if ("live" in root.dataset) await watch(player, source);
    await shown;
  } catch (error) {
    console.warn(error);
    tell(`The match cannot be shown: ${(error as Error).message}. `);
    message.append(
      make("button", { type: "button", textContent: "Try again", onclick: () => show(root, makers) }),
    );
    root.replaceChildren(message);
  }
}

// The document of a match, when it has begun.
async function firstTrails(source: Source, tell: (text: string) => void): Promise<Trails> {
  for (;;) {
    const trails = await source.trails(tell);
    if (trails.samples.frames.length) return trails;
    if (trails.over) throw new Error("nothing of it was recorded");
    tell("The match has not begun yet …");
    await pause(RETRY);
  }
}

function enter(root: HTMLElement, course: Course, makers: StageMaker[]): Player {
  forgetRemoved();
  const clock = clockOf(root.dataset.sync);
  clock.isOpen ||= "live" in root.dataset && !course.trails.over;
  const player = new Player(root, course, clock, makers, () => first() === player);
  players.push(player);
  return player;
}

// Players whose elements have left the page draw no more, and let go of what they hold.
function forgetRemoved(): void {
  for (const player of players.filter(({ root }) => !root.isConnected)) {
    player.dispose();
    players.splice(players.indexOf(player), 1);
  }
}

// Players of one group share a clock.
function clockOf(group: string | undefined): Clock {
  if (!group) return new Clock();
  const clock = groups.get(group) ?? new Clock();
  groups.set(group, clock);
  return clock;
}

async function showMap(player: Player, map: ReturnType<Source["map"]>): Promise<void> {
  player.screen.say("The map is loading …");
  try {
    player.showMap(await map);
  } catch (error) {
    player.screen.say(`The map cannot be shown: ${(error as Error).message}.`);
  }
}

function namesOf(root: HTMLElement): Record<number, string> {
  try {
    return JSON.parse(root.dataset.names ?? "{}");
  } catch {
    return {};
  }
}

// Ask for new samples until the match is over.
async function watch(player: Player, source: Source): Promise<void> {
  while (!player.course.trails.over && player.root.isConnected) {
    let wait = POLL;
    try {
      const next = await source.trails(() => {}, player.course.trails.cursor);
      player.extend(next);
      player.say(
        ...(next.over ? ["The match is over. ", make("a", { href: "", textContent: "See its result" })] : []),
      );
    } catch {
      player.say("The connection is lost; trying again …");
      wait = RETRY;
    }
    await pause(wait);
  }
}

window.addEventListener("hashchange", () => {
  const moment = readMoment(location.hash);
  if (moment) first()?.goTo(moment);
});
