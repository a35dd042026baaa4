// What draws a match: in 3D, or from above where a browser has no WebGL 2.

export type ViewKind = "free" | "behind" | "eyes" | "above";

export interface View {
  kind: ViewKind;
  seat: number; // that is followed; of no matter to "free" and "above"
}

export interface Stage {
  readonly kinds: ViewKind[]; // of views that it can show
  view: View;
  // Draw a moment of the match; frame need not be whole.
  draw(frame: number): void;
  // Move the camera of a free view, or the view from above, as a person drags, scrolls or presses arrows.
  resize(width: number, height: number, pixelRatio: number): void;
  dispose(): void;
}
