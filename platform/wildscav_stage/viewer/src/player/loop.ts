// When a player draws: as time passes, when something has changed, and while its camera moves; and only where it is seen.

import type { Clock } from "./clock";

const CALM = 500; // ms between two live pictures for people who asked for less motion

// What a loop asks of its player.
export interface Drawn {
  readonly isCameraMoving: boolean; // by itself
  draw(now: number, isStale: boolean): void;
  dispose(): void;
}

export class Loop {
  private readonly calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  private readonly watcher: IntersectionObserver;
  private readonly wake = () => this.ask();
  private isOnPage = true; // as far as one has scrolled
  private request = 0;
  private drawnTime = -1; // s of the match
  private drawnAt = 0; // ms
  private isStale = true; // what is shown differs from what is
  private isStirred = false; // a person moved the camera

  constructor(
    private readonly root: HTMLElement,
    private readonly clock: Clock,
    private readonly player: Drawn,
  ) {
    this.watcher = new IntersectionObserver((entries) => this.see(entries));
    this.watcher.observe(root);
    document.addEventListener("visibilitychange", this.wake);
  }

  get isCalm(): boolean {
    return this.calm.matches;
  }

  // Something has changed: draw everything anew.
  refresh(): void {
    this.isStale = true;
    this.ask();
  }

  // A person moved the camera: draw the picture anew.
  stir(): void {
    this.isStirred = true;
    this.ask();
  }

  dispose(): void {
    cancelAnimationFrame(this.request);
    this.watcher.disconnect();
    document.removeEventListener("visibilitychange", this.wake);
  }

  private see(entries: IntersectionObserverEntry[]): void {
    this.isOnPage = entries[entries.length - 1].isIntersecting;
    if (this.root.isConnected) this.ask();
    else this.player.dispose();
  }

  // Whoever scrolls or switches away sees nothing, so nothing is drawn, and time stands still.
  private ask(): void {
    const isSeen = this.isOnPage && document.visibilityState === "visible";
    if (isSeen && !this.request) this.request = requestAnimationFrame((now) => this.tick(now));
  }

  private tick(now: number): void {
    this.request = 0;
    this.clock.advance(now);
    if (this.isDue(now)) this.draw(now);
    if (this.clock.isRunning || this.player.isCameraMoving) this.ask();
    else this.clock.rest();
  }

  private isDue(now: number): boolean {
    const isHeld = this.clock.isFollowingLive && this.isCalm && now - this.drawnAt < CALM;
    const isLater = this.clock.seconds !== this.drawnTime && !isHeld;
    return this.isStale || this.isStirred || isLater || this.player.isCameraMoving;
  }

  private draw(now: number): void {
    const { isStale } = this;
    this.isStale = this.isStirred = false;
    this.drawnAt = now;
    this.drawnTime = this.clock.seconds;
    this.player.draw(now, isStale);
  }
}
