// What is shown over the picture while a match is played.

const VIEW = 130; // degrees that the compass shows
const POINTS = { 0: "N", 45: "NE", 90: "E", 135: "SE", 180: "S", 225: "SW", 270: "W", 315: "NW" };
const FLASH = 140; // ms
const NOTICE = 1400; // ms
const find = (id) => document.getElementById(id);
const clock = (seconds) => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;

// An angle in degrees as the equal one in (-180, 180].
export const turned = (angle) => 180 - ((((180 - angle) % 360) + 360) % 360);

export class Hud {
  constructor() {
    this.points = Array.from({ length: 24 }, (_, index) => {
      const point = document.createElement("span");
      point.textContent = POINTS[index * 15] ?? "·";
      point.className = index % 3 ? "minor" : "";
      find("points").append(point);
      return [index * 15, point];
    });
    this.kills = null;
  }

  // Prepare for a match; seat is one's own, or the one whose eyes a spectator sees through.
  begin(match, seat, watches = false) {
    this.watches = watches;
    [this.match, this.seat, this.kills, this.rows] = [match, seat, null, []];
    this.columns = match.metrics.map(({ title }) => title);
    this.notice("");
  }

  showTime({ left }) {
    find("clock").textContent = clock(left);
  }

  show(now) {
    this.showTime(now);
    find("compass").dataset.yaw = now.yaw.toFixed(1);
    this.#showCompass(now);
    this.#showVitals(now);
    this.#showEvents(now);
  }

  #place(element, bearing, yaw, keep = false) {
    const away = turned(bearing - yaw);
    const share = keep ? Math.max(-0.48, Math.min(0.48, away / VIEW)) : away / VIEW;
    element.hidden = Math.abs(share) > 0.5;
    element.style.left = `${50 + share * 100}%`;
  }

  #showCompass(now) {
    this.points.forEach(([bearing, point]) => this.#place(point, bearing, now.yaw));
    const marks = now.boxes.map((box) => ["box", "▪", box]);
    if (now.target) marks.push(["target", "◆", now.target]);
    const drawn = find("marks");
    while (drawn.children.length > marks.length) drawn.lastChild.remove();
    marks.forEach(([kind, sign, place], index) => {
      const mark = drawn.children[index] ?? drawn.appendChild(document.createElement("b"));
      mark.className = kind;
      mark.textContent = sign;
      this.#place(mark, place.bearing, now.yaw, kind === "target");
    });
    this.#showGoal(now);
  }

  #showGoal({ target, yaw, can_pick_up: canPickUp }) {
    const goal = find("goal");
    if (target) {
      const angle = Math.round(turned(target.bearing - yaw));
      const way = Math.abs(angle) < 8 ? "ahead" : `${Math.abs(angle)}° ${angle > 0 ? "right" : "left"}`;
      goal.textContent = `◆ target ${target.distance.toFixed(0)} m, ${way}`;
      goal.dataset.angle = angle;
      goal.dataset.distance = target.distance.toFixed(1);
    } else {
      goal.textContent = canPickUp && !this.watches ? "E: pick up supplies" : "";
    }
  }

  #showVitals(now) {
    const full = Math.max(100, now.health);
    find("health").classList.toggle("low", now.health <= 30);
    find("health").querySelector("b").textContent = now.health;
    find("health").querySelector(".bar i").style.transform = `scaleX(${now.health / full})`;
    find("supplies").querySelector("b").textContent = now.supplies;
    find("ammo").classList.toggle("low", now.clip <= 3);
    find("ammo").querySelector("b").textContent = now.clip;
    find("ammo").querySelector("small").textContent =
      now.reload_in > 0 ? `reloading ${now.reload_in.toFixed(1)} s` : `of ${now.spare_ammo} more rounds`;
    if (this.watches) this.notice(now.alive ? "" : "dead", 200);
    else if (!now.alive) this.notice(now.respawn_in > 0 ? `You are dead. Back in ${now.respawn_in.toFixed(1)} s` : "You are out", 200);
    else if (now.invincible_in > 0) this.notice(`Nobody can hurt you for ${now.invincible_in.toFixed(1)} s`, 200);
    else if (now.clip === 0 && now.reload_in === 0 && this.match.weapon) this.notice("Empty: R reloads", 200);
  }

  #showEvents(now) {
    if (now.fired) this.#flash("crosshair", "fired");
    if (now.hits) this.#flash("crosshair", "hit");
    if (now.hurt) this.#flash("hurt", "on");
    if (now.gained) this.notice(`+${now.gained} supplies`);
  }

  #flash(id, name) {
    find(id).classList.add(name);
    setTimeout(() => find(id).classList.remove(name), FLASH);
  }

  notice(text, time = NOTICE) {
    find("notice").textContent = text;
    clearTimeout(this.clearing);
    this.clearing = setTimeout(() => { find("notice").textContent = ""; }, time);
  }

  // Show the scores of all, the best first.
  showScores(rows) {
    find("scores").hidden = rows.length < 2;
    fillTable(find("scores"), this.columns, rows, this.seat, 6, this.watches ? null : "you");
    const kills = rows.find(({ seat }) => seat === this.seat)?.values[this.columns.indexOf("kills")];
    if (this.kills !== null && kills > this.kills) this.notice("Kill!");
    this.kills = kills ?? null;
  }

  showDelay(delay, rate) {
    const counted = delay === null ? "" : `input to picture ${delay.toFixed(0)} ms, `;
    find("delay").textContent = `${counted}${rate.toFixed(0)} pictures a second`;
    find("delay").dataset.delay = delay ?? "";
    find("delay").dataset.rate = rate.toFixed(1);
  }
}

const shown = (value) => (Number.isInteger(value) ? String(value) : value.toFixed(2));

// Fill a table with the metrics of seats; own is the seat to stress.
export function fillTable(table, columns, rows, own, most = Infinity, ownName = "you") {
  const row = (cells, name) => {
    const line = document.createElement("tr");
    cells.forEach((text) => { line.appendChild(document.createElement(name)).textContent = text; });
    return line;
  };
  const best = rows.slice(0, most);
  const mine = rows.find(({ seat }) => seat === own);
  if (mine && !best.includes(mine)) best[best.length - 1] = mine;
  table.tHead.replaceChildren(row(["", ...columns], "th"));
  table.tBodies[0].replaceChildren(
    ...best.map(({ seat, name, values }) => {
      const line = row([seat === own ? ownName ?? name : name, ...values.map(shown)], "td");
      line.className = seat === own ? "own" : "";
      return line;
    }),
  );
}
