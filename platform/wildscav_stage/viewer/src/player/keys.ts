// What keys do, and the table that tells of them.

import type { Actions } from "./controls";
import { make } from "./dom";

type KeyAction = (actions: Actions) => void;

const KEYS: Record<string, KeyAction> = {
  " ": (actions) => actions.toggle(),
  k: (actions) => actions.toggle(),
  ArrowLeft: (actions) => actions.leap(-5),
  ArrowRight: (actions) => actions.leap(5),
  ",": (actions) => actions.step(-1),
  ".": (actions) => actions.step(1),
  p: (actions) => actions.jump(-1),
  n: (actions) => actions.jump(1),
  "+": (actions) => actions.changeSpeed(1),
  "=": (actions) => actions.changeSpeed(1),
  "-": (actions) => actions.changeSpeed(-1),
  v: (actions) => actions.nextView(),
  m: (actions) => actions.direct(),
  i: (actions) => actions.toggleInset(),
  f: (actions) => actions.toggleFullscreen(),
  l: (actions) => actions.followLive(),
  c: (actions) => actions.copyLink(),
  "?": (actions) => actions.help(),
};
const TOLD: [string, string][] = [
  ["Space", "play or pause"],
  ["← →", "5 seconds back or on"],
  [", .", "one step back or on"],
  ["P N", "the previous or next event"],
  ["− +", "slower or faster"],
  ["V", "the next view"],
  ["0 … 9", "follow the agent of that number"],
  ["M", "follow whoever has most to do"],
  ["I", "the agent's eyes in a corner"],
  ["L", "the present moment of a match that is being played"],
  ["C", "copy a link to this moment"],
  ["F", "fullscreen"],
  ["?", "these keys"],
];

// What a key does; undefined if nothing.
export function actionOf(key: string): KeyAction | undefined {
  if (/^\d$/.test(key)) return (actions) => actions.follow(Number(key));
  return KEYS[key.length === 1 ? key.toLowerCase() : key];
}

const STORED = "wildscav-keys"; // "off" for people whom keys of one letter hinder

// Whether keys of one character do something; people who speak to their computer can turn that off.
function areLettersOn(): boolean {
  try {
    return localStorage.getItem(STORED) !== "off";
  } catch {
    return true;
  }
}

function turnLetters(isOn: boolean): void {
  try {
    localStorage.setItem(STORED, isOn ? "on" : "off");
  } catch {
    // A page that may store nothing forgets it.
  }
}

// Whether a key pressed on an element means something else there. pressed: what a pointer pressed last, which has
// the focus, but whose person thinks of the picture.
function isTaken(key: string, at: Element, pressed: Element | null): boolean {
  if (at.closest("dialog, textarea, select, [contenteditable]")) return true;
  const field = at instanceof HTMLInputElement ? at.type : "";
  if (field && field !== "range" && field !== "checkbox") return true;
  if (key !== " " || at === pressed) return false;
  return at.closest("button, a, summary") !== null || field === "checkbox";
}

// Listen to keys: those pressed within an element, and those pressed nowhere, if isFirst says so.
// Returns what ends that.
export function listenToKeys(element: HTMLElement, actions: Actions, isFirst: () => boolean): () => void {
  let pressed: Element | null = null;
  const onPointer = (press: PointerEvent) => {
    pressed = (press.target as Element).closest("button, select");
  };
  // Once a pointer has chosen from a list, keys are for the picture again.
  const onChange = (change: Event) => {
    if (change.target === pressed && pressed instanceof HTMLSelectElement) pressed.blur();
  };
  const onKey = (press: KeyboardEvent) => {
    const at = press.target as Element;
    const isNowhere = at === document.body || at === document.documentElement;
    if (!element.contains(at) && !(isNowhere && isFirst())) return;
    if (press.key === "Tab" || press.key === "Enter") pressed = null;
    if (press.defaultPrevented || press.ctrlKey || press.metaKey || press.altKey) return;
    const action = actionOf(press.key);
    if (!action || isTaken(press.key, at, pressed)) return;
    if (press.key.length === 1 && press.key !== " " && !areLettersOn()) return;
    press.preventDefault();
    action(actions);
  };
  element.addEventListener("pointerdown", onPointer);
  element.addEventListener("change", onChange);
  document.addEventListener("keydown", onKey);
  return () => document.removeEventListener("keydown", onKey);
}

// A dialog that tells of the keys.
export function keysDialog(): HTMLDialogElement {
  const rows = TOLD.map(([key, what]) =>
    make("tr", {}, make("th", { scope: "row", textContent: key }), make("td", { textContent: what })),
  );
  const dialog = make("dialog", { className: "player-keys" });
  dialog.setAttribute("aria-label", "Keys");
  const letters = make("input", { type: "checkbox", checked: areLettersOn() });
  letters.onchange = () => turnLetters(letters.checked);
  dialog.append(
    make("table", {}, make("caption", { textContent: "Keys" }), make("tbody", {}, ...rows)),
    make("label", {}, letters, " Letters, digits and signs work as keys"),
    make("button", { type: "button", textContent: "Close", autofocus: true, onclick: () => dialog.close() }),
  );
  return dialog;
}
