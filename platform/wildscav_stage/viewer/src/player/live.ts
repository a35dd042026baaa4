// Follows a match that is being played: tells its beginning and its news until it is over.

import type { StreamEvent } from "../data/stream";
import { type News, readTrails, type Trails } from "../data/trails";
import { pause, RETRY, Refusal, type Source } from "./loading";

export interface Listener {
  begin(trails: Trails, news: News[]): void; // of a match that begins, or begins anew
  extend(news: News[]): void;
  say(text: string): void; // empty when all is well again
  isWanted(): boolean;
}

export class Broadcast {
  private last = ""; // the id of the last event
  private begun: Trails | null = null; // a beginning without news
  private isOver = false;

  constructor(
    private readonly source: Source,
    private readonly listener: Listener,
  ) {}

  // Follow the match until it is over, or may not be watched anymore; then it throws a Refusal.
  async follow(): Promise<void> {
    while (!this.isOver && this.listener.isWanted()) {
      if (document.hidden) await shown();
      const ending = new AbortController();
      const hide = () => document.hidden && ending.abort();
      document.addEventListener("visibilitychange", hide);
      try {
        await this.source.follow((events) => this.hear(events), this.last, ending.signal);
        if (!this.isOver) await this.retry("The connection is lost");
      } catch (error) {
        if (error instanceof Refusal) throw error;
        if (!document.hidden) await this.retry((error as Error).message);
      } finally {
        document.removeEventListener("visibilitychange", hide);
      }
    }
  }

  private hear(events: StreamEvent[]): void {
    this.listener.say("");
    let news: News[] = [];
    for (const { id, kind, data } of events) {
      if (id) this.last = id;
      if (kind === "begin") [this.begun, news] = [readTrails(data), []];
      else if (kind === "news") news.push(JSON.parse(data));
      else if (kind === "over") this.isOver = true;
      else if (kind === "hidden") throw new Refusal(JSON.parse(data));
    }
    if (!news.length) return;
    if (this.begun) this.listener.begin(this.begun, news);
    else this.listener.extend(news);
    this.begun = null;
  }

  private async retry(why: string): Promise<void> {
    this.listener.say(`${why}; trying again …`);
    await pause(RETRY);
  }
}

// Whoever looks at another page is sent nothing, and what they missed when they come back.
const shown = () =>
  new Promise<void>((resolve) => {
    document.addEventListener("visibilitychange", () => resolve(), { once: true });
  });
