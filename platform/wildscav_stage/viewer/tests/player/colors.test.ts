import { expect, test } from "vitest";
import { colorsOf } from "../../src/player/colors";
import { seat } from "../matches";

test.each<[[number, number, number], string, string]>([
  [[255, 254, 51], "rgb(255 254 51)", "#16181a"],
  [[60, 20, 110], "rgb(60 20 110)", "#ffffff"],
])("letters on %o can be read", (clothes, color, ink) => {
  expect(colorsOf({ ...seat(0), colors: [clothes, clothes, clothes] })).toEqual({ color, ink });
});

test("a body without parts has a colour too", () => {
  expect(colorsOf({ ...seat(0), colors: [] }).color).toBe("rgb(200 200 200)");
});
