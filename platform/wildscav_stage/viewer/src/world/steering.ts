// How a person moves the cameras of the free view and of the view from above.

import type { View } from "../stage";
import { Input } from "../view/gestures";
import type { Cameras } from "./cameras";

const PACE = 400; // CSS pixels in a second that held keys move the map

export interface Size {
  width: number; // CSS pixels
  height: number;
}

export interface Steering {
  isHeld(): boolean; // whether keys are
  // Move as held keys say, for so many seconds.
  move(seconds: number): void;
  // Come nearer to the middle, or go away.
  zoom(factor: number): void;
  dispose(): void;
}

export function createSteering(
  canvas: HTMLCanvasElement,
  cameras: Cameras,
  viewNow: () => View,
  size: Size,
): Steering {
  const { orbit, mapView } = cameras;
  const isFree = () => viewNow().kind === "free";
  const isAbove = () => viewNow().kind === "above";
  const gestures = {
    drag: (right: number, down: number, isShift: boolean) => {
      if (isFree()) orbit.drag(right, down, isShift, size.height);
      else if (isAbove()) mapView.drag(right, down, size.width, size.height);
    },
    zoom: (factor: number, x: number, y: number) => {
      if (isFree()) orbit.zoom(factor);
      else if (isAbove()) mapView.zoom(factor, x, y, size.width, size.height);
    },
  };
  const input = new Input(canvas, gestures, () => isFree() || isAbove());
  const move = (seconds: number) => {
    const [right, ahead] = input.heading();
    if (!right && !ahead) return;
    if (isFree()) orbit.fly([right, ahead], seconds);
    else if (isAbove())
      mapView.drag(-PACE * right * seconds, PACE * ahead * seconds, size.width, size.height);
  };
  const zoom = (factor: number) => gestures.zoom(factor, size.width / 2, size.height / 2);
  return { isHeld: () => input.isHeld, move, zoom, dispose: () => input.dispose() };
}
