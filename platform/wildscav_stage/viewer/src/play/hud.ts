// What is shown over the picture while a match is played.

import type { Course } from "../data/course";
import { clockText } from "../player/clock";
import { make } from "../player/dom";
import { type Bearing, bearingOf, type Place } from "./bearing";
import type { Act, Bindings } from "./bindings";
import { find } from "./dom";
import { turned } from "./live_course";
import { type Begin, CAN_PICK_UP, FRAMES, type Metric, type Own, type ScoreRow } from "./messages";
import type { Practice } from "./practice";

const VIEW = 130; // degrees that the compass shows
const POINTS: Record<number, string> = {
  0: "N",
  45: "NE",
  90: "E",
  135: "SE",
  180: "S",
  225: "SW",
  270: "W",
  315: "NW",
};
const MOST_BOXES = 8; // that the compass shows, the nearest ones
const FLASH = 140; // ms
const NOTICE = 1400; // ms
const FEED = 7000; // ms for which a kill is shown
const ENDLESS = 10_000; // rounds that nobody uses up
const TORSO = 2; // the part of a body that has the colour of its team

export class Hud {
  private begun!: Begin;
  private seat: number | null = null; // one's own, or the one whose eyes a spectator sees through
  private watches = false;
  private wasShot = false; // whether somebody did it when one died last
  private clearing = 0;
  private readonly points: [number, HTMLElement][];

  // bindings: by which keys one plays; null for a spectator.
  constructor(private readonly bindings: Bindings | null = null) {
    this.points = Array.from({ length: 24 }, (_, index) => {
      const point = document.createElement("span");
      point.textContent = POINTS[index * 15] ?? "·";
      point.className = index % 3 ? "minor" : "";
      find("points").append(point);
      return [index * 15, point];
    });
  }

  begin(begun: Begin, seat: number | null, watches = false): void {
    [this.begun, this.seat, this.watches] = [begun, seat, watches];
    find("feed").replaceChildren();
    this.notice("");
    if (!watches) this.showFall([]);
  }

  showTime(frame: number): void {
    find("clock").textContent = clockText(Math.max(0, this.begun.frame_limit - frame) / FRAMES);
  }

  // here: where one is and looks, as it is shown.
  show(own: Own, here: Place & { yaw: number }, course: Course): void {
    find("compass").dataset.yaw = turned(here.yaw).toFixed(1);
    const { target, boxes } = course.trails;
    const toward = (place: Place) => bearingOf(here, { x: place.x / 100, z: place.z / 100 });
    const near = boxes.map(toward).filter((box) => box.distance <= this.begun.rules.supply_sight);
    near.sort((a, b) => a.distance - b.distance);
    this.showCompass(here.yaw, near.slice(0, MOST_BOXES), target && toward(target));
    this.showGoal(own, here.yaw, target && toward(target));
    this.showVitals(own);
  }

  private place(element: HTMLElement, bearing: number, yaw: number, keep = false): void {
    const away = turned(bearing - yaw);
    const share = keep ? Math.max(-0.48, Math.min(0.48, away / VIEW)) : away / VIEW;
    element.hidden = Math.abs(share) > 0.5;
    element.style.left = `${50 + share * 100}%`;
  }

  private showCompass(yaw: number, boxes: Bearing[], target: Bearing | null): void {
    for (const [bearing, point] of this.points) this.place(point, bearing, yaw);
    const marks: [string, string, Bearing][] = boxes.map((box) => ["box", "▪", box]);
    if (target) marks.push(["target", "◆", target]);
    const drawn = find("marks");
    while (drawn.children.length > marks.length) drawn.lastChild?.remove();
    marks.forEach(([kind, sign, { bearing }], index) => {
      const mark = (drawn.children[index] ?? drawn.appendChild(document.createElement("b"))) as HTMLElement;
      mark.className = kind;
      mark.textContent = sign;
      this.place(mark, bearing, yaw, kind === "target");
    });
  }

  private showGoal(own: Own, yaw: number, target: Bearing | null): void {
    const goal = find("goal");
    if (!target) {
      goal.textContent =
        own.flags & CAN_PICK_UP && !this.watches ? `${this.keyOf("pick_up")}pick up supplies` : "";
      return;
    }
    const angle = Math.round(turned(target.bearing - yaw));
    const way = Math.abs(angle) < 8 ? "ahead" : `${Math.abs(angle)}° ${angle > 0 ? "right" : "left"}`;
    goal.textContent = `◆ target ${target.distance.toFixed(0)} m, ${way}`;
    goal.dataset.angle = String(angle);
    goal.dataset.distance = target.distance.toFixed(1);
  }

  private showVitals(own: Own): void {
    const full = this.begun.seats[this.seat ?? 0].full_health;
    find("health").classList.toggle("low", own.health <= 0.3 * full);
    find("health b").textContent = String(own.health);
    find("health .bar i").style.transform = `scaleX(${Math.min(1, own.health / full)})`;
    find("supplies b").textContent = String(own.supplies);
    find("ammo").classList.toggle("low", own.clip <= 3);
    find("ammo b").textContent = String(own.clip);
    find("ammo small").textContent = own.reload
      ? `reloading ${(own.reload / FRAMES).toFixed(1)} s`
      : own.spare < ENDLESS
        ? `/ ${own.spare} spare`
        : "rounds without end";
    const said = this.saidOf(own);
    if (said) this.notice(said, 200);
  }

  private saidOf({ health, respawn, invincible, clip, reload }: Own): string {
    const seconds = (frames: number) => `${Math.ceil(frames / FRAMES)} s`;
    if (this.watches) return health > 0 ? "" : "dead";
    const died = this.wasShot ? "" : "You are dead. ";
    if (health <= 0) return died + (respawn ? `Back in ${seconds(respawn)}` : "You are out");
    if (invincible) return `Nobody can hurt you for ${seconds(invincible)}`;
    return clip === 0 && !reload && this.begun.weapon ? `Empty. ${this.keyOf("reload")}reload` : "";
  }

  private keyOf(act: Act): string {
    const [key] = this.bindings?.keysOf(act) ?? [];
    return key ? `${key}: ` : "";
  }

  flash(id: string, name: string): void {
    find(id).classList.add(name);
    setTimeout(() => find(id).classList.remove(name), FLASH);
  }

  // Show from where one was hit: degrees to the right of the view, or null if that is not known.
  showHurt(angle: number | null): void {
    this.flash("hurt", "on");
    if (angle === null) return;
    find("hurt-from").style.rotate = `${angle}deg`;
    this.flash("hurt-from", "on");
  }

  notice(text: string, time = NOTICE): void {
    if (find("notice").textContent !== text) find("notice").textContent = text; // it is read out
    clearTimeout(this.clearing);
    this.clearing = setTimeout(() => {
      find("notice").textContent = "";
    }, time);
  }

  // Say how one died until one is back.
  showFall(lines: string[]): void {
    find("fallen").replaceChildren(...lines.map((line) => make("p", {}, line)));
  }

  // Show for a while who killed whom.
  showDeath(seat: number, by: number): void {
    const line = document.createElement("li");
    const nobody = by < 0 || by === seat;
    line.append(...(nobody ? [this.nameOf(seat), " died"] : [this.nameOf(by), " shot ", this.nameOf(seat)]));
    line.classList.toggle("own", !this.watches && (seat === this.seat || by === this.seat));
    find("feed").append(line);
    setTimeout(() => line.remove(), FEED);
    if (this.watches) return;
    if (seat === this.seat) this.wasShot = !nobody;
    else if (by === this.seat) this.notice(`You shot ${this.begun.seats[seat].name}`);
  }

  private nameOf(seat: number): HTMLElement {
    const name = document.createElement("b");
    name.textContent = seat === this.seat && !this.watches ? "you" : this.marked(seat);
    name.style.color = this.colorOf(seat);
    return name;
  }

  // The name of a seat, after the mark of its team where there is one.
  private marked(seat: number): string {
    const { mark, name } = this.begun.seats[seat];
    return mark ? `${mark} ${name}` : name;
  }

  // Show whom one aims at; null is nobody.
  showAim(seat: number | null): void {
    const aim = find("aim");
    const text = seat === null ? "" : this.marked(seat);
    if (aim.textContent === text) return;
    aim.textContent = text;
    if (seat !== null) aim.style.color = this.colorOf(seat);
  }

  private colorOf(seat: number): string {
    return lightened(this.begun.seats[seat].colors[TORSO]);
  }

  // Show the scores of all, the best first.
  showScores(all: ScoreRow[]): void {
    const rows = all.map((row) => ({ ...row, name: this.marked(row.seat) }));
    find("scores").hidden = rows.length < 2;
    const titles = this.begun.metrics.map(({ title }) => title);
    fillTable(find("scores"), titles, rows, this.seat, 6, this.watches ? null : "you");
  }

  // Show what one has hit at the shooting range.
  showPractice({ shots, hits, kills, accuracy, timeToKill }: Practice): void {
    const figures: [string, string][] = [
      [`${hits} of ${shots}`, "shots hit"],
      [accuracy === null ? "–" : `${accuracy} %`, "accuracy"],
      [String(kills), kills === 1 ? "kill" : "kills"],
      [timeToKill === null ? "–" : `${timeToKill.toFixed(1)} s`, "time to kill"],
    ];
    const items = figures.map(([value, name]) =>
      make("div", {}, make("dd", {}, value), make("dt", {}, name)),
    );
    find("practice").replaceChildren(...items);
  }

  showPace(ping: number | null, rate: number, error: number | null): void {
    const between = ping === null ? "" : `ping ${ping} ms, `;
    find("delay").textContent = `${between}${rate} pictures a second`;
    Object.assign(find("delay").dataset, {
      ping: ping ?? "",
      rate: String(rate),
      error: error?.toFixed(3) ?? "",
    });
  }
}

// Fill a table with the metrics of seats; own is the seat to stress.
export function fillTable(
  shown: HTMLElement,
  titles: string[],
  rows: ScoreRow[],
  own: number | null,
  most = Infinity,
  ownName: string | null = "you",
): void {
  const table = shown as HTMLTableElement;
  const row = (cells: string[], name: "td" | "th") => {
    const line = document.createElement("tr");
    for (const textContent of cells) line.append(make(textContent ? name : "td", { textContent }));
    return line;
  };
  const best = rows.slice(0, most);
  const mine = rows.find(({ seat }) => seat === own);
  if (mine && !best.includes(mine)) best[best.length - 1] = mine;
  const written = (value: number | null) =>
    value === null ? "–" : Number.isInteger(value) ? String(value) : value.toFixed(2);
  table.tHead?.replaceChildren(row(["", ...titles], "th"));
  table.tBodies[0].replaceChildren(
    ...best.map(({ seat, name, values }) => {
      const line = row([seat === own ? (ownName ?? name) : name, ...values.map(written)], "td");
      line.className = seat === own ? "own" : "";
      return line;
    }),
  );
}

// A colour for letters on a dark ground: dark ones are mixed with white.
function lightened(color: [number, number, number]): string {
  const [red, green, blue] = color;
  const share = Math.max(0, 0.5 - (0.3 * red + 0.6 * green + 0.1 * blue) / 255);
  return `rgb(${color.map((value) => Math.round(value + share * (255 - value))).join(" ")})`;
}

export function titlesOf(metrics: Metric[]): string[] {
  return metrics.map(({ title, unit }) => (unit ? `${title} (${unit})` : title));
}
