// One's own weapon, drawn over the picture: a few boxes, which sway, kick and flash.

import {
  AmbientLight,
  BoxGeometry,
  Color,
  DirectionalLight,
  Group,
  LinearSRGBColorSpace,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PerspectiveCamera,
  Scene,
  type WebGLRenderer,
} from "three";

const FIELD = 50; // degrees up and down
const REST = { x: 0.2, y: -0.21, z: -0.62 }; // m from the eye
const KICK = 90; // ms in which the weapon comes back by about two thirds
const FLASH = 55; // ms
// Width, height, length; right, up, back of the middle, m; colour as it is shown in full light.
const PARTS: [number, number, number, number, number, number, number][] = [
  [0.055, 0.085, 0.34, 0, 0, 0, 0x595d66], // body
  [0.026, 0.026, 0.3, 0, 0.02, -0.32, 0x3d4046], // barrel
  [0.048, 0.056, 0.2, 0, -0.005, -0.2, 0x7d8466], // hand guard
  [0.02, 0.03, 0.02, 0, 0.057, -0.12, 0x33353a], // sight
  [0.042, 0.14, 0.07, 0, -0.1, 0, 0x44474d], // clip
  [0.046, 0.1, 0.06, 0, -0.085, 0.13, 0x5d5348], // grip
  [0.05, 0.09, 0.16, 0, -0.015, 0.24, 0x6a6d75], // stock
];

export class Weapon {
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(FIELD, 1, 0.01, 5);
  private readonly group = new Group();
  private readonly flash = flash();
  private firedAt = -Infinity;
  private phase = 0;

  constructor() {
    for (const [width, height, length, x, y, z, color] of PARTS) {
      const part = new Mesh(
        new BoxGeometry(width, height, length),
        new MeshLambertMaterial({ color: shown(color) }),
      );
      part.position.set(x, y, z);
      this.group.add(part);
    }
    this.flash.position.set(0, 0.02, -0.5);
    this.group.add(this.flash);
    const sun = new DirectionalLight(shown(0xfff3da), 2.2);
    sun.position.set(-0.5, 1, 0.6);
    this.scene.add(this.group, sun, new AmbientLight(shown(0xbcd0e8), 1.6));
  }

  fire(now: number): void {
    this.firedAt = now;
  }

  // speed: m/s of the body. reload: how far a reload has come, 0-1; 0 if there is none.
  draw(renderer: WebGLRenderer, now: number, seconds: number, speed: number, reload: number): void {
    this.phase += seconds * speed * 0.9;
    const kick = Math.exp((this.firedAt - now) / KICK);
    const sway = Math.min(1, speed / 10);
    const down = Math.sin(Math.PI * reload);
    this.group.position.set(
      REST.x + 0.008 * sway * Math.cos(this.phase),
      REST.y - 0.008 * sway * Math.abs(Math.sin(this.phase)) - 0.16 * down,
      REST.z + 0.07 * kick,
    );
    this.group.rotation.set(0.1 * kick - 0.7 * down, 0.06, 0);
    this.flash.visible = now - this.firedAt < FLASH;
    const { width, height } = renderer.domElement;
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    const { autoClear } = renderer;
    renderer.autoClear = false;
    renderer.clearDepth();
    renderer.render(this.scene, this.camera);
    renderer.autoClear = autoClear;
  }

  dispose(): void {
    this.group.traverse((each) => {
      if (!(each instanceof Mesh)) return;
      each.geometry.dispose();
      each.material.dispose();
    });
  }
}

function flash(): Group {
  const group = new Group();
  const material = new MeshBasicMaterial({ color: shown(0xffe9a0) });
  for (const turn of [0.3, 1.35, 2.4]) {
    const ray = new Mesh(new BoxGeometry(0.17, 0.018, 0.02), material);
    ray.rotation.z = turn;
    group.add(ray);
  }
  group.add(new Mesh(new BoxGeometry(0.045, 0.045, 0.1), material));
  return group;
}

// Colours are shown as they are: pictures are not converted from linear light.
function shown(color: number): Color {
  return new Color().setHex(color, LinearSRGBColorSpace);
}
