// The picture of a match: a canvas with the stage that draws on it, and what lies over it.

import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import type { Stage, StageMaker, View, ViewKind } from "../stage";
import { iconButton, make } from "./dom";

const SHARPEST = 2; // pixels of the canvas to one of the page
const BACK = 4000; // ms in which 3D must be back, or the match is shown from above
const NO_3D = "This browser cannot draw the match in 3D, so it is shown from above.";
const LOST_3D = "The browser stopped drawing in 3D, so the match is shown from above.";
const NO_STAGE = "This browser cannot draw the match. The events tell it.";

export class Screen {
  readonly element = make("div", { className: "player-screen" });
  stage: Stage | null = null;
  wanted: View = { kind: "behind", seat: 0 };
  onStage = () => {}; // told when the stage is there, or is another
  private canvas: HTMLCanvasElement | null = null;
  private readonly message = make("p", { className: "player-message", role: "status" });
  // Why the match is not in 3D; stands below the picture.
  readonly note = make("p", { className: "player-note", role: "status" });
  private readonly zoomButtons: HTMLElement;
  private readonly sizes = new ResizeObserver(() => this.fit());
  private readonly watcher = new IntersectionObserver((entries) => this.see(entries));
  private isOnPage = true; // as far as one has scrolled
  private map: GameMap | null = null;

  constructor(
    private readonly course: Course,
    private readonly makers: StageMaker[],
    private readonly redraw: () => void,
  ) {
    this.zoomButtons = make(
      "div",
      { className: "player-zoom" },
      iconButton("nearer", "Zoom in", () => this.zoom(1.5)),
      iconButton("farther", "Zoom out", () => this.zoom(1 / 1.5)),
    );
    this.zoomButtons.hidden = true;
    this.element.append(this.message, this.zoomButtons);
    this.sizes.observe(this.element);
    this.watcher.observe(this.element);
  }

  say(...what: (Node | string)[]): void {
    this.message.replaceChildren(...what);
  }

  // Draw on the map from now on.
  show(map: GameMap): void {
    this.map = map;
    this.say();
    this.raise(0);
  }

  // Nobody sees the picture while the page shows the list of events below it.
  draw(frame: number): void {
    if (this.isOnPage) this.stage?.draw(frame);
  }

  // Whether the camera moves by itself.
  get isMoving(): boolean {
    return this.isOnPage && this.stage?.moving === true;
  }

  look(view: View): void {
    this.wanted = view;
    if (this.stage) this.stage.view = { ...view, kind: this.possible(view.kind) };
    this.element.classList.toggle("player-aims", this.view.kind === "eyes" && this.stage !== null);
    const isMoved = this.view.kind === "free" || this.view.kind === "above";
    this.zoomButtons.hidden = !isMoved || !this.stage?.zoom;
    // Where fingers do not move the camera, they scroll the page.
    if (this.canvas) this.canvas.style.touchAction = isMoved ? "none" : "pan-y";
    this.redraw();
  }

  // Show what a seat sees in a corner; null for nothing.
  showInset(seat: number | null): void {
    if (this.stage?.inset !== undefined) this.stage.inset = seat;
    this.element.classList.toggle("player-has-inset", seat !== null);
  }

  get kinds(): ViewKind[] {
    return this.stage?.kinds ?? [];
  }

  get view(): View {
    return this.stage?.view ?? this.wanted;
  }

  dispose(): void {
    this.sizes.disconnect();
    this.watcher.disconnect();
    this.stage?.dispose();
    this.stage = null;
  }

  // Take the first of the makers from a place on that makes a stage, on a canvas that none has used.
  private raise(first: number): void {
    for (let place = first; place < this.makers.length; place++) {
      if (this.tryMaker(place)) return;
    }
    this.canvas?.remove();
    this.say(NO_STAGE);
    this.onStage();
  }

  private tryMaker(place: number): boolean {
    const canvas = make("canvas", { className: "player-canvas", tabIndex: 0, role: "img" });
    canvas.setAttribute("aria-label", place ? "The match from above" : "The match in 3D");
    this.canvas?.remove();
    this.canvas = canvas;
    this.element.prepend(canvas);
    try {
      this.stage = this.makers[place](canvas, this.map as GameMap, this.course);
    } catch (error) {
      console.info(error);
      return false;
    }
    this.waitForContext(canvas, place);
    for (const name of ["pointerdown", "pointermove", "pointerup", "wheel", "keydown"]) {
      canvas.addEventListener(name, this.redraw, { passive: true });
    }
    if (place) this.note.textContent = NO_3D;
    this.look(this.wanted);
    this.fit();
    this.onStage();
    return true;
  }

  // A browser that takes the graphics processor away mostly gives it back; the stage then draws on.
  private waitForContext(canvas: HTMLCanvasElement, place: number): void {
    let wait = 0;
    canvas.addEventListener("webglcontextlost", () => {
      wait = window.setTimeout(() => this.lose(place), BACK);
    });
    canvas.addEventListener("webglcontextrestored", () => {
      clearTimeout(wait);
      this.redraw();
    });
  }

  private lose(place: number): void {
    if (!this.stage) return;
    this.stage.dispose();
    this.stage = null;
    this.raise(place + 1);
    if (this.stage) this.note.textContent = LOST_3D;
  }

  private possible(kind: ViewKind): ViewKind {
    return this.kinds.includes(kind) ? kind : (this.kinds[0] ?? kind);
  }

  private zoom(factor: number): void {
    this.stage?.zoom?.(factor);
    this.redraw();
  }

  private see(entries: IntersectionObserverEntry[]): void {
    this.isOnPage = entries[entries.length - 1].isIntersecting;
    if (this.isOnPage) this.redraw();
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!this.stage || !width || !height) return;
    this.stage.resize(width, height, Math.min(window.devicePixelRatio || 1, SHARPEST));
    this.redraw();
  }
}
