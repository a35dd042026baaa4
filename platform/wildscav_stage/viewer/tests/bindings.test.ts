// Which key does what, and what a person is told when it changes.

import { expect, test } from "vitest";
import { Bindings, GAMEPAD } from "../src/play/bindings";

const bound = (text = "") => {
  const bindings = new Bindings();
  bindings.read(text);
  return bindings;
};

test("keys, mouse buttons and gamepad buttons do what is usual", () => {
  const bindings = bound();
  expect(["KeyW", "Mouse0", "KeyF", "Pad7", "KeyQ"].map((trigger) => bindings.actOf(trigger))).toEqual([
    ...["forward", "shoot", "shoot", "shoot"],
    undefined,
  ]);
  expect(bindings.keysOf("shoot")).toEqual(["left button", "F"]);
  expect(bindings.padButtons).toContainEqual([2, "reload"]);
});

test("a key that is given away is missed where it was", () => {
  const bindings = bound();
  expect(bindings.bind("reload", 1, "KeyF")).toBe("F did something else: shoot. ");
  expect(bindings.triggersOf("shoot")).toEqual(["Mouse0", "", "Pad7"]);
  expect(bindings.actOf("KeyF")).toBe("reload");
  expect(bindings.bind("jump", 0, "KeyW")).toBe(
    "W did something else: walk forward. Nothing is left for: walk forward.",
  );
});

test("a key moves within what it does", () => {
  const bindings = bound();
  expect(bindings.bind("shoot", 0, "KeyF")).toBe("");
  expect(bindings.triggersOf("shoot")).toEqual(["KeyF", "", "Pad7"]);
  expect(bindings.bind("shoot", 0, "KeyF")).toBe("");
  expect(bindings.keysOf("shoot")).toEqual(["F"]);
});

test.each<[number, string]>([
  [0, "ControlLeft"], // Ctrl + W closes the page
  [0, "Escape"], // it frees the mouse
  [0, "F5"],
  [0, "Pad3"],
  [GAMEPAD, "KeyW"],
])("in place %i, %s is refused", (place, trigger) => {
  const bindings = bound();
  expect(bindings.bind("jump", place, trigger)).toContain("cannot be used here");
  expect(bindings.triggersOf("jump")).toEqual(["Space", "", "Pad0"]);
});

test("what was kept is taken as far as it is right", () => {
  const usual = ["Space", "", "Pad0"];
  expect(bound('{"jump": ["KeyJ", "", ""]}').triggersOf("jump")).toEqual(["KeyJ", "", ""]);
  for (const text of ["no JSON", "null", '{"jump": 3}', '{"jump": ["KeyJ"]}', '{"jump": ["Escape", "", ""]}'])
    expect(bound(text).triggersOf("jump")).toEqual(usual);
});

test("all is as usual again after a reset", () => {
  const bindings = bound('{"jump": ["KeyJ", "", ""]}');
  bindings.reset();
  expect(bindings.triggersOf("jump")).toEqual(["Space", "", "Pad0"]);
  bindings.bind("jump", 0, "KeyJ");
  expect(bound().triggersOf("jump")).toEqual(["Space", "", "Pad0"]); // what is usual stays as it is
});

test("keys are called as people call them", () => {
  const bindings = bound();
  const names = ["KeyW", "Digit4", "Numpad7", "ShiftLeft", "ArrowUp", "Mouse2", "Pad15"];
  expect(names.map((trigger) => bindings.nameOf(trigger))).toEqual([
    ...["W", "4", "keypad 7", "left Shift", "↑", "right button", "right"],
  ]);
});
