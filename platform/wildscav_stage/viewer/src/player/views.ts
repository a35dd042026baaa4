// From where a match is seen, and whom one follows: what buttons, keys, names in the standings and links ask for.

import type { Course } from "../data/course";
import type { Seat } from "../data/trails";
import { TRAIL, type View, type ViewKind } from "../stage";
import { followsSeat, type Moment, writeMoment } from "./address";
import { Director } from "./director";
import type { Screen } from "./screen";

// What is shown of the view outside the picture.
export interface Told {
  kinds: ViewKind[];
  hasInset: boolean;
  hasTrail: boolean;
  view: View;
  isDirected: boolean; // whoever has most to do is followed
  isInset: boolean;
}

export class Views {
  private readonly director: Director;
  private isDirected: boolean;
  private isInset = false;
  private trail = TRAIL; // s

  // tell: told whenever something of it changes.
  constructor(
    private readonly course: Course,
    private readonly screen: Screen,
    private readonly tell: (told: Told) => void,
  ) {
    const entered = course.seats.filter(isSubmission);
    const seat = entered[0] ?? course.seats[0];
    this.director = new Director(course);
    this.isDirected = entered.length > 1;
    screen.wanted = { kind: "behind", seat: seat?.seat ?? 0 };
    screen.onStage = () => this.showStage();
  }

  // The seat that is followed; null if none is.
  get seat(): number | null {
    const { kind, seat } = this.screen.view;
    return followsSeat(kind) ? seat : null;
  }

  // Take in the events that have come since.
  extend(): void {
    this.director.update();
  }

  // Take over a stage, or say that there is none.
  showStage(): void {
    const { stage } = this.screen;
    if (stage && stage.trail !== undefined) stage.trail = this.trail;
    this.set(this.screen.view);
  }

  look(kind: ViewKind): void {
    this.set({ ...this.screen.view, kind });
  }

  next(): void {
    const { kinds, view } = this.screen;
    if (kinds.length) this.look(kinds[(kinds.indexOf(view.kind) + 1) % kinds.length]);
  }

  follow(seat: number): void {
    if (seat >= this.course.seats.length) return;
    this.isDirected = false;
    this.set({ kind: this.followingKind, seat });
  }

  // A second click on whom one follows lets go of them.
  followOrLeave(seat: number): void {
    const { kind, seat: followed } = this.screen.view;
    const isPinned = seat === followed && followsSeat(kind) && !this.isDirected;
    if (isPinned && this.screen.kinds.includes("free")) this.look("free");
    else this.follow(seat);
  }

  // Follow whoever has most to do.
  direct(): void {
    this.isDirected = this.course.seats.length > 1;
    this.look(this.followingKind);
  }

  // Cut to whoever has most to do in a frame, if they are followed.
  cut(frame: number): void {
    const { view } = this.screen;
    const seat = this.director.at(frame);
    if (this.isDirected && seat !== view.seat) this.set({ ...view, seat });
  }

  setTrail(seconds: number): void {
    this.trail = seconds;
    this.showStage();
  }

  toggleInset(): void {
    if (this.screen.stage?.inset === undefined) return;
    this.isInset = !this.isInset;
    this.set(this.screen.view);
  }

  // Look as a link says.
  goTo({ view, seat }: Moment): void {
    const now = this.screen.view;
    const isKnown = seat !== null && seat < this.course.seats.length;
    if (isKnown) this.isDirected = false;
    else if (view && followsSeat(view)) this.isDirected = this.course.seats.length > 1;
    this.set({ kind: view ?? now.kind, seat: isKnown ? seat : now.seat });
  }

  link(seconds: number): string {
    return writeMoment(seconds, this.screen.view, !this.isDirected);
  }

  private get followingKind(): ViewKind {
    return this.screen.view.kind === "eyes" ? "eyes" : "behind";
  }

  private set(wanted: View): void {
    this.screen.look(wanted);
    const { stage, view, kinds } = this.screen;
    const { isDirected, isInset } = this;
    const hasInset = stage?.inset !== undefined;
    this.screen.showInset(hasInset && isInset && view.kind !== "eyes" ? view.seat : null);
    const hasTrail = stage?.trail !== undefined && view.kind === "above";
    this.tell({ kinds, hasInset, hasTrail, view, isDirected, isInset });
  }
}

function isSubmission(seat: Seat): boolean {
  return seat.kind === "submission";
}
