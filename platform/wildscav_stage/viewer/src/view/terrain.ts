// The ground as the game has it: a height for each place, and the normals of its corners.

import type { Ground } from "../data/map";

// The height of the ground in m. The diagonal of each cell runs from south-west to north-east.
export function heightAt(ground: Ground, x: number, z: number): number {
  const east = within((x - ground.corner[0]) / ground.cell, ground.columns - 1);
  const north = within((z - ground.corner[1]) / ground.cell, ground.rows - 1);
  const column = Math.min(ground.columns - 2, Math.floor(east));
  const row = Math.min(ground.rows - 2, Math.floor(north));
  const at = row * ground.columns + column;
  const { heights, columns } = ground;
  const [along, up] = [east - column, north - row];
  const southWest = heights[at];
  const northEast = heights[at + columns + 1];
  if (along >= up) {
    const southEast = heights[at + 1];
    return southWest + (southEast - southWest) * along + (northEast - southEast) * up;
  }
  const northWest = heights[at + columns];
  return southWest + (northEast - northWest) * along + (northWest - southWest) * up;
}

// The corners of the triangles of a cell whose south-western corner is given: counter-clockwise from above
// where x and z are plotted in a right-handed frame with y up, as in the engine's meshes.
export function trianglesOf(southWest: number, columns: number): number[] {
  const [southEast, northWest, northEast] = [southWest + 1, southWest + columns, southWest + columns + 1];
  return [southWest, northEast, southEast, southWest, northWest, northEast];
}

// Unit normals of all corners, three numbers each, from the differences of neighbouring heights.
export function normalsOf(ground: Ground): Float32Array {
  const { rows, columns, cell, heights } = ground;
  const normals = new Float32Array(3 * rows * columns);
  for (let row = 0; row < rows; row++) {
    const [south, north] = [Math.max(0, row - 1), Math.min(rows - 1, row + 1)];
    for (let column = 0; column < columns; column++) {
      const [west, east] = [Math.max(0, column - 1), Math.min(columns - 1, column + 1)];
      const at = row * columns + column;
      const toEast = (heights[row * columns + east] - heights[row * columns + west]) / (cell * (east - west));
      const toNorth =
        (heights[north * columns + column] - heights[south * columns + column]) / (cell * (north - south));
      const up = 1 / Math.sqrt(1 + toEast * toEast + toNorth * toNorth);
      normals[3 * at] = -toEast * up;
      normals[3 * at + 1] = up;
      normals[3 * at + 2] = -toNorth * up;
    }
  }
  return normals;
}

function within(value: number, most: number): number {
  return Math.min(most, Math.max(0, value));
}
