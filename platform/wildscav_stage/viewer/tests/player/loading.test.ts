import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { Refusal, sourceOf } from "../../src/player/loading";
import { trails } from "../matches";

const asked: string[] = [];
const said: string[] = [];
const say = (text: string) => said.push(text);

// Answer questions one after the other, the last for good; undefined: nobody answers.
function answer(...answers: (Response | undefined)[]): void {
  vi.stubGlobal("fetch", async (address: string) => {
    asked.push(address);
    const next = answers.length > 1 ? answers.shift() : answers[0];
    if (!next) throw new TypeError("failed to fetch");
    return next.clone();
  });
}

const told = (content: unknown, status = 200) => new Response(JSON.stringify(content), { status });
const source = (dataset: Record<string, string>) => sourceOf({ dataset } as unknown as HTMLElement);

async function gzipped(text: string): Promise<ArrayBuffer> {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream("gzip"));
  return await new Response(stream).arrayBuffer();
}

beforeEach(() => {
  asked.length = said.length = 0;
  vi.useFakeTimers({ toFake: ["setTimeout"] });
  vi.stubGlobal("document", { baseURI: "https://example.org/matches/3", getElementById: () => null });
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("a document is read, compressed or not", async () => {
  const match = trails([[3]]);
  answer(told(match), new Response(await gzipped(JSON.stringify(match))));
  expect(await source({ trails: "/trails" }).trails(say)).toEqual(match);
  expect(await source({ trails: "/trails" }).trails(say)).toEqual(match);
});

test("what a match has seen since is asked for by its cursor", async () => {
  answer(told(trails([[3]])));
  await source({ trails: "/trails?v=2" }).trails(say, "90 a");
  expect(asked).toEqual(["https://example.org/trails?v=2&after=90+a"]);
});

test("a file that is still being made is waited for", async () => {
  const making = told({ state: "rendering", detail: "Soon …" }, 202);
  answer(making, making, told(trails([[3]])));
  const loading = source({ trails: "/trails" }).trails(say);
  await vi.advanceTimersByTimeAsync(5000);
  await loading;
  expect(asked.length).toBe(3);
  expect(said).toEqual(["Soon …", "Soon …"]);
});

test.each([
  ["a refusal", told({ detail: "its record is hidden" }, 403), "its record is hidden"],
  ["an error", told({ error: "it cannot be played again" }, 500), "it cannot be played again"],
  ["a failure", told({ state: "failed", detail: "the record is broken" }, 202), "the record is broken"],
  ["a page of a proxy", new Response("<h1>Bad gateway</h1>", { status: 502 }), "the server answered 502"],
  ["no answer", undefined, "the server cannot be reached"],
  ["another version", told({ version: 1 }), "this page reads matches of version 3, not 1"],
])("%s is said", async (_, response, message) => {
  answer(response);
  await expect(source({ trails: "/trails" }).trails(say)).rejects.toThrow(message);
});

test.each([
  [403, true],
  [404, true],
  [500, false],
  [502, false],
])("whether asking again may help is told: after %i", async (status, isRefusal) => {
  answer(told({}, status));
  const error = await source({ trails: "/trails" })
    .trails(say)
    .catch((each) => each);
  expect(error instanceof Refusal).toBe(isRefusal);
});

test("a page may hold its match", async () => {
  const match = trails([[3]]);
  const text = btoa(String.fromCharCode(...new Uint8Array(await gzipped(JSON.stringify(match)))));
  vi.stubGlobal("document", {
    getElementById: (id: string) => (id === "wildscav-trails" ? { textContent: `\n${text}\n` } : null),
  });
  expect(await source({ embedded: "" }).trails(say)).toEqual(match);
  await expect(source({ embedded: "" }).map(say)).rejects.toThrow("the page does not hold it");
});

test("a page that names no file is told so", async () => {
  await expect(source({}).trails(say)).rejects.toThrow("the page does not say where it is");
});
