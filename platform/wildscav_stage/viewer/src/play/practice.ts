// What a person hits, as the shooting range shows it.

import { FRAMES, type Metric, type Now, type ScoreRow } from "./messages";

interface Target {
  hits: number;
  kills: number;
  first: number | null; // frame of the first hit since it stands there; null before that
  times: number[]; // s from the first hit to the kill
}

export const METRICS: Metric[] = [
  { title: "hits", unit: "" },
  { title: "kills", unit: "" },
  { title: "time to kill", unit: "s" },
];

export class Practice {
  shots = 0;
  hits = 0;
  private readonly targets = new Map<number, Target>();

  constructor(private readonly seat: number) {}

  note({ frame, shots, hits, deaths }: Now): void {
    this.shots += (shots ?? []).filter(([shooter]) => shooter === this.seat).length;
    for (const seat of hits ?? []) {
      const target = this.target(seat);
      this.hits += 1;
      target.hits += 1;
      target.first ??= frame;
    }
    for (const [seat, by] of deaths ?? []) {
      const target = this.target(seat);
      if (by === this.seat && target.first !== null) {
        target.kills += 1;
        target.times.push((frame - target.first) / FRAMES);
      }
      target.first = null;
    }
  }

  get kills(): number {
    return this.all.reduce((sum, { kills }) => sum + kills, 0);
  }

  // %, of the shots that were fired; null before the first one.
  get accuracy(): number | null {
    return this.shots ? Math.round((100 * this.hits) / this.shots) : null;
  }

  // s from a first hit to the kill, on average; null before the first kill.
  get timeToKill(): number | null {
    return mean(this.all.flatMap(({ times }) => times));
  }

  // The figures of some seats by METRICS, in the order of the seats.
  rows(names: string[]): ScoreRow[] {
    const others = names.map((name, seat) => ({ seat, name })).filter(({ seat }) => seat !== this.seat);
    return others.map(({ seat, name }) => {
      const { hits, kills, times } = this.target(seat);
      return { seat, name, values: [hits, kills, mean(times)] };
    });
  }

  // What it came to, in one sentence.
  get summary(): string {
    const share = this.accuracy === null ? "" : ` (${this.accuracy} %)`;
    return `${this.hits} of ${this.shots} shots hit${share}`;
  }

  private get all(): Target[] {
    return [...this.targets.values()];
  }

  private target(seat: number): Target {
    const found = this.targets.get(seat) ?? { hits: 0, kills: 0, first: null, times: [] };
    this.targets.set(seat, found);
    return found;
  }
}

function mean(values: number[]): number | null {
  return values.length ? values.reduce((sum, value) => sum + value, 0) / values.length : null;
}
