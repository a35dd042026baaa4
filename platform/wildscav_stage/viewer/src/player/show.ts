// A player in an element of a page: loads its match, says how that goes, and asks for more while it is being played.

import { Course } from "../data/course";
import type { GameMap } from "../data/map";
import type { Trails } from "../data/trails";
import type { StageMaker } from "../stage";
import { readMoment } from "./address";
import { Clock } from "./clock";
import { make } from "./dom";
import { POLL, pause, RETRY, Refusal, type Source, sourceOf } from "./loading";
import { Player } from "./player";

const PATIENCE = 10_000; // ms for which a match waits for its map

const players: Player[] = [];

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
  try {
    const map = source.map((text) => players.find((each) => each.root === root)?.screen.say(text));
    map.catch(() => {}); // is handled below, but perhaps later than the browser complains
    const trails = await firstTrails(source, tell);
    const lead = await leadOf(root);
    const player = enter(root, new Course(trails, namesOf(root)), makers, lead);
    const shown = showMap(player, source, map);
    await Promise.race([shown, pause(PATIENCE)]);
    if (!lead) player.start(first() === player ? readMoment(location.hash) : null);
    if ("live" in root.dataset) await watch(player, source);
    await shown;
  } catch (error) {
    console.warn(error);
    forget(root);
    tell(`The match cannot be shown: ${(error as Error).message}. `);
    message.append(again(() => show(root, makers)));
    root.replaceChildren(message);
  }
}

function again(onclick: () => void): HTMLButtonElement {
  return make("button", { type: "button", textContent: "Try again", onclick });
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

// Of an element with `data-with`: the player in the element before it, once it is there. They share time and views.
async function leadOf(root: HTMLElement): Promise<Player | null> {
  if (!("with" in root.dataset)) return null;
  for (;;) {
    const lead = players.find((player) => player.root === root.previousElementSibling);
    if (lead) return lead;
    await pause(POLL);
  }
}

function enter(root: HTMLElement, course: Course, makers: StageMaker[], lead: Player | null): Player {
  forget(root);
  const clock = lead?.clock ?? new Clock();
  if (!lead) clock.isOpen = "live" in root.dataset && !course.trails.over;
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

function namesOf(root: HTMLElement): Record<number, string> {
  try {
    return JSON.parse(root.dataset.names ?? "{}");
  } catch {
    return {};
  }
}

// Ask for new samples until the match is over, or the server tells no more.
async function watch(player: Player, source: Source): Promise<void> {
  let isLost = false;
  while (!player.course.trails.over && player.root.isConnected) {
    const { cursor } = player.course.trails;
    const next = await source.trails(() => {}, cursor).catch((error: Error) => error);
    if (next instanceof Refusal) return player.giveUp(`The match cannot be followed: ${next.message}.`);
    if (next instanceof Error) player.say("The connection is lost; trying again …");
    else player.extend(next);
    if (isLost && !(next instanceof Error)) player.say();
    isLost = next instanceof Error;
    await pause(isLost ? RETRY : POLL);
  }
  player.say("The match is over. ", make("a", { href: "", textContent: "See its result" }));
}

window.addEventListener("hashchange", () => {
  const moment = readMoment(location.hash);
  if (moment) first()?.goTo(moment);
});
