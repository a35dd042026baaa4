// The player of a match: the picture, the time line, the standings and the events, and what moves them.

import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import type { Note } from "../data/notes";
import type { News, Trails } from "../data/trails";
import type { CameraPlace, StageMaker, ViewKind } from "../stage";
import { followsSeat, type Moment } from "./address";
import { Caption } from "./caption";
import type { Clock } from "./clock";
import { type Actions, Controls } from "./controls";
import { make } from "./dom";
import { EventList } from "./event_list";
import { Feed } from "./feed";
import { keysDialog, listenToKeys } from "./keys";
import { Lag } from "./lag";
import { type Drawn, Loop } from "./loop";
import { jumpFrom, stepFrom } from "./moments";
import { Screen } from "./screen";
import { Standings } from "./standings";
import { Timeline, timeText } from "./timeline";
import { type Told, Views } from "./views";

const SLOW = 200; // ms between two changes of the lists while time passes, at least
const SHARE = 8; // times as long as a change takes lie between two, so that very many agents stop no picture
const PAIR = "player-pair"; // the class of what holds two that are compared
const SAID = 4000; // ms for which an answer to a person stays

export class Player implements Actions, Drawn {
  readonly screen: Screen;
  private readonly loop: Loop;
  private readonly controls: Controls;
  private readonly timeline: Timeline;
  private readonly standings: Standings;
  private readonly events: EventList;
  private readonly feed: Feed;
  private readonly caption: Caption;
  private readonly views: Views;
  private readonly outcome = make("p", { className: "player-outcome", role: "status" });
  private readonly keys = keysDialog();
  private readonly theater: HTMLElement;
  private readonly stops: (() => void)[];
  private lag: Lag;
  private state = ""; // of the connection, as it was said last
  private follower: Player | null = null;
  private camera = ""; // where it was in the last picture
  private shownTime = -1; // s, by all but the picture
  private listsAt = 0; // ms, when the lists are due again

  constructor(
    readonly root: HTMLElement,
    readonly course: Course,
    readonly clock: Clock,
    makers: StageMaker[],
    isFirst: () => boolean,
    private readonly lead: Player | null = null, // whose time line and buttons move this one too, where two are compared
  ) {
    this.loop = new Loop(root, clock, this);
    this.lag = new Lag(course.trails.delay, course.trails.frames_per_second);
    this.screen = new Screen(course, makers, () => this.loop.stir());
    this.views = new Views(course, this.screen, (told) => this.tellView(told));
    this.controls = new Controls(course.seats, this);
    this.timeline = new Timeline(course, (seconds) => this.clock.seek(seconds));
    this.standings = new Standings(course, (seat) => this.views.followOrLeave(seat));
    this.feed = new Feed(course);
    this.caption = new Caption(course);
    this.events = new EventList(
      course,
      (frame) => this.seekFrame(frame),
      () => this.relist(),
    );
    this.screen.element.append(this.feed.element, this.caption.element, this.outcome);
    const { title } = root.dataset;
    const heading = title ? [make("h2", { className: "player-title", textContent: title })] : [];
    this.theater = make(
      "div",
      { className: "player-theater" },
      ...heading,
      this.screen.element,
      this.screen.note,
    );
    this.lay();
    this.stops = [clock.listen(() => this.loop.refresh()), listenToKeys(root, this, isFirst)];
    this.events.extend();
    this.setEnd();
    if (lead) {
      lead.follower = this;
      this.look(lead.screen.view.kind);
    }
    this.views.showStage();
  }

  get frame(): number {
    // A time that is a frame must not fall just below it.
    const frame = Math.round(this.clock.seconds * this.course.trails.frames_per_second * 1e6) / 1e6;
    return Math.min(frame, this.course.lastFrame);
  }

  showMap(map: GameMap): void {
    this.screen.show(map);
  }

  // Begin at a moment, at the present, or at the beginning, where people who asked for less motion press Play.
  start(moment: Moment | null): void {
    if (moment) this.goTo(moment);
    if (moment?.seconds != null) return;
    if (this.clock.isOpen) this.clock.followLive();
    else if (!this.loop.isCalm && !this.clock.isPlaying) this.clock.play();
  }

  goTo(moment: Moment): void {
    const { seconds } = moment;
    if (seconds !== null) {
      this.clock.pause();
      this.clock.seek(seconds);
    }
    this.views.goTo(moment);
  }

  // Begin anew: the match is played again, or is over and recorded.
  begin(trails: Trails, news: News[]): void {
    this.course.begin(trails);
    this.lag = new Lag(trails.delay, trails.frames_per_second);
    this.extend(news);
    if (trails.over) this.clock.close();
  }

  // Take in news of a match that is being played.
  extend(news: News[]): void {
    for (const each of news) this.course.extend(each);
    this.standings.extend();
    this.events.extend();
    this.views.extend();
    this.setEnd();
  }

  // Show what agents said and drew.
  addNotes(notes: Note[]): void {
    this.course.addNotes(notes);
    this.events.extend();
    this.loop.refresh();
  }

  say(...what: (Node | string)[]): void {
    this.controls.status.replaceChildren(...what);
  }

  // Say how it goes with the connection, until an empty text says that all is well.
  sayState(text: string): void {
    if (text !== this.state) this.say(text);
    this.state = text;
  }

  // There is no more news; say why.
  giveUp(why: string): void {
    this.clock.close();
    this.say(why);
  }

  dispose(): void {
    this.loop.dispose();
    for (const stop of this.stops) stop();
    this.timeline.dispose();
    this.screen.dispose();
  }

  // What buttons and keys do.

  toggle(): void {
    if (this.clock.isPlaying || this.clock.isFollowingLive) this.clock.pause();
    else this.clock.play();
  }

  leap(seconds: number): void {
    this.clock.seek(this.clock.seconds + seconds);
  }

  step(direction: 1 | -1): void {
    this.clock.pause();
    this.seekFrame(stepFrom(this.course, this.frame, direction));
  }

  jump(direction: 1 | -1): void {
    const { frames_per_second } = this.course.trails;
    const event = jumpFrom(this.events.listed, this.frame, direction, frames_per_second);
    if (event) this.seekFrame(event.frame);
    else this.sayBriefly(direction > 0 ? "No later event" : "No earlier event");
  }

  setSpeed(speed: number): void {
    this.clock.setSpeed(speed);
  }

  changeSpeed(direction: 1 | -1): void {
    this.clock.changeSpeed(direction);
    this.sayBriefly(`${this.clock.speed}×`);
  }

  look(kind: ViewKind): void {
    this.views.look(kind);
  }

  nextView(): void {
    this.views.next();
  }

  follow(seat: number): void {
    this.views.follow(seat);
  }

  direct(): void {
    for (const { views } of this.both) views.direct();
  }

  followLive(): void {
    if (this.clock.isOpen) this.clock.followLive();
  }

  setTrail(seconds: number): void {
    for (const { views } of this.both) views.setTrail(seconds);
  }

  toggleInset(): void {
    for (const { views } of this.both) views.toggleInset();
  }

  toggleFullscreen(): void {
    if (document.fullscreenElement) document.exitFullscreen();
    else
      this.stageOfAll
        .requestFullscreen?.()
        .catch(() => this.sayBriefly("The browser allows no fullscreen here"));
  }

  async copyLink(): Promise<void> {
    try {
      history.replaceState(null, "", this.views.link(this.clock.seconds));
    } catch {
      this.sayBriefly("This page is inside another one and has no link of its own");
      return;
    }
    try {
      await navigator.clipboard.writeText(location.href);
      this.sayBriefly("Link copied");
    } catch {
      this.sayBriefly("The address of the page is now the link");
    }
  }

  help(): void {
    this.keys.showModal();
  }

  // The parts.

  // This player, and the one that it is compared with.
  private get both(): Player[] {
    const other = this.lead ?? this.follower;
    return other ? [this, other] : [this];
  }

  private get stageOfAll(): HTMLElement {
    return this.root.closest<HTMLElement>(`.${PAIR}`) ?? this.theater;
  }

  private lay(): void {
    const moving = [this.timeline.element, this.controls.element];
    const pair = this.root.closest(`.${PAIR}`);
    if (!pair) this.theater.append(...moving);
    else if (!this.lead) pair.append(make("div", { className: "player player-shared" }, ...moving));
    const side = make(
      "div",
      { className: "player-side" },
      this.standings.element,
      this.events.filters,
      this.events.element,
    );
    this.root.classList.add("player");
    this.root.replaceChildren(make("div", { className: "player-grid" }, this.theater, side), this.keys);
  }

  private tellView(told: Told): void {
    this.controls.showView(told);
    this.standings.mark(followsSeat(told.view.kind) ? told.view.seat : null);
    for (const { screen, views } of this.both)
      if (screen.view.kind !== told.view.kind) views.look(told.view.kind);
  }

  private relist(): void {
    this.timeline.list(this.events.listed);
    this.loop.refresh();
  }

  private setEnd(): void {
    this.lag.note(this.course.lastFrame, performance.now());
    this.clock.setEnd(this.course.seconds(this.course.lastFrame), this);
  }

  private seekFrame(frame: number): void {
    this.clock.seek(this.course.seconds(frame));
  }

  private sayBriefly(text: string): void {
    this.say(text);
    setTimeout(() => {
      if (this.controls.status.textContent === text) this.say();
    }, SAID);
  }

  // Drawing.

  get isCameraMoving(): boolean {
    return this.screen.isMoving;
  }

  draw(now: number, isStale: boolean): void {
    const { frame, clock, course } = this;
    this.views.cut(frame);
    this.screen.draw(frame);
    this.shareCamera();
    const { seconds, end, isOpen } = clock;
    if (!isStale && seconds === this.shownTime) return;
    this.shownTime = seconds;
    const text = timeText(seconds, end);
    this.timeline.update(seconds, end, text);
    this.controls.update(clock, text, seconds >= end && !isOpen, this.lag.of(frame, now));
    this.feed.update(frame, clock.speed);
    this.caption.update(frame, this.views.seat);
    this.showOutcome(frame >= course.lastFrame && !isOpen);
    if (isStale || now > this.listsAt) this.drawLists(frame);
  }

  // Where two are compared, a person moves the cameras of both.
  private shareCamera(): void {
    const other = this.lead ?? this.follower;
    const place = other && this.screen.stage?.camera;
    if (!place) return;
    const camera = JSON.stringify(place);
    if (this.camera && camera !== this.camera) other.takeCamera(place);
    this.camera = camera;
  }

  private takeCamera(place: CameraPlace): void {
    const { stage } = this.screen;
    if (!stage) return;
    stage.camera = place;
    this.camera = JSON.stringify(stage.camera);
    this.loop.stir();
  }

  private drawLists(frame: number): void {
    const start = performance.now();
    this.standings.update(frame);
    this.events.update(frame);
    const end = performance.now();
    this.listsAt = end + Math.max(SLOW, SHARE * (end - start));
  }

  private showOutcome(isAtEnd: boolean): void {
    const { outcome } = this.course.trails;
    const text = isAtEnd && outcome ? `${outcome}.` : "";
    if (this.outcome.textContent !== text) this.outcome.textContent = text;
  }
}
