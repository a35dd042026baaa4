// Colours of teams, measured: distances in Oklab, times 100, where 2 is a difference that one just notices. People who
// lack a kind of cones see what the matrices of Machado, Oliveira and Fernandes (2009) give.

import { expect, test } from "vitest";
import type { Color } from "../src/data/map";
import { asKnownTo, MATES, OTHERS } from "../src/play/teams";
import { seat } from "./matches";

const EYES: Record<string, number[][]> = {
  usual: [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ],
  protan: [
    [0.152286, 1.052583, -0.204868],
    [0.114503, 0.786281, 0.099216],
    [-0.003882, -0.048116, 1.051998],
  ],
  deutan: [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.01182, 0.04294, 0.968881],
  ],
  tritan: [
    [1.255528, -0.076749, -0.178779],
    [-0.078411, 0.930809, 0.147602],
    [0.004733, 0.691367, 0.3039],
  ],
};
// What the world is made of, as in rendering/palette.py.
const WORLD: Record<string, Color[]> = {
  ground: [
    [98, 146, 62],
    [154, 163, 84],
    [137, 128, 116],
    [222, 202, 150],
    [40, 92, 112],
  ],
  water: [[40, 130, 215]],
  walls: [
    [228, 214, 188],
    [206, 160, 122],
    [217, 190, 132],
    [188, 198, 202],
    [230, 226, 216],
    [190, 140, 116],
  ],
  roofs: [
    [166, 70, 52],
    [112, 74, 62],
    [88, 98, 116],
    [146, 92, 58],
    [120, 58, 54],
  ],
  plants: [
    [98, 70, 46],
    [58, 118, 50],
    [84, 138, 54],
    [44, 98, 58],
    [112, 144, 58],
    [92, 128, 52],
    [74, 120, 66],
    [118, 138, 62],
  ],
  things: [
    [186, 182, 174],
    [150, 116, 82],
    [196, 150, 96],
    [136, 134, 130],
    [170, 110, 70],
    [90, 200, 255],
  ],
};
const TEAMS = [MATES, ...OTHERS];

type Vector = number[];
const times = (matrix: number[][], vector: Vector): Vector =>
  matrix.map((row) => row.reduce((sum, factor, at) => sum + factor * vector[at], 0));

function seen(color: Color, eyes: string): Vector {
  const linear = color.map((value) =>
    value > 10 ? ((value / 255 + 0.055) / 1.055) ** 2.4 : value / 255 / 12.92,
  );
  const light = times(EYES[eyes], linear).map((value) => Math.min(1, Math.max(0, value)));
  const cones = times(
    [
      [0.4122214708, 0.5363325363, 0.0514459929],
      [0.2119034982, 0.6806995451, 0.1073969566],
      [0.0883024619, 0.2817188376, 0.6299787005],
    ],
    light,
  ).map(Math.cbrt);
  const lab = [
    [0.2104542553, 0.793617785, -0.0040720468],
    [1.9779984951, -2.428592205, 0.4505937099],
    [0.0259040371, 0.7827717662, -0.808675766],
  ];
  return times(lab, cones).map((value) => 100 * value);
}

const distance = (one: Color, other: Color, eyes: string) => {
  const [a, b] = [seen(one, eyes), seen(other, eyes)];
  return Math.hypot(...a.map((value, at) => value - b[at]));
};

test.each(Object.keys(EYES))("%s eyes tell all teams apart", (eyes) => {
  for (const [at, one] of TEAMS.entries())
    for (const other of TEAMS.slice(0, at)) expect(distance(one, other, eyes)).toBeGreaterThan(11.9);
});

test.each([
  ["usual", 14.5],
  ["protan", 5.5],
  ["deutan", 5.5],
  ["tritan", 5.5],
])("to %s eyes nothing in the world has the colour of a team", (eyes, least) => {
  for (const team of TEAMS)
    for (const color of Object.values(WORLD).flat())
      expect(distance(team, color, eyes)).toBeGreaterThan(least);
});

const body = [...Array(7)].map((_, at) => [at, at, at] as Color);
const seats = (teams: number[]) => teams.map((team, at) => ({ ...seat(at), team, colors: body }));

test("one's own team is blue, and each other team has a colour and a mark of its own", () => {
  const known = asKnownTo(1, seats([4, 0, 0, 2, 4]));
  expect(known.map(({ colors }) => colors[2])).toEqual([OTHERS[0], MATES, MATES, OTHERS[1], OTHERS[0]]);
  expect(known.map(({ mark }) => mark)).toEqual(["▲", "○", "○", "●", "▲"]);
  expect(known[0].colors.slice(4, 6)).toEqual([body[4], body[5]]); // visor and rifle
});

test("28 other teams differ in colour or mark", () => {
  const known = asKnownTo(0, seats([...Array(29).keys()]));
  expect(new Set(known.map(({ colors, mark }) => `${colors[2]} ${mark}`)).size).toBe(29);
});
