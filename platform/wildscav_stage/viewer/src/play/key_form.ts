// The list of keys before a match, and the form in which a person chooses other ones.

import { make } from "../player/dom";
import { ACTS, type Act, type Bindings, GAMEPAD } from "./bindings";
import { pressedButton } from "./gamepad";

const WALKING: Act[] = ["forward", "left", "back", "right"];
const LOOKING: Act[] = ["look_left", "look_up", "look_down", "look_right"];
const LISTED: Act[] = ["jump", "shoot", "reload", "pick_up", "sound"];
const PLACES = ["key or mouse", "another", "gamepad"];
const ASKED = ["press …", "press …", "press a button …"];
const HOW = "Press what shall do it. Escape leaves it as it is, Backspace takes it away.";

// Show the keys in a list, before its last line.
export function listKeys(list: HTMLElement, bindings: Bindings): void {
  const row = (keys: (string | Node)[], words: string, needs = "") =>
    make("div", { className: `chosen ${needs}` }, make("dt", {}, ...keys), make("dd", {}, words));
  const first = (acts: Act[]) => acts.flatMap((act) => bindings.keysOf(act).slice(0, 1));
  const rows = [
    row(first(WALKING).map(keyCap), "walk"),
    row(["mouse ", ...first(LOOKING).map(keyCap)], "look"),
    ...LISTED.map((act) => {
      const keys = bindings.keysOf(act).flatMap((name, at) => (at ? [" or ", keyCap(name)] : [keyCap(name)]));
      return row(keys.length ? keys : ["–"], ACTS[act].words, ACTS[act].needs);
    }),
  ];
  for (const old of list.querySelectorAll(".chosen")) old.remove();
  list.prepend(...rows);
}

function keyCap(name: string): HTMLElement {
  return make("kbd", {}, name);
}

export class KeyForm {
  private readonly body: HTMLElement;
  private readonly said: HTMLElement;
  private end: () => void = () => {}; // stops waiting for a key

  // section holds a table, a line for what is said, and a button that resets all.
  constructor(
    section: HTMLElement,
    private readonly bindings: Bindings,
    private readonly change: () => void, // called after each change
  ) {
    this.body = section.querySelector("tbody") as HTMLElement;
    this.said = section.querySelector("[role=status]") as HTMLElement;
    section.querySelector("button")?.addEventListener("click", () => {
      bindings.reset();
      this.update("All keys and buttons are as they were at first.");
    });
    section.addEventListener("toggle", () => this.end());
    this.show();
    bindings.learnLayout().then(() => this.update(""));
  }

  private update(words: string): void {
    this.end();
    this.said.textContent = words;
    this.show();
    this.change();
  }

  private show(): void {
    this.body.replaceChildren(
      ...(Object.keys(ACTS) as Act[]).map((act) => {
        const { words, needs } = ACTS[act];
        const cells = PLACES.map((_, place) => make("td", {}, this.button(act, place)));
        return make("tr", { className: needs ?? "" }, make("th", { scope: "row" }, words), ...cells);
      }),
    );
  }

  private button(act: Act, place: number): HTMLElement {
    const trigger = this.bindings.triggersOf(act)[place];
    const name = trigger ? this.bindings.nameOf(trigger) : "–";
    const made = make("button", {
      type: "button",
      textContent: name,
      onclick: () => this.ask(made, act, place),
    });
    made.setAttribute("aria-label", `${ACTS[act].words}, ${PLACES[place]}: ${trigger ? name : "nothing"}`);
    made.dataset.act = `${act} ${place}`;
    return made;
  }

  // Wait for what a person presses next.
  private ask(button: HTMLElement, act: Act, place: number): void {
    this.end();
    button.textContent = ASKED[place];
    this.said.textContent = HOW;
    const choose = (trigger: string) => {
      this.update(this.bindings.bind(act, place, trigger));
      (this.body.querySelector(`[data-act="${act} ${place}"]`) as HTMLElement).focus({ preventScroll: true });
    };
    const stop = new AbortController();
    const options = { capture: true, signal: stop.signal };
    const take = (event: Event, trigger: string) => {
      event.preventDefault();
      event.stopPropagation();
      choose(trigger);
    };
    const takeKey = (event: KeyboardEvent) => {
      if (event.code === "Escape") take(event, this.bindings.triggersOf(act)[place]);
      else if (event.code === "Backspace") take(event, "");
      else if (place !== GAMEPAD && event.code !== "Tab") take(event, event.code);
    };
    addEventListener("keydown", takeKey, options);
    if (place !== GAMEPAD)
      addEventListener("mousedown", (event) => take(event, `Mouse${event.button}`), options);
    const polling = place === GAMEPAD ? setInterval(() => pressedButton(choose), 50) : 0;
    this.end = () => {
      stop.abort();
      clearInterval(polling);
      this.end = () => {};
    };
  }
}
