import { afterEach, beforeEach, expect, test, vi } from "vitest";
import type { StreamEvent } from "../../src/data/stream";
import { Lag } from "../../src/player/lag";
import { Broadcast } from "../../src/player/live";
import { Refusal, type Source } from "../../src/player/loading";
import { trails } from "../matches";

const heard: string[] = [];
const listener = {
  begin: (_: unknown, news: unknown[]) => heard.push(`begin ${news}`),
  extend: (news: unknown[]) => heard.push(`extend ${news}`),
  say: (text: string) => text && heard.push(text),
  isWanted: () => true,
};
const begin: StreamEvent = { id: "a-0", kind: "begin", data: JSON.stringify(trails([[0]])) };
const news = (number: number): StreamEvent => ({ id: `a-${number}`, kind: "news", data: String(number) });
const over: StreamEvent = { id: "", kind: "over", data: "" };

// A source whose connections bring parts of a stream, and then end.
function sourceOf(...connections: (StreamEvent[][] | Error)[]): { source: Source; lasts: string[] } {
  const lasts: string[] = [];
  const follow: Source["follow"] = async (hear, last) => {
    lasts.push(last);
    const parts = connections.shift() ?? [];
    if (parts instanceof Error) throw parts;
    parts.forEach(hear);
  };
  return { source: { follow } as Source, lasts };
}

beforeEach(() => {
  heard.length = 0;
  vi.useFakeTimers();
  vi.stubGlobal("document", Object.assign(new EventTarget(), { hidden: false }));
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("a lost connection goes on after the last event, and a match is shown from its first news on", async () => {
  const { source, lasts } = sourceOf([[begin], [news(1), news(2)]], new Error("too busy"), [[news(3), over]]);
  const following = new Broadcast(source, listener).follow();
  await vi.runAllTimersAsync();
  await following;
  expect(lasts).toEqual(["", "a-2", "a-2"]);
  expect(heard).toEqual([
    "begin 1,2",
    "The connection is lost; trying again …",
    "too busy; trying again …",
    "extend 3",
  ]);
});

test("a match that is played again begins anew, and one that may not be watched anymore says why", async () => {
  const hidden = { id: "", kind: "hidden", data: '"the boards are frozen"' };
  const { source } = sourceOf([[begin, news(1)], [news(2), begin, news(3)], [hidden]]);
  await expect(new Broadcast(source, listener).follow()).rejects.toThrow(
    new Refusal("the boards are frozen"),
  );
  expect(heard).toEqual(["begin 1", "begin 3"]);
});

test("a page that nobody sees asks for nothing until it is seen", async () => {
  const { source, lasts } = sourceOf([[begin, news(1), over]]);
  Object.assign(document, { hidden: true });
  const following = new Broadcast(source, listener).follow();
  await vi.advanceTimersByTimeAsync(60_000);
  expect(lasts).toEqual([]);
  Object.assign(document, { hidden: false });
  document.dispatchEvent(new Event("visibilitychange"));
  await following;
  expect(heard).toEqual(["begin 1"]);
});

test("a picture is behind by what news take to be sent, and by how long ago they came", () => {
  const lag = new Lag(0.6, 50);
  lag.note(500, 10_000); // what is known at first: ten seconds
  lag.note(525, 10_500);
  expect([450, 500, 520, 525].map((frame) => lag.of(frame, 11_000))).toEqual([2.6, 1.6, 1.1, 1.1]);
});
