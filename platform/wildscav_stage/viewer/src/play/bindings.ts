// Which keys, mouse buttons and gamepad buttons do what. A trigger is a key's code ("KeyW"), a mouse button ("Mouse0")
// or a button of a standard gamepad ("Pad7").

import { remember, remembered } from "./settings";

export type Flag = "jump" | "shoot" | "reload" | "pick_up";
export type Act =
  | Flag
  | "forward"
  | "back"
  | "left"
  | "right"
  | "look_left"
  | "look_right"
  | "look_up"
  | "look_down"
  | "skip"
  | "sound";
// A key or mouse button, another one, and a button of a gamepad; "" is none.
export type Triggers = [string, string, string];

interface Meaning {
  words: string;
  usual: Triggers;
  needs?: "weapon" | "boxes"; // without which it does nothing
}

export const GAMEPAD = 2; // the place of a gamepad's button in Triggers
export const ACTS: Record<Act, Meaning> = {
  forward: { words: "walk forward", usual: ["KeyW", "", ""] },
  back: { words: "walk back", usual: ["KeyS", "", ""] },
  left: { words: "walk left", usual: ["KeyA", "", ""] },
  right: { words: "walk right", usual: ["KeyD", "", ""] },
  jump: { words: "jump", usual: ["Space", "", "Pad0"] },
  shoot: { words: "shoot", usual: ["Mouse0", "KeyF", "Pad7"], needs: "weapon" },
  reload: { words: "reload", usual: ["KeyR", "", "Pad2"], needs: "weapon" },
  pick_up: { words: "pick up supplies", usual: ["KeyE", "", "Pad3"], needs: "boxes" },
  look_left: { words: "look left", usual: ["ArrowLeft", "", ""] },
  look_right: { words: "look right", usual: ["ArrowRight", "", ""] },
  look_up: { words: "look up", usual: ["ArrowUp", "", ""] },
  look_down: { words: "look down", usual: ["ArrowDown", "", ""] },
  skip: { words: "skip the first steps", usual: ["Enter", "", "Pad9"] },
  sound: { words: "sound on or off", usual: ["KeyM", "", ""] },
};

const KEPT = "wildscav-keys";
// Browsers need Escape, and keys that are held with Ctrl or Alt.
const ALLOWED =
  /^(Key[A-Z]|Digit\d|Numpad\w+|Arrow\w+|Shift\w+|Space|Enter|CapsLock|Back(quote|slash)|Bracket\w+|Minus|Equal|Semicolon|Quote|Comma|Period|Slash|Intl\w+|Insert|Home|End|Page\w+|Mouse[0-4])$/;
const PAD = /^Pad(\d|1[0-6])$/;
const BUTTONS = ["left button", "middle button", "right button", "button 4", "button 5"];
const PAD_BUTTONS = "A,B,X,Y,LB,RB,LT,RT,Back,Start,left stick,right stick,up,down,left,right,Home".split(
  ",",
);
const NAMES: Record<string, string> = {
  ArrowLeft: "←",
  ArrowRight: "→",
  ArrowUp: "↑",
  ArrowDown: "↓",
  ShiftLeft: "left Shift",
  ShiftRight: "right Shift",
};

export class Bindings {
  private chosen!: Record<Act, Triggers>;
  private layout: Pick<Map<string, string>, "get"> = new Map(); // what keys write

  constructor() {
    this.read(remembered(KEPT));
  }

  // Take what a text says, and what is usual where it says nothing right.
  read(text: string): void {
    let kept: Record<string, unknown> = {};
    try {
      kept = JSON.parse(text || "{}") ?? {};
    } catch {
      // Somebody else has written there.
    }
    const acts = Object.entries(ACTS).map(([act, { usual }]) => [act, checked(kept[act]) ?? [...usual]]);
    this.chosen = Object.fromEntries(acts);
  }

  // Name keys as the person's keyboard does, where the browser tells.
  async learnLayout(): Promise<void> {
    const { keyboard } = navigator as { keyboard?: { getLayoutMap?(): Promise<Map<string, string>> } };
    this.layout = (await keyboard?.getLayoutMap?.().catch(() => undefined)) ?? this.layout;
  }

  triggersOf(act: Act): Readonly<Triggers> {
    return this.chosen[act];
  }

  actOf(trigger: string): Act | undefined {
    return this.all.find((act) => this.chosen[act].includes(trigger));
  }

  // The buttons of a gamepad that do something, by number.
  get padButtons(): [number, Act][] {
    const bound = this.all.filter((act) => this.chosen[act][GAMEPAD]);
    return bound.map((act) => [Number(this.chosen[act][GAMEPAD].slice(3)), act]);
  }

  // Let a trigger do something, or nothing if it is ""; return what a person should know of it.
  bind(act: Act, place: number, trigger: string): string {
    if (trigger && !(place === GAMEPAD ? PAD : ALLOWED).test(trigger))
      return `${this.nameOf(trigger)} cannot be used here.`;
    const other = trigger ? this.actOf(trigger) : undefined;
    if (other) this.chosen[other][this.chosen[other].indexOf(trigger)] = "";
    this.chosen[act][place] = trigger;
    remember(KEPT, JSON.stringify(this.chosen));
    const taken =
      other && other !== act ? `${this.nameOf(trigger)} did something else: ${ACTS[other].words}. ` : "";
    const idle = [other, act].filter((each) => each && !this.chosen[each].some(Boolean)) as Act[];
    return taken + idle.map((each) => `Nothing is left for: ${ACTS[each].words}.`).join(" ");
  }

  reset(): void {
    this.read("");
    remember(KEPT, "");
  }

  // What a person calls a trigger.
  nameOf(trigger: string): string {
    if (PAD.test(trigger)) return PAD_BUTTONS[Number(trigger.slice(3))];
    if (/^Mouse\d$/.test(trigger)) return BUTTONS[Number(trigger.slice(5))] ?? trigger;
    const written = this.layout.get(trigger);
    if (written) return written.toUpperCase();
    return NAMES[trigger] ?? trigger.replace(/^(Key|Digit)/, "").replace(/^Numpad/, "keypad ");
  }

  // The keys and mouse buttons that do something, or "" if none does.
  keysOf(act: Act): string[] {
    return this.chosen[act]
      .slice(0, GAMEPAD)
      .filter(Boolean)
      .map((trigger) => this.nameOf(trigger));
  }

  private get all(): Act[] {
    return Object.keys(ACTS) as Act[];
  }
}

function checked(kept: unknown): Triggers | null {
  if (!Array.isArray(kept) || kept.length !== 3) return null;
  const isRight = (trigger: unknown, place: number) =>
    trigger === "" || (typeof trigger === "string" && (place === GAMEPAD ? PAD : ALLOWED).test(trigger));
  return kept.every(isRight) ? (kept as Triggers) : null;
}
