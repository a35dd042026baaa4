// What a person does on the canvas: drags, pinches, scrolls and holds keys, whatever the device.

export interface Gestures {
  // By so many CSS pixels; a shift moves the view, any other drag turns it where it can turn.
  drag(right: number, down: number, isShift: boolean): void;
  // Closer by a factor, about a place given in CSS pixels from the canvas's upper left corner.
  zoom(factor: number, x: number, y: number): void;
}

const KEYS: Record<string, [number, number]> = {
  KeyW: [0, 1],
  ArrowUp: [0, 1],
  KeyS: [0, -1],
  ArrowDown: [0, -1],
  KeyA: [-1, 0],
  ArrowLeft: [-1, 0],
  KeyD: [1, 0],
  ArrowRight: [1, 0],
};
const WHEEL = 0.0015; // logarithm of the zoom per pixel of scrolling
const LINE = 32; // pixels in a line, for wheels that count lines

export class Input {
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private readonly held = new Set<string>();
  private readonly ending = new AbortController();

  // isMoved: whether the present view is one that a person moves; only then are keys taken from the page.
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly gestures: Gestures,
    private readonly isMoved: () => boolean,
  ) {
    const options = { signal: this.ending.signal };
    if (canvas.tabIndex < 0) canvas.tabIndex = 0;
    canvas.style.touchAction = "none";
    canvas.addEventListener("pointerdown", (event) => this.press(event), options);
    canvas.addEventListener("pointermove", (event) => this.move(event), options);
    for (const name of ["pointerup", "pointercancel"] as const)
      canvas.addEventListener(name, (event) => this.pointers.delete(event.pointerId), options);
    canvas.addEventListener("wheel", (event) => this.scroll(event), { ...options, passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault(), options);
    canvas.addEventListener("keydown", (event) => this.hold(event), options);
    canvas.addEventListener("keyup", (event) => this.held.delete(event.code), options);
    canvas.addEventListener("blur", () => this.held.clear(), options);
  }

  // Where the held keys point: rightwards and forwards, each -1 to 1.
  heading(): [number, number] {
    let [right, ahead] = [0, 0];
    for (const code of this.held) {
      right += KEYS[code][0];
      ahead += KEYS[code][1];
    }
    return [Math.sign(right), Math.sign(ahead)];
  }

  // Whether keys are held that move the view.
  get isHeld(): boolean {
    return this.isMoved() && this.heading().some((part) => part !== 0);
  }

  dispose(): void {
    this.ending.abort();
  }

  private press(event: PointerEvent): void {
    if (!this.isMoved()) return; // browsers capture no pointer that a page has locked
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
  }

  private move(event: PointerEvent): void {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const before = this.spread();
    const [right, down] = [event.offsetX - pointer.x, event.offsetY - pointer.y];
    pointer.x = event.offsetX;
    pointer.y = event.offsetY;
    const count = this.pointers.size;
    if (count === 1) {
      this.gestures.drag(right, down, event.shiftKey || (event.buttons & 6) !== 0);
      return;
    }
    const after = this.spread();
    this.gestures.drag(right / count, down / count, true);
    if (before.width > 0 && after.width > 0) this.gestures.zoom(after.width / before.width, after.x, after.y);
  }

  // The middle of all pointers, and how far apart they are.
  private spread(): { x: number; y: number; width: number } {
    const all = [...this.pointers.values()];
    const x = all.reduce((sum, each) => sum + each.x, 0) / all.length;
    const y = all.reduce((sum, each) => sum + each.y, 0) / all.length;
    return { x, y, width: all.reduce((sum, each) => sum + Math.hypot(each.x - x, each.y - y), 0) };
  }

  private scroll(event: WheelEvent): void {
    if (!this.isMoved()) return;
    event.preventDefault();
    const pixels = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY : LINE * event.deltaY;
    this.gestures.zoom(Math.exp(-WHEEL * pixels), event.offsetX, event.offsetY);
  }

  private hold(event: KeyboardEvent): void {
    if (!(event.code in KEYS) || !this.isMoved() || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.held.add(event.code);
  }
}
