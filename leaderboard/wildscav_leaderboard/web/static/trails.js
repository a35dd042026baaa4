// The player of a match, seen from above. It fills every element with `data-trails`, the URL of the match's trails;
// `data-overview` is the URL of the picture of its map, and `data-names`
// has the names of seats as people read them, by number. With `data-live`, the match is being played: new samples
// are asked for until it is over.

import { Course, clock } from "./trails_course.js";
import { MAX_ZOOM, MapView, colorNumbers, colorOf, shapeOf, textColorOf } from "./trails_map.js";

const POLL = 400; // ms between two questions about a running match
const PICTURE_POLL = 1000; // ms between two questions about the picture of the map
const PICTURE_PATIENCE = 10000; // ms for which a match waits for it
const RETRY = 2000; // ms after a question that was not answered
const SPEEDS = [0.5, 1, 2, 4, 8, 16, 32];
const TRAILS = [["none", 0], ["10 s", 10], ["30 s", 30], ["2 min", 120], ["all", Infinity]];
const MAX_EVENTS = 400; // in the list at one time
const CALM_INTERVAL = 500; // ms between two pictures for people who asked for less motion
const KINDS = {
  target: "target reached",
  out: "eliminations",
  death: "deaths",
  respawn: "respawns",
  hit: "hits",
  pick_up: "pick-ups",
  zone: "safe zone",
};

function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

function button(text, label, onclick) {
  return make("button", { type: "button", textContent: text, ariaLabel: label, title: label, onclick });
}

function picker(label, options, chosen, onchange) {
  const list = make("select", { onchange: () => onchange(list.value) });
  for (const [text, value] of options) {
    list.append(make("option", { value: String(value), textContent: text, selected: value === chosen }));
  }
  return make("label", {}, `${label} `, list);
}

class Player {
  constructor(root, course) {
    this.root = root;
    this.course = course;
    this.frame = 0;
    this.speed = 1;
    this.trail = 30;
    this.isPlaying = false;
    this.isFollowingLive = false;
    this.selected = null;
    this.shownKinds = new Set(Object.keys(KINDS));
    this.calm = window.matchMedia("(prefers-reduced-motion: reduce)");
    this.build();
    this.view = new MapView(this.canvas, course);
    new ResizeObserver(() => this.fit()).observe(this.canvas);
    this.fit();
  }

  build() {
    this.canvas = make("canvas", { className: "trails-map", role: "img" });
    this.canvas.setAttribute("aria-label", "The map from above, with the agents and their trails");
    this.buildTimeLine();
    this.seatList = make("ul", { className: "trails-seats" });
    this.seatRows = this.course.document.seats.map((seat) => this.seatRow(seat));
    this.seatList.append(...this.seatRows.map((row) => row.item));
    this.eventList = make("ol", { className: "trails-events", tabIndex: 0 });
    this.eventList.setAttribute("aria-label", "Events");
    this.eventList.onkeydown = (press) => this.moveAmongEvents(press);
    this.filters = make("div", { className: "trails-filters", role: "group" });
    this.filters.setAttribute("aria-label", "Kinds of events");
    this.status = make("p", { className: "trails-status", role: "status" });
    this.root.replaceChildren(
      make("div", { className: "trails-stage" }, this.canvas, this.zoomButtons()),
      make("div", { className: "trails-controls" }, this.marks, this.range, this.buttons(), this.status),
      make("div", { className: "trails-side" }, this.seatList, this.filters, this.eventList),
    );
    this.listenToCanvas();
    this.listEvents();
  }

  buildTimeLine() {
    this.marks = make("canvas", { className: "trails-marks", ariaHidden: "true" });
    this.marks.onclick = (click) => this.seekToMark(click.offsetX / this.marks.clientWidth);
    this.range = make("input", { type: "range", min: "0", step: "1", className: "trails-range" });
    this.range.setAttribute("aria-label", "Time of the match");
    this.range.oninput = () => this.seek(Number(this.range.value) * this.course.document.frames_per_second);
  }

  buttons() {
    const second = this.course.document.frames_per_second;
    this.playButton = button("Play", "Play", () => this.toggle());
    this.playButton.className = "trails-play";
    this.playButton.removeAttribute("aria-label");
    this.time = make("span", { className: "trails-time" });
    this.liveButton = button("Live", "Go to the present moment of the match", () => this.followLive());
    this.liveButton.hidden = true;
    const speeds = SPEEDS.map((speed) => [`${speed}×`, speed]);
    return make(
      "div",
      { className: "trails-buttons" },
      this.playButton,
      button("−5 s", "Back 5 seconds", () => this.seek(this.frame - 5 * second)),
      button("+5 s", "On 5 seconds", () => this.seek(this.frame + 5 * second)),
      this.liveButton,
      this.time,
      picker("Speed", speeds, 1, (value) => (this.speed = Number(value))),
      picker("Trails", TRAILS, 30, (value) => {
        this.trail = Number(value);
        this.draw();
      }),
    );
  }

  zoomButtons() {
    return make(
      "div",
      { className: "trails-zoom" },
      button("+", "Zoom in", () => this.zoom(2)),
      button("−", "Zoom out", () => this.zoom(0.5)),
    );
  }

  seatRow(seat) {
    const number = colorNumbers(this.course.document.seats)[seat.seat];
    const badge = make("span", { className: "trails-badge", textContent: String(seat.seat) });
    badge.classList.add(`trails-shape-${shapeOf(seat.seat)}`);
    badge.style.backgroundColor = colorOf(number);
    badge.style.color = textColorOf(number);
    const bar = make("span", { className: "trails-bar" });
    const health = make("span", { className: "trails-health" }, bar);
    health.setAttribute("aria-hidden", "true");
    const facts = make("span", { className: "trails-facts" });
    const kind = seat.kind === "submission" ? "" : "robot";
    const name = this.course.name(seat.seat);
    const names = make("span", { className: "trails-name", textContent: name, title: name });
    const select = make(
      "button",
      { type: "button", className: "trails-seat", onclick: () => this.select(seat.seat) },
      badge,
      names,
      make("span", { className: "trails-kind", textContent: kind }),
      facts,
      health,
    );
    select.setAttribute("aria-pressed", "false");
    return { item: make("li", {}, select), select, bar, facts, shown: "" };
  }

  // Events: the list, the filters and the marks.

  listEvents() {
    const present = new Set(this.course.events.map((event) => event.kind));
    if (present.size !== this.filters.childElementCount) {
      this.filters.replaceChildren(...Object.keys(KINDS).filter((kind) => present.has(kind)).map((kind) => this.filter(kind)));
    }
    this.listed = this.course.events.filter((event) => this.shownKinds.has(event.kind));
    this.firstListed = -1;
    this.showEvents();
    this.drawMarks();
  }

  filter(kind) {
    const box = make("input", { type: "checkbox", checked: this.shownKinds.has(kind) });
    box.onchange = () => {
      if (box.checked) this.shownKinds.add(kind);
      else this.shownKinds.delete(kind);
      this.listEvents();
    };
    return make("label", {}, box, ` ${KINDS[kind]}`);
  }

  // Of very many events, list those around the present time; mark the last one that has happened.
  showEvents() {
    const now = this.listed.findLastIndex((event) => event.frame <= this.frame);
    const enough = this.listed.length <= MAX_EVENTS;
    const page = MAX_EVENTS / 2;
    const first = enough ? 0 : Math.max(0, (Math.floor(now / page) - 1) * page);
    if (first !== this.firstListed) {
      this.firstListed = first;
      const some = this.listed.slice(first, first + 2 * MAX_EVENTS);
      this.eventList.replaceChildren(...some.map((event) => this.eventItem(event)));
      this.current = null;
    }
    const item = this.eventList.children[now - first] ?? null;
    if (item === this.current) return;
    this.current?.firstElementChild.removeAttribute("aria-current");
    item?.firstElementChild.setAttribute("aria-current", "true");
    this.current = item;
    if (item && !this.eventList.contains(document.activeElement)) {
      this.eventList.scrollTop = item.offsetTop - this.eventList.clientHeight / 2;
    }
  }

  eventItem(event) {
    const at = make("span", { className: "trails-at", textContent: clock(this.course.seconds(event.frame)) });
    const text = make("span", { textContent: this.course.describe(event) });
    const jump = make("button", { type: "button", tabIndex: -1, onclick: () => this.seek(event.frame) }, at, text);
    return make("li", {}, jump);
  }

  // The list is one stop of the tab key; the arrows lead through its events, from the present one on.
  moveAmongEvents(press) {
    const step = { ArrowDown: 1, ArrowUp: -1 }[press.key];
    if (!step) return;
    press.preventDefault();
    const items = [...this.eventList.children];
    const at = items.findIndex((item) => item.contains(document.activeElement));
    const next = at < 0 ? items.indexOf(this.current) : at + step;
    items[Math.min(Math.max(0, next), items.length - 1)]?.firstElementChild.focus();
  }

  drawMarks() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [this.marks.clientWidth * ratio, this.marks.clientHeight * ratio];
    if (!width || !height) return;
    [this.marks.width, this.marks.height] = [Math.round(width), Math.round(height)];
    const context = this.marks.getContext("2d");
    const numbers = colorNumbers(this.course.document.seats);
    const ink = getComputedStyle(this.marks).color;
    for (const event of this.listed) {
      const tall = { target: 1, out: 1, death: 1, zone: 0.8, respawn: 0.5, pick_up: 0.35, hit: 0.35 }[event.kind];
      context.fillStyle = event.seat === null ? ink : colorOf(numbers[event.seat]);
      const left = (event.frame / Math.max(1, this.course.lastFrame)) * (width - 2 * ratio);
      context.fillRect(left, height * (1 - tall), 2 * ratio, height * tall);
    }
  }

  seekToMark(part) {
    const wanted = part * this.course.lastFrame;
    const distance = (event) => Math.abs(event.frame - wanted);
    const nearest = this.listed.reduce((best, event) => (distance(event) < distance(best) ? event : best), this.listed[0]);
    const isClose = nearest && distance(nearest) < this.course.lastFrame / 60;
    this.seek(isClose ? nearest.frame : wanted);
  }

  // Moving through the match.

  seek(frame) {
    this.isFollowingLive = false;
    this.frame = Math.min(Math.max(0, frame), this.course.lastFrame);
    this.draw();
  }

  toggle() {
    if (this.isPlaying) return this.pause();
    if (this.frame >= this.course.lastFrame) this.frame = 0;
    this.isFollowingLive = false;
    this.isPlaying = true;
    this.playButton.textContent = "Pause";
    this.playButton.title = "Pause";
    this.lastTick = performance.now();
    requestAnimationFrame((now) => this.tick(now));
  }

  pause() {
    this.isPlaying = false;
    this.playButton.textContent = "Play";
    this.playButton.title = "Play";
    this.draw();
  }

  tick(now) {
    if (!this.isPlaying) return;
    const passed = now - this.lastTick;
    if (!this.calm.matches || passed >= CALM_INTERVAL) {
      this.lastTick = now;
      this.frame += (Math.min(passed, 1000) / 1000) * this.speed * this.course.document.frames_per_second;
      if (this.frame >= this.course.lastFrame) {
        this.frame = this.course.lastFrame;
        this.pause();
      }
      this.draw();
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  followLive() {
    this.isPlaying = false;
    this.playButton.textContent = "Play";
    this.isFollowingLive = true;
    this.frame = this.course.lastFrame;
    this.draw();
  }

  // Take in new samples of a running match.
  extend(next) {
    this.course.extend(next);
    this.liveButton.hidden = next.over;
    this.listEvents();
    if (this.isFollowingLive) this.frame = this.course.lastFrame;
    this.draw();
  }

  // The view.

  select(seat) {
    this.selected = this.selected === seat ? null : seat;
    this.seatRows.forEach((row, each) => row.select.setAttribute("aria-pressed", String(each === this.selected)));
    this.draw();
  }

  zoom(factor) {
    this.view.zoom = Math.min(MAX_ZOOM, Math.max(1, this.view.zoom * factor));
    this.draw();
  }

  listenToCanvas() {
    let from = null;
    this.canvas.onpointerdown = (press) => {
      from = this.view.zoom > 1 ? press : null;
      if (from) this.canvas.setPointerCapture(press.pointerId);
    };
    this.canvas.onpointermove = (move) => {
      if (!from) return;
      if (this.selected !== null) this.select(this.selected);
      this.view.pan(from.clientX - move.clientX, from.clientY - move.clientY);
      from = move;
      this.draw();
    };
    this.canvas.onpointerup = this.canvas.onpointercancel = () => (from = null);
  }

  showMap(picture) {
    this.view.picture = picture;
    this.draw();
  }

  fit() {
    this.view.resize();
    this.drawMarks();
    this.draw();
  }

  draw() {
    const { course } = this;
    this.canvas.classList.toggle("trails-zoomed", this.view.zoom > 1);
    this.view.draw(this.frame, this.trail * course.document.frames_per_second, this.selected);
    const [now, end] = [this.frame, course.lastFrame].map((frame) => course.seconds(frame));
    this.range.max = String(Math.ceil(end));
    this.range.value = String(Math.round(now));
    const text = `${clock(now)} of ${clock(end)}`;
    if (this.time.textContent !== text) {
      this.time.textContent = text;
      this.range.setAttribute("aria-valuetext", text);
    }
    this.liveButton.setAttribute("aria-pressed", String(this.isFollowingLive));
    this.seatRows.forEach((row, seat) => this.showSeat(row, seat));
    this.showEvents();
  }

  showSeat(row, seat) {
    const { health, supplies } = this.course.at(seat, this.frame);
    const shown = `${health} ${supplies}`;
    if (row.shown === shown) return;
    row.shown = shown;
    const carried = this.carries ? ` · ${supplies} ${supplies === 1 ? "supply" : "supplies"}` : "";
    row.facts.textContent = health > 0 ? `${health} hp${carried}` : `dead${carried}`;
    row.select.classList.toggle("trails-dead", health <= 0);
    row.bar.style.width = `${Math.min(100, (100 * health) / this.course.document.seats[seat].full_health)}%`;
  }

  get carries() {
    return this.course.document.boxes.length > 0 || this.course.seats.some((seat) => seat.supplies.some(Boolean));
  }
}

// Fetch a document; while it is being made (202), wait and say so.
async function fetchTrails(url, say) {
  for (;;) {
    const answer = await fetch(url, { headers: { Accept: "application/json" } });
    if (answer.status === 202) {
      const progress = await answer.json();
      say(progress.detail ?? "The match is being prepared …");
      await pause(1000);
      continue;
    }
    if (answer.status === 503) throw new Error((await answer.json()).detail);
    if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
    return answer.json();
  }
}

const pause = (time) => new Promise((resolve) => setTimeout(resolve, time));

// Fetch the picture of a map; while it is being made (202), ask again. Without one, trails are drawn on plain ground.
async function fetchPicture(url) {
  let answer = null;
  while (!answer || answer.status === 202) {
    if (answer) await pause(PICTURE_POLL);
    answer = await fetch(url).catch(() => pause(RETRY));
  }
  if (!answer.ok) return null;
  const picture = new Image();
  picture.src = url;
  return picture.decode().then(() => picture, () => null);
}

function after(url, cursor) {
  const whole = new URL(url, document.baseURI);
  whole.searchParams.set("after", cursor);
  return whole.href;
}

// Ask for new samples until the match is over.
async function watch(player, url) {
  player.followLive();
  player.liveButton.hidden = player.course.document.over;
  while (!player.course.document.over) {
    let pause = POLL;
    try {
      const next = await fetchTrails(after(url, player.course.document.cursor), () => {});
      player.extend(next);
      player.status.textContent = next.over ? "The match is over. " : "";
      if (next.over) player.status.append(make("a", { href: "", textContent: "See its result" }));
    } catch {
      player.status.textContent = "The connection is lost; trying again …";
      pause = RETRY;
    }
    await new Promise((resolve) => setTimeout(resolve, pause));
    if (!player.root.isConnected) return;
  }
}

async function start(root) {
  const message = make("p", { className: "trails-status", role: "status", textContent: "Loading …" });
  root.classList.add("trails");
  root.replaceChildren(message);
  const url = root.dataset.trails;
  try {
    const picture = root.dataset.overview ? fetchPicture(root.dataset.overview) : Promise.resolve(null);
    const trails = await fetchTrails(url, (text) => (message.textContent = text));
    message.textContent = "The map is being drawn …";
    await Promise.race([picture, pause(PICTURE_PATIENCE)]);
    const player = new Player(root, new Course(trails, JSON.parse(root.dataset.names ?? "{}")));
    picture.then((drawn) => player.showMap(drawn));
    if ("live" in root.dataset) await watch(player, url);
  } catch (error) {
    message.textContent = `The match cannot be shown: ${error.message}.`;
    root.replaceChildren(message);
  }
}

document.querySelectorAll("[data-trails]").forEach(start);
