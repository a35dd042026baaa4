// Shows a person the first steps, and keeps which ones they have done.

import type { Bindings } from "./bindings";
import type { Input } from "./controls";
import { find } from "./dom";
import { type Did, Lessons, type Needs } from "./lessons";
import type { Own } from "./messages";
import { remember, remembered } from "./settings";

const KEPT = "wildscav-lessons";
const PRAISE = 900; // ms for which a step that was done is shown as that
const LEAP = 2; // m from one picture to the next, that nobody walks

type Spot = readonly [number, number, number]; // m

export class Teacher {
  private readonly shown = find("lesson");
  private lessons: Lessons | null = null;
  private praised = 0; // until when, ms
  private last: { own: Own; spot: Spot } | null = null;

  constructor(
    private readonly bindings: Bindings,
    private readonly isTouched: boolean,
  ) {
    find("lesson button").addEventListener("click", () => this.skip());
    find("teach").addEventListener("click", () => {
      remember(KEPT, "");
      find("teach").textContent = "They come with the next match";
    });
  }

  begin(needs: Needs): void {
    this.lessons = new Lessons(needs, knownOf(remembered(KEPT)));
    this.last = null;
    this.praised = 0;
    this.show();
  }

  // Whether a person has steps that can be shown again.
  get hasTaught(): boolean {
    return knownOf(remembered(KEPT)).size > 0;
  }

  skip(): void {
    this.lessons?.skip();
    this.keep();
    this.show();
  }

  // Take what a person did for a picture; spot is where they are, target how far away theirs is, m.
  watch(input: Input, own: Own, spot: Spot, target: number | null, now: number, seconds: number): void {
    if (now < this.praised) return;
    if (this.shown.classList.contains("done")) this.show();
    const before = this.last ?? { own, spot };
    this.last = { own, spot };
    if (!this.lessons || own.health <= 0) return;
    const walked = Math.hypot(spot[0] - before.spot[0], spot[2] - before.spot[2]);
    const did: Did = {
      turned: Math.abs(input.turn) + Math.abs(input.look),
      walked: walked < LEAP ? walked : 0,
      jumped: input.jump,
      fired: own.clip < before.own.clip,
      reloads: own.reload > 0,
      gained: own.supplies > before.own.supplies,
      target,
      seconds,
    };
    if (!this.lessons.take(did)) return;
    this.keep();
    this.praised = now + PRAISE;
    this.shown.classList.add("done");
  }

  private keep(): void {
    remember(KEPT, JSON.stringify([...(this.lessons?.known ?? [])]));
  }

  // Show what to do now, by the keys that do it.
  show(): void {
    const words = this.lessons?.words(this.bindings, this.isTouched) ?? null;
    const [key] = this.bindings.keysOf("skip");
    this.shown.hidden = words === null;
    this.shown.classList.remove("done");
    find("lesson p").textContent = words ?? "";
    find("lesson button").textContent = key && !this.isTouched ? `${key}: skip` : "Skip";
  }
}

// The steps that a text names; none if somebody else has written there.
function knownOf(text: string): Set<string> {
  try {
    const names: unknown = JSON.parse(text || "[]");
    return new Set(Array.isArray(names) ? names.filter((name) => typeof name === "string") : []);
  } catch {
    return new Set();
  }
}
