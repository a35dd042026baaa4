// Keys, mouse and touch, gathered into the inputs that the server takes.

const DEGREES_PER_PIXEL = 0.12; // of the mouse
const DEGREES_PER_TOUCH = 0.3; // per pixel that a finger moves over the picture
const KEY_TURN = 110; // degrees per second, with the arrow keys
const MAX_TURN = 3600; // degrees in one message
const KEYS = {
  KeyW: ["forward", 1], KeyS: ["forward", -1], KeyD: ["right", 1], KeyA: ["right", -1],
  ArrowRight: ["turning", 1], ArrowLeft: ["turning", -1], ArrowDown: ["looking", 1], ArrowUp: ["looking", -1],
  Space: ["jump", true], KeyF: ["shoot", true], KeyR: ["reload", true], KeyE: ["pick_up", true],
};
const FLAGS = Object.values(KEYS).filter(([, value]) => value === true).map(([flag]) => flag);

export class Controls {
  constructor(picture, stick, buttons) {
    this.keys = new Set();
    this.touched = new Set(); // flags of the buttons that fingers hold
    this.stick = [0, 0]; // right and forward, -1 to 1
    this.mouse = false; // whether its left button is held
    this.turn = this.look = 0; // degrees since the last input
    this.pressed = new Set(); // flags that were pressed since the last input
    this.enabled = false;
    this.locked = false; // whether the mouse is
    this.picture = picture;
    this.#listenToKeys();
    this.#listenToMouse();
    this.#listenToFingers(stick, buttons);
  }

  // Take the mouse, where there is one.
  lock() {
    if (!matchMedia("(pointer: fine)").matches) return;
    const asked = this.picture.requestPointerLock({ unadjustedMovement: true });
    asked?.catch(() => this.picture.requestPointerLock()?.catch(() => {}));
  }

  release() {
    this.keys.clear();
    this.touched.clear();
    this.pressed.clear();
    this.stick = [0, 0];
    this.mouse = false;
    this.turn = this.look = 0;
  }

  // Return what is held, and what was turned and pressed since the last call; seconds is the time since then.
  take(seconds) {
    const held = { forward: 0, right: 0, turning: 0, looking: 0 };
    for (const code of this.keys) {
      const [name, value] = KEYS[code];
      if (name in held) held[name] += value;
      else this.pressed.add(name);
    }
    if (this.mouse) this.pressed.add("shoot");
    this.touched.forEach((flag) => this.pressed.add(flag));
    const within = (value, most) => Math.max(-most, Math.min(most, value));
    const input = {
      forward: within(held.forward + this.stick[1], 1),
      right: within(held.right + this.stick[0], 1),
      turn: within(this.turn + held.turning * KEY_TURN * seconds, MAX_TURN),
      look: within(this.look + held.looking * KEY_TURN * seconds, MAX_TURN),
    };
    for (const flag of FLAGS) input[flag] = this.pressed.has(flag);
    this.turn = this.look = 0;
    this.pressed.clear();
    return input;
  }

  #listenToKeys() {
    addEventListener("keydown", (event) => {
      if (!this.enabled || !(event.code in KEYS) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.keys.add(event.code);
      const [name] = KEYS[event.code];
      if (FLAGS.includes(name)) this.pressed.add(name);
    });
    addEventListener("keyup", (event) => this.keys.delete(event.code));
    addEventListener("blur", () => this.release());
  }

  #listenToMouse() {
    document.addEventListener("pointerlockchange", () => {
      this.locked = document.pointerLockElement === this.picture;
    });
    addEventListener("mousemove", (event) => {
      if (!this.enabled || !this.locked) return;
      this.turn += event.movementX * DEGREES_PER_PIXEL;
      this.look += event.movementY * DEGREES_PER_PIXEL;
    });
    addEventListener("mousedown", (event) => {
      if (!this.enabled || !this.locked || event.button !== 0) return;
      this.mouse = true;
      this.pressed.add("shoot");
    });
    addEventListener("mouseup", () => { this.mouse = false; });
  }

  #listenToFingers(stick, buttons) {
    const knob = stick.querySelector("i");
    const moved = (event) => {
      const { left, top, width } = stick.getBoundingClientRect();
      const x = (2 * (event.clientX - left)) / width - 1;
      const y = (2 * (event.clientY - top)) / width - 1;
      const longest = Math.max(1, Math.hypot(x, y));
      this.stick = [x / longest, -y / longest];
      knob.style.transform = `translate(${this.stick[0] * width * 0.3}px, ${-this.stick[1] * width * 0.3}px)`;
    };
    const left = () => {
      this.stick = [0, 0];
      knob.style.transform = "";
    };
    stick.addEventListener("pointerdown", (event) => {
      stick.setPointerCapture(event.pointerId);
      moved(event);
    });
    stick.addEventListener("pointermove", (event) => stick.hasPointerCapture(event.pointerId) && moved(event));
    stick.addEventListener("pointerup", left);
    stick.addEventListener("pointercancel", left);
    for (const button of buttons) {
      const hold = (held) => {
        button.classList.toggle("held", held);
        if (held) this.touched.add(button.dataset.flag);
        else this.touched.delete(button.dataset.flag);
      };
      button.addEventListener("pointerdown", () => {
        this.pressed.add(button.dataset.flag);
        hold(true);
      });
      for (const end of ["pointerup", "pointercancel", "pointerleave"]) button.addEventListener(end, () => hold(false));
    }
    this.#listenToSwipes();
  }

  // A finger that moves over the picture turns the view.
  #listenToSwipes() {
    const last = new Map();
    this.picture.addEventListener("pointerdown", (event) => {
      if (event.pointerType !== "mouse") last.set(event.pointerId, [event.clientX, event.clientY]);
    });
    addEventListener("pointermove", (event) => {
      const from = last.get(event.pointerId);
      if (!from || !this.enabled) return;
      this.turn += (event.clientX - from[0]) * DEGREES_PER_TOUCH;
      this.look += (event.clientY - from[1]) * DEGREES_PER_TOUCH;
      last.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const end of ["pointerup", "pointercancel"]) addEventListener(end, (event) => last.delete(event.pointerId));
  }
}
