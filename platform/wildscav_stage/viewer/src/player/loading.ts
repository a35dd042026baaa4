// Where a match comes from: a server, which may have to make its files first, or the page itself.

import { unzipped } from "../data/arrays";
import { type GameMap, readMap } from "../data/map";
import { type Note, readNotes } from "../data/notes";
import { EventReader, type StreamEvent } from "../data/stream";
import { readTrails, type Trails } from "../data/trails";

const PAUSE = 1000; // ms between two questions about a file that is being made
const SILENCE = 25_000; // ms after which a stream is taken for lost; the server says every 10 s that it lives
export const RETRY = 2000; // ms after a question that was not answered
const REFUSALS = [401, 403, 404, 410]; // answers to which waiting changes nothing

export type Say = (text: string) => void;

export interface Source {
  map(say: Say): Promise<GameMap>;
  trails(say: Say): Promise<Trails>;
  // Hear of a match that is being played, after the event of an id, until the connection ends.
  follow(hear: (events: StreamEvent[]) => void, last: string, signal: AbortSignal): Promise<void>;
  notes(): Promise<Note[]>; // none where no page has any
}

// What a server does not tell, however often it is asked.
export class Refusal extends Error {}

export const pause = (time: number) => new Promise<void>((resolve) => setTimeout(resolve, time));

// The source that the attributes of an element name.
export function sourceOf(element: HTMLElement): Source {
  const { map, trails, notes, live, embedded } = element.dataset;
  return {
    map: async (say) => readMap(await (embedded === undefined ? fetched(map, say) : embeddedContent("map"))),
    trails: async (say) => {
      const content = await (embedded === undefined ? fetched(trails, say) : embeddedContent("trails"));
      return readTrails(await new Response(content).text());
    },
    notes: async () => {
      if (!notes && embedded === undefined) return [];
      const content = await (embedded === undefined ? fetched(notes, () => {}) : embeddedContent("notes"));
      return readNotes(await new Response(content).text());
    },
    follow: (hear, last, signal) => follow(live, hear, last, signal),
  };
}

// Fetch a file; while it is being made (202), wait and say so.
async function fetched(address: string | undefined, say: Say): Promise<ReadableStream<Uint8Array>> {
  for (;;) {
    const answer = await answered(address);
    if (answer.status !== 202 && answer.body) return await unzipped(answer.body);
    const told = await answer.json().catch(() => ({}));
    if (told.state === "failed") throw new Error(told.error ?? told.detail);
    say(told.error ?? told.detail ?? "It is being prepared …");
    await pause(PAUSE);
  }
}

async function follow(
  address: string | undefined,
  hear: (events: StreamEvent[]) => void,
  last: string,
  signal: AbortSignal,
): Promise<void> {
  const headers: HeadersInit = last ? { "Last-Event-ID": last } : {};
  const answer = await answered(address, { headers, signal, cache: "no-store" });
  const reader = answer.body?.getReader();
  const events = new EventReader();
  let silence = 0;
  try {
    for (;;) {
      silence = setTimeout(() => reader?.cancel(), SILENCE) as unknown as number;
      const read = await reader?.read();
      clearTimeout(silence);
      if (!read?.value) return;
      hear(events.read(read.value));
    }
  } finally {
    clearTimeout(silence);
    reader?.cancel().catch(() => {});
  }
}

async function answered(address: string | undefined, request: RequestInit = {}): Promise<Response> {
  if (!address) throw new Error("the page does not say where it is");
  const answer = await fetch(address, request).catch(() => {
    throw new Error("the server cannot be reached");
  });
  if (answer.ok) return answer;
  const told = await answer.json().catch(() => ({}));
  const reason = told.error ?? told.detail;
  const Kind = REFUSALS.includes(answer.status) ? Refusal : Error;
  throw new Kind(typeof reason === "string" ? reason : `the server answered ${answer.status}`);
}

// What a page that needs no server holds, as base64 of a file that is compressed with gzip.
async function embeddedContent(name: "map" | "trails" | "notes"): Promise<ReadableStream<Uint8Array>> {
  const text = document.getElementById(`wildscav-${name}`)?.textContent;
  if (!text) throw new Error("the page does not hold it");
  const letters = atob(text.replace(/\s/g, ""));
  const bytes = new Uint8Array(letters.length);
  for (let place = 0; place < letters.length; place++) bytes[place] = letters.charCodeAt(place);
  return await unzipped(new Blob([bytes]).stream());
}
