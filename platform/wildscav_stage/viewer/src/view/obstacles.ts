// What a camera must not look through: whether anything stands between two places.

import type { GameMap } from "../data/map";
import { endOf, planesOf } from "./polyhedra";
import { heightAt } from "./terrain";

const CELL = 8; // m along a side of a square of the map
const STEP = 0.5; // m between two places where a ray is compared with the ground
const OVER = 0.3; // m that it keeps over the ground
const PASSED = ["furniture", "stair"]; // kinds that a camera may be in

export class Obstacles {
  private readonly squares = new Map<number, number[]>();
  private readonly planes = new Map<number, Float32Array>();
  private readonly passed: Set<number>;
  private known = 0; // solids

  constructor(private readonly map: GameMap) {
    this.passed = new Set(PASSED.map((name) => map.kinds[name]));
  }

  // How far one can look from a place along a unit vector, up to so many m.
  free(x: number, y: number, z: number, way: [number, number, number], most: number): number {
    this.extend();
    let free = most;
    const seen = new Set<number>();
    for (let along = 0; along <= most; along += STEP) {
      const [atX, atY, atZ] = [x + way[0] * along, y + way[1] * along, z + way[2] * along];
      if (along > 0 && atY < heightAt(this.map.ground, atX, atZ) + OVER) return Math.min(free, along - STEP);
      const key = keyOf(Math.floor(atX / CELL), Math.floor(atZ / CELL));
      if (seen.has(key)) continue;
      seen.add(key);
      for (const solid of this.squares.get(key) ?? [])
        free = Math.min(free, this.distance(solid, x, y, z, way));
    }
    return free;
  }

  // Note the solids that have come since.
  private extend(): void {
    const { solids } = this.map;
    for (let solid = this.known; solid < solids.count; solid++) {
      if (this.passed.has(solids.kind[solid])) continue;
      let [west, east, south, north] = [Infinity, -Infinity, Infinity, -Infinity];
      for (let at = 3 * solids.first[solid], end = endOf(solids, solid); at < end; at += 3) {
        west = Math.min(west, solids.corners[at]);
        east = Math.max(east, solids.corners[at]);
        south = Math.min(south, solids.corners[at + 2]);
        north = Math.max(north, solids.corners[at + 2]);
      }
      this.note(solid, west, east, south, north);
    }
    this.known = solids.count;
  }

  private note(solid: number, west: number, east: number, south: number, north: number): void {
    for (let row = Math.floor(south / CELL); row <= Math.floor(north / CELL); row++) {
      for (let column = Math.floor(west / CELL); column <= Math.floor(east / CELL); column++) {
        const key = keyOf(column, row);
        const members = this.squares.get(key);
        if (members) members.push(solid);
        else this.squares.set(key, [solid]);
      }
    }
  }

  // Where a ray enters a solid; infinite if it does not, or begins in it.
  private distance(solid: number, x: number, y: number, z: number, way: [number, number, number]): number {
    const planes = this.planesOf(solid);
    let [enter, leave] = [-Infinity, Infinity];
    for (let at = 0; at < planes.length; at += 4) {
      const [a, b, c] = [planes[at], planes[at + 1], planes[at + 2]];
      const outside = a * x + b * y + c * z - planes[at + 3];
      const speed = a * way[0] + b * way[1] + c * way[2];
      if (Math.abs(speed) < 1e-9) {
        if (outside > 0) return Infinity;
      } else if (speed < 0) enter = Math.max(enter, -outside / speed);
      else leave = Math.min(leave, -outside / speed);
    }
    return enter > 0 && enter < leave ? enter : Infinity;
  }

  private planesOf(solid: number): Float32Array {
    const planes = this.planes.get(solid) ?? planesOf(this.map, solid);
    this.planes.set(solid, planes);
    return planes;
  }
}

function keyOf(column: number, row: number): number {
  return (row + 4096) * 8192 + column + 4096;
}
