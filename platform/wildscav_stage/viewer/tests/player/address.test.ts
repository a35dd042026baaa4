import { expect, test } from "vitest";
import { readMoment, writeMoment } from "../../src/player/address";

test("a link names a time, a view and a seat", () => {
  expect(readMoment("#t=73.2&view=behind&seat=3")).toEqual({ seconds: 73.2, view: "behind", seat: 3 });
  expect(readMoment("#view=above")).toEqual({ seconds: null, view: "above", seat: null });
});

test("what a link says wrongly counts as not said", () => {
  expect(readMoment("#t=-4&view=below&seat=1.5")).toBeNull();
  expect(readMoment("#t=1e9&seat=2")).toEqual({ seconds: null, view: null, seat: 2 });
  expect(readMoment("#t=Infinity")).toBeNull();
});

test("other places on a page are no moments", () => {
  expect(readMoment("")).toBeNull();
  expect(readMoment("#video")).toBeNull();
});

test("a written link is read again, with a seat where the view follows one", () => {
  const hash = writeMoment(12.3456, { kind: "eyes", seat: 0 }, true);
  expect(hash).toBe("#t=12.35&view=eyes&seat=0");
  expect(readMoment(hash)).toEqual({ seconds: 12.35, view: "eyes", seat: 0 });
  expect(writeMoment(0, { kind: "free", seat: 2 }, true)).toBe("#t=0&view=free");
  expect(writeMoment(0, { kind: "behind", seat: 2 }, false)).toBe("#t=0&view=behind");
});
