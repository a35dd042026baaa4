// Drawing a match from above on a canvas: the map, the safe zone, boxes, trails, shots and agents.

// Eight colours that people with any kind of colour vision tell apart (M. Okabe, K. Ito, 2008); every marker has
// the number of its seat, and after each eight seats another shape.
const COLORS = ["#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7", "#f5f5f5"];
const LIGHT_TEXT = new Set(["#0072b2"]);
const DARK = "#16181a";
const GROUND = "#8d9a76"; // where there is no picture of the map
const SHOT_FRAMES = 15; // for which a hit is drawn
const CROSS_FRAMES = 500; // for which the place of a death is marked
const MARKER = 11; // px, radius of an agent's marker
const SMALL_MARKER = 8; // px, on narrow screens
const NARROW = 480; // px
const LONGEST_TRAIL = 1500; // points; longer trails leave some out
export const MAX_ZOOM = 16;

export function colorOf(number) {
  return COLORS[number % COLORS.length];
}

export function textColorOf(number) {
  return LIGHT_TEXT.has(colorOf(number)) ? "#ffffff" : DARK;
}

// The shape of a seat's marker: 0 a circle, 1 a square, 2 a diamond, 3 a hexagon.
export function shapeOf(seat) {
  return Math.floor(seat / COLORS.length) % 4;
}

// The number that decides a seat's colour: its team where teams have several seats, else the seat itself.
export function colorNumbers(seats) {
  const teams = new Set(seats.map((seat) => seat.team));
  const byTeam = teams.size > 1 && teams.size < seats.length;
  return seats.map((seat) => (byTeam ? seat.team : seat.seat));
}

export class MapView {
  constructor(canvas, course) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.course = course;
    this.picture = null; // of the map, once it is there
    this.numbers = colorNumbers(course.document.seats);
    this.zoom = 1;
    const map = course.document.map;
    this.center = { x: map.west + map.width / 2, z: map.north - map.height / 2 };
  }

  // The whole map fits in the canvas at zoom 1.
  get scale() {
    const map = this.course.document.map;
    return this.zoom * Math.min(this.canvas.width / map.width, this.canvas.height / map.height);
  }

  get ratio() {
    return this.canvas.width / Math.max(1, this.canvas.clientWidth);
  }

  column(x) {
    return (x - this.center.x) * this.scale + this.canvas.width / 2;
  }

  row(z) {
    return (this.center.z - z) * this.scale + this.canvas.height / 2;
  }

  // Move the view by CSS pixels.
  pan(right, down) {
    this.center.x += (right * this.ratio) / this.scale;
    this.center.z -= (down * this.ratio) / this.scale;
  }

  // Keep the map in view: its edges never leave more room than at zoom 1.
  clamp() {
    const { west, north, width, height } = this.course.document.map;
    const [across, along] = [this.canvas.width / this.scale / 2, this.canvas.height / this.scale / 2];
    this.center.x = within(this.center.x, west + across, west + width - across);
    this.center.z = within(this.center.z, north - height + along, north - along);
  }

  // Fit the canvas to its place on the page.
  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(this.canvas.clientWidth * ratio);
    this.canvas.height = Math.round(this.canvas.clientHeight * ratio);
  }

  // Draw a frame. `trail` is how many frames of each trail are shown, `selected` a seat or null.
  draw(frame, trail, selected) {
    const { context, canvas } = this;
    if (selected !== null) {
      const { x, z } = this.course.at(selected, frame);
      this.center = { x, z };
    }
    this.clamp();
    context.clearRect(0, 0, canvas.width, canvas.height);
    this.drawGround();
    this.drawZone(frame);
    this.drawBoxes(frame);
    this.drawTarget();
    const seats = this.course.document.seats.map((each) => each.seat);
    for (const seat of seats) this.drawTrail(seat, frame, trail, selected);
    this.drawEvents(frame);
    // Who is selected lies on top.
    for (const seat of seats) if (seat !== selected) this.drawAgent(seat, frame, selected);
    if (selected !== null) this.drawAgent(selected, frame, selected);
  }

  drawGround() {
    const { west, north, width, height } = this.course.document.map;
    const place = [this.column(west), this.row(north), width * this.scale, height * this.scale];
    this.context.fillStyle = GROUND;
    this.context.fillRect(...place);
    if (this.picture) this.context.drawImage(this.picture, ...place);
  }

  drawZone(frame) {
    const zone = this.course.zoneAt(frame);
    if (!zone) return;
    const { context } = this;
    const { west, north, width, height } = this.course.document.map;
    const circle = ({ x, z, radius }) =>
      context.arc(this.column(x), this.row(z), radius * this.scale, 0, 2 * Math.PI);
    context.beginPath();
    context.rect(this.column(west), this.row(north), width * this.scale, height * this.scale);
    circle(zone.now);
    context.fillStyle = "rgb(200 30 60 / 40%)";
    context.fill("evenodd");
    context.beginPath();
    circle(zone.now);
    context.lineWidth = 2 * this.ratio;
    context.strokeStyle = "#ffffff";
    context.stroke();
    context.beginPath();
    context.setLineDash([6 * this.ratio, 5 * this.ratio]);
    circle(zone.next);
    context.stroke();
    context.setLineDash([]);
  }

  drawBoxes(frame) {
    const { context } = this;
    const side = Math.max(4 * this.ratio, 10 * this.scale);
    context.fillStyle = "#ffffff";
    context.strokeStyle = DARK;
    context.lineWidth = this.ratio;
    for (const box of this.course.document.boxes) {
      if (frame < box.appears || (box.taken !== null && frame >= box.taken)) continue;
      const place = [this.column(box.x) - side / 2, this.row(box.z) - side / 2, side, side];
      context.fillRect(...place);
      context.strokeRect(...place);
    }
  }

  drawTarget() {
    const target = this.course.document.target;
    if (!target) return;
    const { context } = this;
    for (const [radius, color] of [[10, DARK], [8, "#ffffff"], [5.5, "#c8102e"], [2.5, "#ffffff"]]) {
      context.beginPath();
      context.arc(this.column(target.x), this.row(target.z), radius * this.ratio, 0, 2 * Math.PI);
      context.fillStyle = color;
      context.fill();
    }
  }

  drawTrail(seat, frame, trail, selected) {
    const { context, course } = this;
    const last = course.sampleAt(frame);
    const first = Math.max(course.sampleAt(frame - trail), 0);
    const stride = Math.max(1, Math.ceil((last - first) / LONGEST_TRAIL));
    const { x, z } = course.seats[seat];
    context.beginPath();
    context.moveTo(this.column(x[first]), this.row(z[first]));
    let connected = true;
    for (let sample = first + 1; sample <= last; sample += 1) {
      connected &&= course.isConnected(seat, sample);
      if ((sample - first) % stride && sample !== last && connected) continue;
      const point = [this.column(x[sample]), this.row(z[sample])];
      if (connected) context.lineTo(...point);
      else context.moveTo(...point);
      connected = true;
    }
    const now = course.at(seat, frame);
    if (now.health > 0) context.lineTo(this.column(now.x), this.row(now.z));
    context.lineJoin = "round";
    context.globalAlpha = selected === null || selected === seat ? 1 : 0.45;
    context.lineWidth = 4.5 * this.ratio;
    context.strokeStyle = "rgb(20 22 24 / 55%)";
    context.stroke();
    context.lineWidth = 2.5 * this.ratio;
    context.strokeStyle = colorOf(this.numbers[seat]);
    context.stroke();
    context.globalAlpha = 1;
  }

  // Draw the hits of this moment as lines, and crosses where somebody died lately.
  drawEvents(frame) {
    const { course } = this;
    const last = course.eventsUntil(frame);
    for (let place = course.eventsUntil(frame - CROSS_FRAMES); place < last; place += 1) {
      const event = course.events[place];
      if (event.kind === "hit" && frame - event.frame < SHOT_FRAMES) this.drawShot(event);
      if (event.kind === "death" || event.kind === "out") this.drawCross(event);
    }
  }

  drawShot(event) {
    const { context } = this;
    const [from, to] = [event.seat, event.other].map((seat) => this.course.at(seat, event.frame));
    context.beginPath();
    context.moveTo(this.column(from.x), this.row(from.z));
    context.lineTo(this.column(to.x), this.row(to.z));
    context.lineWidth = 3.5 * this.ratio;
    context.strokeStyle = DARK;
    context.stroke();
    context.lineWidth = 1.5 * this.ratio;
    context.strokeStyle = "#ffef9e";
    context.stroke();
  }

  drawCross(event) {
    const { context } = this;
    const before = Math.max(0, this.course.sampleAt(event.frame - 1));
    const samples = this.course.seats[event.seat];
    const [column, row] = [this.column(samples.x[before]), this.row(samples.z[before])];
    const arm = 6 * this.ratio;
    context.beginPath();
    context.moveTo(column - arm, row - arm);
    context.lineTo(column + arm, row + arm);
    context.moveTo(column + arm, row - arm);
    context.lineTo(column - arm, row + arm);
    for (const [width, color] of [[5, DARK], [2.5, colorOf(this.numbers[event.seat])]]) {
      context.lineWidth = width * this.ratio;
      context.strokeStyle = color;
      context.stroke();
    }
  }

  // Draw an agent as its number in a shape with a pointer in view direction; the dead are left to their cross.
  drawAgent(seat, frame, selected) {
    const { context } = this;
    const { x, z, yaw, health } = this.course.at(seat, frame);
    if (health <= 0) return;
    const narrow = this.canvas.clientWidth < NARROW;
    const radius = (narrow ? SMALL_MARKER : MARKER) * this.ratio * (seat === selected ? 1.25 : 1);
    const number = this.numbers[seat];
    context.save();
    context.translate(this.column(x), this.row(z));
    context.rotate((yaw * Math.PI) / 180);
    context.beginPath();
    context.moveTo(-0.62 * radius, -0.9 * radius);
    context.lineTo(0, -1.9 * radius);
    context.lineTo(0.62 * radius, -0.9 * radius);
    context.closePath();
    context.fillStyle = DARK;
    context.fill();
    context.restore();
    context.beginPath();
    traceShape(context, shapeOf(seat), this.column(x), this.row(z), radius);
    context.fillStyle = colorOf(number);
    context.fill();
    context.lineWidth = (seat === selected ? 3 : 2) * this.ratio;
    context.strokeStyle = seat === selected ? "#ffffff" : DARK;
    context.stroke();
    context.fillStyle = textColorOf(number);
    context.font = `600 ${Math.round(1.2 * radius)}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(String(seat), this.column(x), this.row(z) + 0.06 * radius);
  }
}

// Add the outline of a marker to the path.
function traceShape(context, shape, column, row, radius) {
  const corners = [0, 4, 4, 6][shape];
  if (!corners) {
    context.arc(column, row, radius, 0, 2 * Math.PI);
    return;
  }
  const turned = shape === 1 ? Math.PI / 4 : 0;
  for (let corner = 0; corner < corners; corner += 1) {
    const angle = turned + (2 * Math.PI * corner) / corners;
    context.lineTo(column + 1.25 * radius * Math.sin(angle), row - 1.25 * radius * Math.cos(angle));
  }
  context.closePath();
}

function within(value, low, high) {
  return low > high ? (low + high) / 2 : Math.min(high, Math.max(low, value));
}
