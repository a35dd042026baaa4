// One match of the person: what they are told, what they do, and the picture of both.

import type { WebGLRenderer } from "three";
import type { GameMap } from "../data/map";
import { METRE } from "../data/trails";
import { heightAt } from "../view/terrain";
import { createStage } from "../world";
import { bearingOf } from "./bearing";
import { Clock } from "./clock";
import type { Input } from "./controls";
import { find } from "./dom";
import { Hits, turnedTo, wordsOf } from "./fall";
import type { Hud } from "./hud";
import { SeenCourse, turned } from "./live_course";
import { type Begin, FRAMES, type Now, type Own, ownOf, type Table } from "./messages";
import { Practice } from "./practice";
import { Prediction } from "./prediction";
import { Picture } from "./scene";
import type { Settings } from "./settings";
import type { Sounds } from "./sounds";
import { Weapon } from "./weapon";

const BEHIND = 3; // frames and one step that others are shown in the past
const EXPECTED = 0.6; // s within which a shot is told that was shown already
const ASPECT = 9 / 16; // how far agents see up and down, of how far they see across

export class Match {
  own: Own | null = null;
  readonly practice: Practice;
  private readonly course: SeenCourse;
  private readonly prediction: Prediction;
  private readonly picture: Picture;
  private readonly clock: Clock;
  private readonly weapon = new Weapon();
  private readonly hits = new Hits();
  private readonly isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  private firedAt = -Infinity; // ms
  private diedAt: number | null = null; // likewise; null while one lives
  private seconds = 0; // since the last picture
  private ping: number | null = null;

  constructor(
    private readonly begin: Begin,
    private readonly table: Table,
    private readonly seat: number,
    map: GameMap,
    private readonly settings: Settings,
    private readonly hud: Hud,
    private readonly sounds: Sounds,
    lose: () => void, // called if the browser no longer draws
  ) {
    this.clock = new Clock(BEHIND + begin.frames_per_action);
    this.course = new SeenCourse(begin, table.track, seat);
    this.practice = new Practice(seat);
    this.prediction = new Prediction(begin.rules, (x, z) => heightAt(map.ground, x, z));
    const over = (renderer: WebGLRenderer) => this.drawWeapon(renderer);
    const options = { hasLabels: false, over };
    this.picture = new Picture(map, this.course, (...all) => createStage(...all, options), lose);
  }

  // Note an input that is sent.
  send(number: number, input: Input): void {
    this.prediction.send(number, input, performance.now());
  }

  // Take a moment, and show and sound what happened.
  take(moment: Now): void {
    this.learn(moment, performance.now());
    this.tell(moment);
  }

  // Take a moment that came at a time.
  learn(moment: Now, now: number): void {
    this.own = ownOf(moment.own);
    this.ping = moment.ping;
    this.clock.note(moment.frame, now);
    this.prediction.take(this.own, moment.frame, moment.input, now, moment.ahead);
    this.course.learn(moment, this.clock.frame(now));
    this.hud.showTime(moment.frame);
  }

  pause(isPaused: boolean): void {
    this.prediction.pause(isPaused);
  }

  // Draw the picture of now, some ms after the last one, while something is held.
  draw(input: Input, now: number, length: number): void {
    if (!this.own) return;
    this.seconds = length / 1000;
    this.prediction.advance(input, length, now);
    this.fire(input, now);
    const [x, y, z] = this.prediction.place;
    const { yaw, pitch } = this.prediction;
    const { health, supplies } = this.own;
    this.course.own = { x, y, z, yaw, pitch, health, supplies };
    const kind = this.lookDead(now) ? "behind" : "eyes";
    const { view_angle: angle } = this.begin.rules; // what is farther aside, or up or down, is not told
    const across = Math.min(this.settings.field, angle);
    this.picture.stage.view = { kind, seat: this.seat, across, tall: ASPECT * angle };
    this.picture.draw(this.clock.frame(now), now);
    this.hud.show(this.own, { x, z, yaw }, this.course);
    this.hud.showAim(
      health > 0 ? this.course.aimedAt(this.clock.frame(now)) : (this.course.killer?.seat ?? null),
    );
    this.showPace();
    find("game").toggleAttribute("data-dead", health <= 0);
    find("picture").dataset.place = this.prediction.place.map((part) => part.toFixed(3)).join();
  }

  // Let the dead look at who shot them; return whether nobody is known to look at.
  private lookDead(now: number): boolean {
    const { own, killer } = this.course;
    if (own.health > 0) {
      if (this.diedAt !== null) this.hud.showFall([]);
      this.diedAt = null;
      return false;
    }
    this.diedAt ??= now;
    if (!killer) return true;
    Object.assign(own, turnedTo(killer, own, this.isCalm ? Infinity : now - this.diedAt));
    return false;
  }

  // Where one is shown, m.
  get spot(): readonly [number, number, number] {
    return this.prediction.place;
  }

  // m to the target; null if it is not known.
  get targetDistance(): number | null {
    const { target } = this.course.trails;
    const [x, , z] = this.spot;
    return target && bearingOf({ x, z }, { x: target.x / METRE, z: target.z / METRE }).distance;
  }

  dispose(): void {
    this.weapon.dispose();
    this.picture.dispose();
  }

  private tell(moment: Now): void {
    for (const [seat, x, , z] of moment.shots ?? []) this.tellShot(seat, x / METRE, z / METRE);
    for (const _ of moment.hits ?? []) {
      this.hud.flash("crosshair", "hit");
      this.sounds.hit();
    }
    for (const seat of moment.hurt ?? []) {
      const shooter = moment.others?.find((other) => other[0] === seat);
      this.hud.showHurt(shooter ? this.angleTo(shooter[1] / METRE, shooter[3] / METRE) : null);
      this.sounds.hurt();
    }
    this.hits.note(moment);
    this.practice.note(moment);
    if (this.table.is_range) this.hud.showPractice(this.practice);
    for (const [seat, by] of moment.deaths ?? []) {
      this.hud.showDeath(seat, by);
      if (seat === this.seat) this.tellFall(by);
    }
    if (moment.gained) {
      this.hud.notice(`+${moment.gained} supplies`);
      this.sounds.gain();
    }
  }

  private tellFall(by: number): void {
    const { killer } = this.course;
    const [x, , z] = this.prediction.place;
    const words = by < 0 ? [] : wordsOf(this.begin.seats[by].name, killer, { x, z }, this.hits, by);
    this.hud.showFall(words);
    this.hits.forget();
  }

  private tellShot(seat: number, x: number, z: number): void {
    const now = performance.now();
    if (seat === this.seat) {
      if (now - this.firedAt > 1000 * EXPECTED) this.showFire(now);
      return;
    }
    const [ownX, , ownZ] = this.prediction.place;
    const distance = Math.hypot(x - ownX, z - ownZ);
    this.sounds.shot(Math.sin((this.angleTo(x, z) * Math.PI) / 180), distance);
  }

  // Show a shot at once if the weapon is ready as far as one knows.
  private fire(input: Input, now: number): void {
    const { health, clip, reload } = this.own as Own;
    const isReady = now - this.firedAt >= 1000 * this.begin.rules.fire_interval;
    if (input.shoot && this.begin.weapon && isReady && health > 0 && clip > 0 && !reload) this.showFire(now);
  }

  private showFire(now: number): void {
    this.firedAt = now;
    if (!this.isCalm) this.weapon.fire(now);
    this.hud.flash("crosshair", "fired");
    this.sounds.shot();
  }

  private drawWeapon(renderer: WebGLRenderer): void {
    if (!this.own || this.own.health <= 0 || !this.begin.weapon) return;
    const [east, , north] = this.own.velocity;
    const reload = this.own.reload
      ? Math.max(0.1, 1 - this.own.reload / FRAMES / this.begin.rules.reload_time)
      : 0;
    const speed = this.isCalm ? 0 : Math.hypot(east, north);
    this.weapon.draw(renderer, performance.now(), this.seconds, speed, reload);
  }

  private showPace(): void {
    const { errors } = this.prediction;
    const sorted = [...errors].sort((a, b) => a - b);
    const usual = sorted.length ? sorted[Math.floor(0.95 * sorted.length)] : null;
    this.hud.showPace(this.ping, this.picture.rate, usual);
  }

  // Degrees to the right of the view.
  private angleTo(x: number, z: number): number {
    const [ownX, , ownZ] = this.prediction.place;
    return turned(bearingOf({ x: ownX, z: ownZ }, { x, z }).bearing - this.prediction.yaw);
  }
}
