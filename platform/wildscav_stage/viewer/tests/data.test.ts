import { describe, expect, test } from "vitest";
import { openPacked, unzipped } from "../src/data/arrays";
import { Course } from "../src/data/course";
import { readMap } from "../src/data/map";
import { readTrails, type Trails } from "../src/data/trails";
import { event, trails } from "./matches";

const streamed = (...pieces: BlobPart[]) => new Blob(pieces).stream();
const bytesOf = async (stream: ReadableStream) => new Uint8Array(await new Response(stream).arrayBuffer());

function packed(header: object, content: Uint8Array): ArrayBuffer {
  let text = JSON.stringify(header);
  text += " ".repeat((4 - (text.length % 4)) % 4);
  const file = new Uint8Array(4 + text.length + content.length);
  new DataView(file.buffer).setUint32(0, text.length, true);
  file.set(new TextEncoder().encode(text), 4);
  file.set(content, 4 + text.length);
  return file.buffer;
}

function match(changes: Partial<Trails> = {}): Trails {
  const one = {
    x: [100, 100, 5000],
    z: [0, 0, 0],
    height: [200, 0, 0],
    yaw: [350, 20, 0],
    pitch: [0, 0, 0],
    health: [100, -40, -60],
    supplies: [0, 3, 0],
  };
  return trails([[0]], [], { samples: { frames: [0, 10, 5], seats: [one] }, ...changes });
}

describe("packed arrays", () => {
  test("each plane is a sum of differences, and bytes wrap around", async () => {
    const arrays = [{ name: "colors", type: "uint8", shape: [3, 2], at: 0 }];
    const file = await openPacked(streamed(packed({ arrays }, Uint8Array.of(250, 10, 1, 5, 255, 0))));
    await file.has("colors");
    expect(file.planes("colors").map((plane) => [...plane])).toEqual([
      [250, 4, 5],
      [5, 4, 4],
    ]);
    expect(() => file.planes("heights")).toThrow('no array "heights"');
  });

  test("content is unzipped unless the browser has done so", async () => {
    const content = Uint8Array.of(1, 2, 3);
    const zipped = streamed(content).pipeThrough(new CompressionStream("gzip"));
    expect(await bytesOf(await unzipped(zipped))).toEqual(content);
    expect(await bytesOf(await unzipped(streamed(content)))).toEqual(content);
  });

  test("an array is read before those that come later", async () => {
    const arrays = [0, 1].map((at) => ({ name: `part ${at}`, type: "uint8", shape: [1, 1], at }));
    const whole = new Uint8Array(packed({ arrays }, Uint8Array.of(7, 8)));
    let send = (_: number, __?: number) => {};
    const stream = new ReadableStream<Uint8Array>({
      start: (control) => {
        send = (from, to) => control.enqueue(whole.slice(from, to));
      },
    });
    send(0, 3);
    send(3, whole.length - 1);
    const file = await openPacked(stream);
    await file.has("part 0");
    expect([...file.planes("part 0")[0]]).toEqual([7]);
    const rest = file.has("part 1");
    send(whole.length - 1);
    await rest;
    expect([...file.planes("part 1")[0]]).toEqual([8]);
  });

  test("a file that is cut off says so", async () => {
    const arrays = [{ name: "colors", type: "uint8", shape: [3, 2], at: 0 }];
    const file = await openPacked(streamed(packed({ arrays }, Uint8Array.of(1))));
    await expect(file.has("colors")).rejects.toThrow("ends too early");
  });
});

test("a file is read to its end, since a browser keeps no other", async () => {
  let [isSent, isAtEnd] = [false, false];
  const source = {
    pull(to: ReadableStreamDefaultController<Uint8Array>) {
      if (isSent) {
        isAtEnd = true;
        to.close();
      } else to.enqueue(new Uint8Array(packed({ arrays: [] }, new Uint8Array(4))));
      isSent = true;
    },
  };
  const file = await openPacked(new ReadableStream(source, { highWaterMark: 0 }));
  expect(isAtEnd).toBe(false);
  await file.end();
  expect(isAtEnd).toBe(true);
});

describe("files of other versions are refused", () => {
  test("maps", async () => {
    const file = packed({ format: "wildscav-map", version: 99, arrays: [] }, new Uint8Array());
    await expect(readMap(streamed(file))).rejects.toThrow("maps of version 2, not wildscav-map 99");
  });

  test("matches", () => {
    expect(() => readTrails('{"version": 1}')).toThrow("matches of version 3, not 1");
  });
});

describe("the course of a match", () => {
  const course = new Course(match(), { 0: "shown" });

  test("places and angles are interpolated, in metres and degrees; health is not", () => {
    expect(course.at(0, 5)).toEqual({ x: 1.5, y: 2, z: 0, yaw: 360, pitch: 0, health: 100, supplies: 0 });
    expect(course.seats[0].name).toBe("shown");
  });

  test("nobody slides over the map to where they come back", () => {
    expect(course.at(0, 14).x).toBe(2);
    expect(course.at(0, 15)).toMatchObject({ x: 52, health: 0 });
  });

  test("samples far apart in time are far apart in place", () => {
    const { seats } = match().samples;
    const slow = new Course(match({ samples: { frames: [0, 10, 500], seats } }));
    expect(slow.at(0, 260).x).toBe(27);
    expect([1, 2].map((sample) => [slow.leaps(sample, 0), course.leaps(sample, 0)])).toEqual([
      [false, false],
      [false, true],
    ]);
  });

  test("a match may be very long", () => {
    const events = Array(300_000).fill(event(1, "hit"));
    expect(new Course(match({ events })).events.length).toBe(300_000);
  });

  test("after the last sample nothing changes", () => {
    expect(course.at(0, 1000)).toEqual(course.at(0, 15));
  });

  test("news are added, and a match that is played again begins anew", () => {
    const live = new Course(match({ over: false }));
    const one = { x: [0], z: [0], height: [0], yaw: [0], pitch: [0], health: [9], supplies: [4] };
    live.extend({ ...match({ samples: { frames: [25], seats: [one] } }), taken: [] });
    expect([live.frames, live.at(0, 25).health]).toEqual([[0, 10, 15, 25], 9]);
    live.begin(match({ samples: { frames: [5], seats: [one] } }));
    expect(live.frames).toEqual([5]);
  });

  test("news say which boxes have appeared, and which of all are gone", () => {
    const live = new Course(match({ over: false }));
    const box = { x: 0, z: 0, height: 0, dropped: false, quantity: 1, appears: 5, taken: null };
    const nothing = { ...match({ events: [] }), samples: { frames: [], seats: [] }, boxes: [] };
    live.extend({ ...nothing, boxes: [box, { ...box, appears: 7 }], taken: [] });
    live.extend({ ...nothing, taken: [[1, 9]] });
    expect([4, 5, 8, 9].map((frame) => live.boxesAt(frame).length)).toEqual([0, 1, 2, 1]);
  });

  test("boxes lie from their appearance until they are taken", () => {
    const box = { x: 0, z: 0, height: 0, dropped: false, quantity: 1, appears: 5, taken: 10 };
    const withBox = new Course(match({ boxes: [box] }));
    expect([4, 5, 9, 10].map((frame) => withBox.boxesAt(frame).length)).toEqual([0, 1, 1, 0]);
  });

  test("the zone moves at constant speed, and stays between phases", () => {
    const [before, after] = [
      { x: 0, z: 0, radius: 1000 },
      { x: 400, z: 0, radius: 200 },
    ];
    const zoned = new Course(match({ zone: [{ start: 10, end: 20, before, after }] }));
    expect([0, 15, 50].map((frame) => zoned.zoneAt(frame)?.now)).toEqual([
      { x: 0, z: 0, radius: 10 },
      { x: 2, z: 0, radius: 6 },
      { x: 4, z: 0, radius: 2 },
    ]);
    expect(course.zoneAt(0)).toBeNull();
  });
});
