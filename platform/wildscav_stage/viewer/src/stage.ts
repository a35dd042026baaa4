// What draws a match: in 3D, or from above where a browser has no WebGL 2.

import type { WebGLRenderer } from "three";
import type { Course } from "./data/course";
import type { GameMap } from "./data/map";

export const TRAIL = 30; // s of trails that are shown at first

export type ViewKind = "free" | "behind" | "eyes" | "above";

export interface View {
  kind: ViewKind;
  seat: number; // that is followed; of no matter to "free" and "above"
  // Degrees, the field of view through the eyes, and its limit up and down; if none is given, that of the engine's
  // cameras. A picture that is narrow shows more up and down, so that it shows enough aside.
  across?: number;
  tall?: number;
}

export interface StageOptions {
  hasLabels?: boolean; // whether names and health are over heads; they are unless said otherwise
  over?(renderer: WebGLRenderer): void; // draws over each picture
}

// Where a person has moved the cameras that nobody is followed by.
export interface CameraPlace {
  above: number[]; // of the view from above: x and z in its middle, and how much is seen across, m
  free?: number[]; // x and z that it looks at, m; yaw and pitch, degrees; distance, m; of a stage that draws in 3D
}

export interface Stage {
  readonly kinds: ViewKind[]; // of views that it can show
  view: View;
  // Whether its camera moves by itself, so that even the same moment must be drawn again.
  readonly moving: boolean;
  // The seat whose eyes a corner shows; null for none. A stage that cannot do it leaves it out.
  inset?: number | null;
  // How many seconds of trails are shown; a stage that shows none leaves it out.
  trail?: number;
  // Draw a moment of the match; frame need not be whole. A person who drags, scrolls or presses arrows on the canvas
  // moves the camera of a free view, or the view from above; the stage listens to that, the player then draws again.
  draw(frame: number): void;
  camera?: CameraPlace; // of a stage on which a person can move one
  // Come nearer (above 1) or go away, for people without a wheel; where the present view can.
  zoom?(factor: number): void;
  resize(width: number, height: number, pixelRatio: number): void;
  dispose(): void;
}

// Makes a stage, or throws an Error, for instance because the browser has no WebGL 2.
export type StageMaker = (canvas: HTMLCanvasElement, map: GameMap, course: Course) => Stage;
