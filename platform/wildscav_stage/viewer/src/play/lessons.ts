// The first steps of a person, one after another: what to do, and when it is done.

import type { Act, Bindings } from "./bindings";

// What a person did since the last picture, and where they are.
export interface Did {
  turned: number; // degrees
  walked: number; // m
  jumped: boolean;
  fired: boolean;
  reloads: boolean;
  gained: boolean; // supplies
  target: number | null; // m to it; null if it is not known
  seconds: number; // since the last picture
}

// What there is to do in a match.
export interface Needs {
  track: string;
  weapon: boolean;
  supplies: boolean;
}

interface Lesson {
  name: string;
  acts: Act[]; // by whose keys it is done
  words: (keys: string) => string;
  touch: string; // the words for fingers
  isFor?: (needs: Needs) => boolean;
  // How much of it is done by what was done; 1 is all.
  share: (did: Did, before: Did) => number;
}

const ENOUGH = { turn: 90, walk: 5, nearer: 10, zone: 6 }; // degrees, m, m, s
const LESSONS: Lesson[] = [
  {
    name: "look",
    acts: [],
    words: () => "Look around with the mouse",
    touch: "Swipe over the picture to look around",
    share: ({ turned }) => turned / ENOUGH.turn,
  },
  {
    name: "walk",
    acts: ["forward", "left", "back", "right"],
    words: (keys) => `Walk with ${keys}`,
    touch: "Walk with the stick on the left",
    share: ({ walked }) => walked / ENOUGH.walk,
  },
  {
    name: "jump",
    acts: ["jump"],
    words: (keys) => `Jump with ${keys}`,
    touch: "Press Jump",
    share: ({ jumped }) => Number(jumped),
  },
  {
    name: "target",
    acts: [],
    words: () => "Go where ◆ is on the compass",
    touch: "Go where ◆ is on the compass",
    isFor: ({ track }) => track === "navigation", // that of capture is hidden
    share: ({ target }, before) =>
      target === null || before.target === null ? 0 : Math.max(0, before.target - target) / ENOUGH.nearer,
  },
  {
    name: "pick_up",
    acts: ["pick_up"],
    words: (keys) => `Go to a box, ▪ on the compass, and take it with ${keys}`,
    touch: "Go to a box, ▪ on the compass, and press Pick up",
    isFor: ({ supplies }) => supplies,
    share: ({ gained }) => Number(gained),
  },
  {
    name: "shoot",
    acts: ["shoot"],
    words: (keys) => `Shoot with ${keys}`,
    touch: "Press Shoot",
    isFor: ({ weapon }) => weapon,
    share: ({ fired }) => Number(fired),
  },
  {
    name: "reload",
    acts: ["reload"],
    words: (keys) => `Reload with ${keys}`,
    touch: "Press Reload",
    isFor: ({ weapon }) => weapon,
    share: ({ reloads }) => Number(reloads),
  },
  {
    name: "zone",
    acts: [],
    words: () => "Stay inside the safe zone: outside it you lose health",
    touch: "Stay inside the safe zone: outside it you lose health",
    isFor: ({ track }) => track === "royale",
    share: ({ seconds }) => seconds / ENOUGH.zone,
  },
];

// The steps of one match that a person has not done yet.
export class Lessons {
  private readonly left: Lesson[];
  private done = 0; // share of the present one
  private before: Did | null = null;

  // known: names of steps that were done before.
  constructor(
    needs: Needs,
    readonly known: Set<string>,
  ) {
    this.left = LESSONS.filter(({ name, isFor }) => !known.has(name) && (isFor?.(needs) ?? true));
  }

  // What to do now; null after the last step.
  words(bindings: Bindings, isTouched: boolean): string | null {
    const [lesson] = this.left;
    if (!lesson) return null;
    const keys = lesson.acts.map((act) => bindings.keysOf(act)[0]).filter(Boolean);
    return isTouched ? lesson.touch : lesson.words(keys.join(" "));
  }

  // Take what was done, and return whether that ends a step.
  take(did: Did): boolean {
    const [lesson] = this.left;
    this.done += lesson?.share(did, this.before ?? did) ?? 0;
    this.before = did;
    if (!lesson || this.done < 1 - 1e-9) return false;
    this.done = 0;
    this.known.add(lesson.name);
    this.left.shift();
    return true;
  }

  skip(): void {
    for (const { name } of this.left) this.known.add(name);
    this.left.length = 0;
  }
}
