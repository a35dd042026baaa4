// Keys, mouse, touch and gamepad, gathered into the inputs that the server takes.

import type { Act, Bindings, Flag } from "./bindings";
import { standardGamepad } from "./gamepad";
import { FRAMES } from "./messages";
import type { Held } from "./prediction";
import type { Settings } from "./settings";

const DEGREES_PER_PIXEL = 0.12; // of the mouse
const DEGREES_PER_TOUCH = 0.3; // per pixel that a finger moves over the picture
const KEY_TURN = 110; // degrees per second, with the arrow keys
const STICK_TURN = 200; // degrees per second, with a gamepad's stick
const DEAD = 0.15; // of a stick's way, from where on it counts
const MOST_TURN = 3600; // degrees that an input may turn
const AXES: Partial<Record<Act, ["forward" | "right" | "turning" | "looking", number]>> = {
  forward: ["forward", 1],
  back: ["forward", -1],
  right: ["right", 1],
  left: ["right", -1],
  look_right: ["turning", 1],
  look_left: ["turning", -1],
  look_down: ["looking", 1],
  look_up: ["looking", -1],
};
export const FLAGS: Flag[] = ["jump", "shoot", "reload", "pick_up"];

export type Input = Held & Record<Flag, boolean>;

// Limits how fast the view turns to what the body can. What is too fast is lost here, although the server would let
// the body follow by 0.1 s of turning: so the view never runs ahead of it.
export class TurnLimit {
  private left = 0; // degrees that may be turned at once: at most those of a frame

  take(degrees: number, seconds: number, speed: number): number {
    this.left = Math.min(speed / FRAMES, this.left + speed * seconds);
    const taken = within(degrees, this.left);
    this.left -= Math.abs(taken);
    return taken;
  }
}

export class Controls {
  enabled = false;
  locked = false; // whether the mouse is
  private readonly held = new Set<string>(); // keys and mouse buttons
  private readonly touched = new Set<Flag>(); // those whose buttons fingers hold
  private readonly pressed = new Set<Flag>(); // those that were pressed since the last input
  private padded: Act[] = []; // what a gamepad's buttons held last time
  private stick = [0, 0]; // right and forward, -1 to 1
  private turn = 0; // degrees since the last input
  private look = 0;
  private readonly limits = [new TurnLimit(), new TurnLimit()]; // of turn and look

  constructor(
    private readonly picture: HTMLElement,
    stick: HTMLElement,
    buttons: Iterable<HTMLElement>,
    private readonly settings: Settings,
    private readonly bindings: Bindings,
    private readonly command: (act: Act) => void, // called with what is no part of an input
  ) {
    this.listenToKeys();
    this.listenToMouse();
    this.listenToStick(stick);
    for (const button of buttons) this.listenToButton(button);
    this.listenToSwipes();
  }

  // Take the mouse, where there is one.
  lock(): void {
    if (!matchMedia("(pointer: fine)").matches) return;
    const lock = async (how?: PointerLockOptions) => this.picture.requestPointerLock(how);
    lock({ unadjustedMovement: true })
      .catch(() => lock())
      .catch(() => {});
  }

  release(): void {
    for (const held of [this.held, this.touched, this.pressed]) held.clear();
    this.stick = [0, 0];
    this.turn = this.look = 0;
  }

  // Return what is held, and what was turned and pressed since the last call, some seconds ago.
  take(seconds: number, turnSpeed = MOST_TURN * FRAMES): Input {
    const held = { forward: this.stick[1], right: this.stick[0], turning: 0, looking: 0 };
    for (const trigger of this.held) this.hold(this.bindings.actOf(trigger), held);
    for (const flag of this.touched) this.pressed.add(flag);
    const [turn, look] = this.readGamepad(held);
    const [turning, looking] = this.limits;
    const input = {
      forward: within(held.forward, 1),
      right: within(held.right, 1),
      turn: turning.take(this.turn + (held.turning * KEY_TURN + turn) * seconds, seconds, turnSpeed),
      look: looking.take(this.look + (held.looking * KEY_TURN + look) * seconds, seconds, turnSpeed),
      ...(Object.fromEntries(FLAGS.map((flag) => [flag, this.pressed.has(flag)])) as Record<Flag, boolean>),
    };
    this.turn = this.look = 0;
    this.pressed.clear();
    return input;
  }

  private hold(act: Act | undefined, held: Record<string, number>): void {
    const axis = act && AXES[act];
    if (axis) held[axis[0]] += axis[1];
    else if (isFlag(act)) this.pressed.add(act);
  }

  // Add what a gamepad holds, and return how fast it turns, in degrees a second to the right and down.
  private readGamepad(held: Record<string, number>): [number, number] {
    const pad = this.enabled ? standardGamepad() : undefined;
    if (!pad) return [0, 0];
    const [right, back, turn, look] = pad.axes.map((value) => (Math.abs(value) < DEAD ? 0 : value));
    held.right += right;
    held.forward -= back;
    const acts = this.bindings.padButtons.flatMap(([button, act]) =>
      pad.buttons[button]?.pressed ? act : [],
    );
    for (const act of acts) {
      this.hold(act, held);
      if (!this.padded.includes(act)) this.begin(act);
    }
    this.padded = acts;
    const speed = STICK_TURN * this.settings.sensitivity;
    return [turn * Math.abs(turn) * speed, look * Math.abs(look) * speed * (this.settings.invert ? -1 : 1)];
  }

  private listenToKeys(): void {
    addEventListener("keydown", (event) => {
      const { code } = event;
      if (!this.enabled || event.ctrlKey || event.metaKey || event.altKey) return;
      if (this.press(code, event.repeat)) event.preventDefault();
    });
    addEventListener("keyup", (event) => this.held.delete(event.code));
    addEventListener("blur", () => this.release());
  }

  private listenToMouse(): void {
    document.addEventListener("pointerlockchange", () => {
      this.locked = document.pointerLockElement === this.picture;
    });
    addEventListener("mousemove", (event) => {
      if (this.enabled && this.locked) this.turnBy(event.movementX, event.movementY, DEGREES_PER_PIXEL);
    });
    addEventListener("mousedown", (event) => {
      if (this.enabled && this.locked && this.press(`Mouse${event.button}`)) event.preventDefault();
    });
    addEventListener("mouseup", (event) => this.held.delete(`Mouse${event.button}`));
    this.picture.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  // Hold a key or a mouse button, and return whether it does anything.
  private press(trigger: string, isRepeated = false): boolean {
    const act = this.bindings.actOf(trigger);
    if (!act) return false;
    this.held.add(trigger);
    if (!isRepeated) this.begin(act);
    return true;
  }

  // What is pressed counts even if it is released before the next input.
  private begin(act: Act): void {
    if (isFlag(act)) this.pressed.add(act);
    else if (!AXES[act]) this.command(act);
  }

  private turnBy(right: number, down: number, degrees: number): void {
    const { sensitivity, invert } = this.settings;
    this.turn += right * degrees * sensitivity;
    this.look += down * degrees * sensitivity * (invert ? -1 : 1);
  }

  private listenToStick(stick: HTMLElement): void {
    const knob = stick.querySelector("i") as HTMLElement;
    const move = (event: PointerEvent) => {
      const { left, top, width } = stick.getBoundingClientRect();
      const x = (2 * (event.clientX - left)) / width - 1;
      const y = (2 * (event.clientY - top)) / width - 1;
      const longest = Math.max(1, Math.hypot(x, y));
      this.stick = [x / longest, -y / longest];
      knob.style.transform = `translate(${this.stick[0] * width * 0.3}px, ${-this.stick[1] * width * 0.3}px)`;
    };
    const leave = () => {
      this.stick = [0, 0];
      knob.style.transform = "";
    };
    stick.addEventListener("pointerdown", (event) => {
      stick.setPointerCapture(event.pointerId);
      move(event);
    });
    stick.addEventListener("pointermove", (event) => stick.hasPointerCapture(event.pointerId) && move(event));
    stick.addEventListener("pointerup", leave);
    stick.addEventListener("pointercancel", leave);
  }

  private listenToButton(button: HTMLElement): void {
    const flag = button.dataset.flag as Flag;
    const hold = (held: boolean) => {
      button.classList.toggle("held", held);
      if (held) this.touched.add(flag);
      else this.touched.delete(flag);
    };
    button.addEventListener("pointerdown", () => {
      this.pressed.add(flag);
      hold(true);
    });
    for (const end of ["pointerup", "pointercancel", "pointerleave"])
      button.addEventListener(end, () => hold(false));
  }

  // A finger that moves over the picture turns the view.
  private listenToSwipes(): void {
    const last = new Map<number, [number, number]>();
    this.picture.addEventListener("pointerdown", (event) => {
      if (event.pointerType !== "mouse") last.set(event.pointerId, [event.clientX, event.clientY]);
    });
    addEventListener("pointermove", (event) => {
      const from = last.get(event.pointerId);
      if (!from || !this.enabled) return;
      this.turnBy(event.clientX - from[0], event.clientY - from[1], DEGREES_PER_TOUCH);
      last.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const end of ["pointerup", "pointercancel"] as const)
      addEventListener(end, (event) => last.delete(event.pointerId));
  }
}

function isFlag(act: Act | undefined): act is Flag {
  return FLAGS.includes(act as Flag);
}

function within(value: number, most: number): number {
  return Math.max(-most, Math.min(most, value));
}
