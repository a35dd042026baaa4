// The free view: a camera that a person turns about a place on the map, and moves over it.

import type { GameMap } from "../data/map";
import { heightAt } from "../view/terrain";

const TURN = 0.28; // degrees per CSS pixel
const LOWEST = 3; // degrees that it looks down, at least
const STEEPEST = 89;
const CLOSEST = 3; // m
const SPEED = 0.9; // shares of the distance that held keys move it in a second
const OVER = 0.6; // m that the camera keeps over the ground

export interface Pose {
  x: number; // m
  y: number;
  z: number;
  yaw: number; // degrees, 0 faces north, grows clockwise
  pitch: number; // positive looks down
}

export class Orbit {
  private x = 0; // m, what it looks at
  private z = 0;
  private yaw = -32;
  private pitch = 36;
  distance: number;
  private isFitted = false;

  constructor(private readonly map: GameMap) {
    this.distance = 1.1 * map.size;
  }

  // What it looks at (x and z, m), yaw and pitch (degrees), and distance (m).
  get place(): number[] {
    return [this.x, this.z, this.yaw, this.pitch, this.distance];
  }

  set place([x, z, yaw, pitch, distance]: number[]) {
    [this.yaw, this.pitch] = [yaw, pitch];
    this.moveTo(x, z);
    this.setDistance(distance);
  }

  // Show the whole map at first, however narrow the picture is.
  fit(aspect: number): void {
    if (!this.isFitted) this.distance *= Math.min(2, Math.max(1, 1 / aspect));
    this.isFitted = true;
  }

  drag(right: number, down: number, isShift: boolean, height: number): void {
    if (isShift) {
      const scale = (1.1 * this.distance) / Math.max(1, height);
      this.move(-right * scale, (down * scale) / Math.max(0.35, Math.sin(radians(this.pitch))));
      return;
    }
    this.yaw += TURN * right;
    this.pitch = Math.min(STEEPEST, Math.max(LOWEST, this.pitch + TURN * down));
  }

  zoom(factor: number): void {
    this.setDistance(this.distance / factor);
  }

  // Move as held keys say, for so many seconds.
  fly([right, ahead]: [number, number], seconds: number): void {
    const way = SPEED * Math.max(12, this.distance) * seconds;
    if (right || ahead) this.move(right * way, ahead * way);
  }

  pose(): Pose {
    const [yaw, pitch] = [radians(this.yaw), radians(this.pitch)];
    const level = this.distance * Math.cos(pitch);
    const [x, z] = [this.x - level * Math.sin(yaw), this.z - level * Math.cos(yaw)];
    const middle = heightAt(this.map.ground, this.x, this.z) + 1;
    const y = Math.max(middle + this.distance * Math.sin(pitch), heightAt(this.map.ground, x, z) + OVER);
    return { x, y, z, yaw: this.yaw, pitch: this.pitch };
  }

  // By so many m to the right and ahead, as the camera looks.
  private move(right: number, ahead: number): void {
    const [east, north] = [Math.sin(radians(this.yaw)), Math.cos(radians(this.yaw))];
    this.moveTo(this.x + ahead * east + right * north, this.z + ahead * north - right * east);
  }

  private moveTo(x: number, z: number): void {
    const half = this.map.size / 2;
    this.x = Math.min(half, Math.max(-half, x));
    this.z = Math.min(half, Math.max(-half, z));
  }

  private setDistance(distance: number): void {
    this.distance = Math.min(2 * this.map.size, Math.max(CLOSEST, distance));
  }
}

export function radians(degrees: number): number {
  return (degrees * Math.PI) / 180;
}
