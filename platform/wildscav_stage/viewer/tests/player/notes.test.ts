import { expect, test } from "vitest";
import { type Note, readNotes } from "../../src/data/notes";
import { saidAt } from "../../src/player/caption";
import { course, event } from "../matches";

const note = (frame: number, seat: number, more: Partial<Note>): Note => {
  return { frame, seat, text: "", name: "", points: [], value: null, ...more };
};

test("what agents say is listed among the events, in the order of time", () => {
  const match = course([[0, 0, 0]], [event(50, "pick_up", 0)]);
  match.addNotes([note(20, 0, { text: "Where?" }), note(60, 0, { text: "There." })]);
  expect(match.events.map(({ kind }) => kind)).toEqual(["note", "pick_up", "note"]);
});

test("a mark stays until the next of its name, and one without points removes it", () => {
  const match = course([[0], [0]]);
  const [here, there] = [[[0, 0, 0]], [[100, 0, 100]]] as Note["points"][];
  match.addNotes([
    note(10, 0, { name: "goal", points: here }),
    note(15, 1, { name: "goal", points: there }),
    note(20, 0, { name: "goal", points: there }),
    note(30, 0, { name: "goal" }),
    note(40, 0, { name: "fear", value: 0.5 }),
  ]);
  const shown = (frame: number) => match.marksAt(frame).map(({ seat, points }) => [seat, points]);
  expect(shown(9)).toEqual([]);
  expect(shown(15)).toEqual([
    [0, here],
    [1, there],
  ]);
  expect(shown(20)).toContainEqual([0, there]);
  expect(shown(40)).toEqual([[1, there]]);
});

test("a caption shows the words of whom one follows, long enough to read them", () => {
  const match = course([
    [0, 0, 0, 0, 0, 0],
    [0, 0, 0, 0, 0, 0],
  ]);
  match.addNotes([note(50, 0, { text: "Hello" }), note(60, 1, { text: "x".repeat(1000) })]);
  expect(saidAt(match, 49, 0)).toBeNull();
  expect(saidAt(match, 60, 0)?.words).toBe("Hello");
  expect(saidAt(match, 60, null)?.seat).toBe(1);
  expect(saidAt(match, 60, 1)?.words).toHaveLength(301);
  expect(saidAt(match, 50 + 50 * 4, 0)).toBeNull();
});

test("notes of another version are refused in words", () => {
  expect(() => readNotes('{"version": 2, "notes": []}')).toThrow("version 1, not 2");
});
