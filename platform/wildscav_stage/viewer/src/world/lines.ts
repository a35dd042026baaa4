// Lines of a constant width on the screen: tracers of shots, and the trails of agents.

import { type BufferGeometry, DoubleSide, Mesh } from "three";
import type { Color } from "../data/map";
import { PerSquare, squares } from "./parts";
import { material, type Shared } from "./shared";

const VERTEX = /* glsl */ `
in vec4 from, to; // m, and the width in pixels; m, and the opacity at the end
in vec4 paint; // and the opacity at the beginning
out vec4 color;
out float aside;
void main() {
  vec4 a = project(from.xyz), b = project(to.xyz);
  float nearest = 0.05;
  if (a.w < nearest && b.w > nearest) a = mix(b, a, (b.w - nearest) / (b.w - a.w));
  if (b.w < nearest && a.w > nearest) b = mix(a, b, (a.w - nearest) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * viewport;
  along = length(along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);
  bool isEnd = position.x > 0.0;
  vec4 middle = isEnd ? b : a;
  aside = position.y;
  color = vec4(paint.rgb, isEnd ? to.w : paint.w);
  middle.xy += (vec2(-along.y, along.x) * position.y + along * position.x * 0.5) * from.w / viewport * middle.w;
  gl_Position = middle;
}`;
const FRAGMENT = /* glsl */ `
in vec4 color;
in float aside;
void main() { shown = vec4(color.rgb, color.a * (1.0 - square(aside) * 0.5)); }`;

export class Lines {
  readonly mesh: Mesh;
  private geometry!: BufferGeometry;
  private from!: PerSquare;
  private to!: PerSquare;
  private paint!: PerSquare;
  private count = 0;

  // isHidden: whether what is before the lines hides them.
  constructor(shared: Shared, capacity: number, isHidden: boolean) {
    this.allocate(capacity);
    this.mesh = new Mesh(
      this.geometry,
      material(shared, VERTEX, FRAGMENT, {
        transparent: true,
        depthWrite: false,
        depthTest: isHidden,
        side: DoubleSide,
      }),
    );
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = isHidden ? 4 : 6;
  }

  begin(most: number): void {
    this.count = 0;
    if (most <= this.from.count) return;
    this.geometry.dispose();
    this.allocate(2 * most);
    this.mesh.geometry = this.geometry;
  }

  // A line from one place to another, its opacity at both, and its width in pixels.
  add(
    x: number,
    y: number,
    z: number,
    toX: number,
    toY: number,
    toZ: number,
    color: Color,
    opacity: number,
    endOpacity: number,
    width: number,
  ): void {
    this.from.set(this.count, x, y, z, width);
    this.to.set(this.count, toX, toY, toZ, endOpacity);
    this.paint.set(this.count, color[0] / 255, color[1] / 255, color[2] / 255, opacity);
    this.count++;
  }

  end(): void {
    this.geometry.setDrawRange(0, 6 * this.count);
    this.mesh.visible = this.count > 0;
    for (const each of [this.from, this.to, this.paint]) each.send(this.count);
  }

  private allocate(capacity: number): void {
    this.geometry = squares(capacity);
    this.from = new PerSquare(this.geometry, "from", capacity);
    this.to = new PerSquare(this.geometry, "to", capacity);
    this.paint = new PerSquare(this.geometry, "paint", capacity);
  }
}
