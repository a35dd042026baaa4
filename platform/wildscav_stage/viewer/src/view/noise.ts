// The engine's noise (rendering/shading/noise.py): a lattice of numbers that repeats, and clouds made of it.

export const PERIOD = 128;
const FACTORS = [374761393, 668265263, 1274126177];
const REACH = 10; // greatest coordinate of a cloud on the plane that they are drawn on
export const CLOUDS = 161; // numbers along a side of the clouds' map

// A pseudo-random number 0-255 for a point of the lattice.
export function grain(x: number, y: number): number {
  let mixed = (Math.imul(x, FACTORS[0]) + Math.imul(y, FACTORS[1])) | 0;
  mixed = Math.imul(mixed ^ (mixed >>> 13), FACTORS[2]);
  return (mixed ^ (mixed >>> 16)) >>> 24;
}

// The lattice, 0-255, row after row.
export function lattice(): Uint8Array<ArrayBuffer> {
  const values = new Uint8Array(PERIOD * PERIOD);
  for (let row = 0; row < PERIOD; row++)
    for (let column = 0; column < PERIOD; column++) values[row * PERIOD + column] = grain(column, row);
  return values;
}

// How much clouds cover, 0-255, from south-west to north-east.
export function clouds(): Uint8Array<ArrayBuffer> {
  const values = new Uint8Array(CLOUDS * CLOUDS);
  const step = (2 * REACH) / (CLOUDS - 1);
  for (let row = 0; row < CLOUDS; row++) {
    for (let column = 0; column < CLOUDS; column++) {
      const [x, z] = [column * step - REACH, row * step - REACH];
      const cover =
        0.56 * smooth(x, z) + 0.29 * smooth(2.1 * x + 9, 2.1 * z) + 0.15 * smooth(4.3 * x, 4.3 * z + 5);
      values[row * CLOUDS + column] = 255 * 0.75 * Math.min(1, Math.max(0, (cover - 0.5) * 3.2));
    }
  }
  return values;
}

// Smooth noise 0-1 over a plane.
function smooth(x: number, z: number): number {
  const [column, row] = [Math.floor(x), Math.floor(z)];
  const [east, north] = [eased(x - column), eased(z - row)];
  const south = mix(grain(column, row), grain(column + 1, row), east);
  return mix(south, mix(grain(column, row + 1), grain(column + 1, row + 1), east), north) / 255;
}

function eased(share: number): number {
  return share * share * (3 - 2 * share);
}

function mix(first: number, second: number, share: number): number {
  return first + (second - first) * share;
}
