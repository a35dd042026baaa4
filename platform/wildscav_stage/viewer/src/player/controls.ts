// The buttons below the picture.

import type { Seat } from "../data/trails";
import { TRAIL, type ViewKind } from "../stage";
import { followsSeat } from "./address";
import { type Clock, SPEEDS } from "./clock";
import { iconButton, make, picker, rename, setIcon } from "./dom";
import type { Told } from "./views";

const VIEW_TITLES: Record<ViewKind, string> = {
  behind: "Behind",
  eyes: "Eyes",
  above: "Above",
  free: "Free",
};
const VIEW_HINTS: Record<ViewKind, string> = {
  behind: "From behind an agent",
  eyes: "Through an agent's eyes",
  above: "From above",
  free: "From anywhere: drag, scroll, or use the arrow keys on the picture",
};
const TRAILS: [string, number][] = [
  ["no trails", 0],
  ["trails 10 s", 10],
  ["trails 30 s", 30],
  ["trails 2 min", 120],
  ["all trails", Number.POSITIVE_INFINITY],
];
const DIRECTED = "directed";

// What buttons and keys can do.
export interface Actions {
  toggle(): void;
  leap(seconds: number): void;
  step(direction: 1 | -1): void;
  jump(direction: 1 | -1): void;
  setSpeed(speed: number): void;
  changeSpeed(direction: 1 | -1): void;
  look(kind: ViewKind): void;
  nextView(): void;
  follow(seat: number): void;
  direct(): void;
  followLive(): void;
  setTrail(seconds: number): void;
  toggleInset(): void;
  toggleFullscreen(): void;
  copyLink(): void;
  help(): void;
}

export class Controls {
  readonly element: HTMLElement;
  readonly status = make("span", { className: "player-said", role: "status" });
  private readonly play: HTMLButtonElement;
  private readonly live: HTMLButtonElement;
  private readonly inset: HTMLButtonElement;
  private readonly time = make("span");
  private readonly behind = make("span", { className: "player-behind" });
  private readonly speed: HTMLSelectElement;
  private readonly seat: HTMLSelectElement;
  private readonly trail: HTMLSelectElement;
  private readonly views = make("div", { className: "player-views", role: "group" });
  private viewButtons = new Map<ViewKind, HTMLButtonElement>();

  constructor(
    seats: Seat[],
    private readonly actions: Actions,
  ) {
    this.play = iconButton("play", "Play", () => actions.toggle());
    this.play.classList.add("player-play");
    this.live = make("button", { type: "button", className: "player-live", textContent: "Live" });
    this.live.onclick = () => actions.followLive();
    rename(this.live, "Live: go to the present moment of the match");
    this.inset = iconButton("inset", "Show the eyes of the agent in a corner", () => actions.toggleInset());
    const speeds = SPEEDS.map((speed): [string, number] => [`${speed}×`, speed]);
    this.speed = picker("Speed", speeds, 1, (value) => actions.setSpeed(Number(value)));
    const names = seats.map(({ seat, name }): [string, string | number] => [`${seat} · ${name}`, seat]);
    if (seats.length > 1) names.unshift(["most to do", DIRECTED]);
    this.seat = picker("Follow", names, 0, (value) =>
      value === DIRECTED ? actions.direct() : actions.follow(Number(value)),
    );
    this.seat.classList.add("player-follow");
    this.trail = picker("Trails", TRAILS, TRAIL, (value) => actions.setTrail(Number(value)));
    this.views.setAttribute("aria-label", "View");
    this.inset.hidden = this.trail.hidden = this.views.hidden = true;
    this.element = make("div", { className: "player-buttons" }, this.times(), this.extras(), this.looks());
  }

  showView({ kinds, hasInset, hasTrail, view, isDirected, isInset }: Told): void {
    this.offer(kinds);
    for (const [kind, button] of this.viewButtons) {
      button.setAttribute("aria-pressed", String(kind === view.kind));
    }
    this.seat.value = isDirected ? DIRECTED : String(view.seat);
    this.inset.setAttribute("aria-pressed", String(isInset));
    this.seat.hidden = !kinds.some(followsSeat);
    this.inset.hidden = !hasInset;
    this.trail.hidden = !hasTrail;
  }

  // lag: s that the picture is behind a match that is being played.
  update(clock: Clock, text: string, isAtEnd: boolean, lag: number): void {
    const isMoving = clock.isPlaying || clock.isFollowingLive;
    setIcon(this.play, isMoving ? "pause" : isAtEnd ? "again" : "play");
    rename(this.play, isMoving ? "Pause" : isAtEnd ? "Play again" : "Play");
    if (this.time.textContent !== text) this.time.textContent = text;
    this.speed.value = String(clock.speed);
    const behind = `${Math.round(lag)} s behind`;
    if (this.behind.textContent !== behind) this.behind.textContent = behind;
    this.live.hidden = this.behind.hidden = !clock.isOpen;
    this.live.setAttribute("aria-pressed", String(clock.isFollowingLive));
  }

  // Have buttons for the views that the stage has.
  private offer(kinds: ViewKind[]): void {
    const order = (Object.keys(VIEW_TITLES) as ViewKind[]).filter((kind) => kinds.includes(kind));
    if (order.join() === [...this.viewButtons.keys()].join()) return;
    this.viewButtons = new Map(order.map((kind) => [kind, this.viewButton(kind)]));
    this.views.replaceChildren(...this.viewButtons.values());
    this.views.hidden = order.length < 2;
  }

  private times(): HTMLElement {
    const { actions } = this;
    return make(
      "div",
      { className: "player-times" },
      this.play,
      iconButton("eventBack", "Previous event", () => actions.jump(-1)),
      iconButton("back", "Back 5 seconds", () => actions.leap(-5)),
      iconButton("stepBack", "One step back", () => actions.step(-1)),
      iconButton("stepOn", "One step on", () => actions.step(1)),
      iconButton("on", "On 5 seconds", () => actions.leap(5)),
      iconButton("eventOn", "Next event", () => actions.jump(1)),
      make("span", { className: "player-time" }, this.time, this.behind),
      this.live,
    );
  }

  private extras(): HTMLElement {
    const { actions } = this;
    const fullscreen = iconButton("full", "Fullscreen", () => actions.toggleFullscreen());
    fullscreen.hidden = !document.fullscreenEnabled;
    return make(
      "div",
      { className: "player-extras" },
      this.speed,
      this.inset,
      iconButton("link", "Copy a link to this moment", () => actions.copyLink()),
      iconButton("help", "Keys", () => actions.help()),
      fullscreen,
    );
  }

  private looks(): HTMLElement {
    return make("div", { className: "player-looks" }, this.views, this.seat, this.trail, this.status);
  }

  private viewButton(kind: ViewKind): HTMLButtonElement {
    const onclick = () => this.actions.look(kind);
    return make("button", {
      type: "button",
      textContent: VIEW_TITLES[kind],
      title: VIEW_HINTS[kind],
      onclick,
    });
  }
}
