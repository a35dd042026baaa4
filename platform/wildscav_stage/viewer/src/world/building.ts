// Parts of the map that are made one after the other, those near the camera first, so that no picture waits for all.

import type { Vector3 } from "three";

interface Part {
  x: number; // m
  z: number;
  weight: number; // those with less are made as if they were so many times nearer
  make(): void;
}

export class Building {
  private readonly waiting: Part[] = [];

  get isDone(): boolean {
    return !this.waiting.length;
  }

  add(part: Part): void {
    this.waiting.push(part);
  }

  // Make parts for so many ms; true if there were any.
  go(from: Vector3, time: number): boolean {
    const end = performance.now() + time;
    const hasParts = !this.isDone;
    while (this.waiting.length && performance.now() < end) this.next(from).make();
    return hasParts;
  }

  private next({ x, z }: Vector3): Part {
    const away = (part: Part) => part.weight * Math.hypot(part.x - x, part.z - z);
    let nearest = 0;
    for (let place = 1; place < this.waiting.length; place++)
      if (away(this.waiting[place]) < away(this.waiting[nearest])) nearest = place;
    const [part] = this.waiting.splice(nearest, 1);
    return part;
  }
}
