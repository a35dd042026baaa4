// What stands still, kept as a picture with its depths while the camera does not move. Where the processor draws,
// that takes much less time than to draw it again.

import {
  AlwaysDepth,
  type Camera,
  DepthTexture,
  DoubleSide,
  type Group,
  Mesh,
  NearestFilter,
  type Object3D,
  type Scene,
  UnsignedIntType,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { squares } from "./parts";
import { material, type Shared } from "./shared";

const VERTEX = /* glsl */ `
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }`;
const FRAGMENT = /* glsl */ `
uniform sampler2D colors;
uniform highp sampler2D depths;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  shown = vec4(texelFetch(colors, at, 0).rgb, 1.0);
  gl_FragDepth = texelFetch(depths, at, 0).r;
}`;
const NUMBERS = 40; // that say what is seen: two matrices, the zone, the size of the picture, and two more

export class Still {
  private readonly target = new WebGLRenderTarget(1, 1, {
    depthTexture: new DepthTexture(1, 1, UnsignedIntType),
  });
  private readonly backdrop: Mesh;
  private readonly seen = new Float64Array(NUMBERS);
  private isKept = false;

  // statics: what stands still, in the scene that root is in.
  constructor(
    private readonly renderer: WebGLRenderer,
    root: Group,
    private readonly statics: Object3D[],
    private readonly shared: Shared,
  ) {
    const { texture, depthTexture } = this.target;
    texture.minFilter = texture.magFilter = NearestFilter;
    const geometry = squares(1);
    geometry.setDrawRange(0, Infinity);
    this.backdrop = new Mesh(
      geometry,
      material(shared, VERTEX, FRAGMENT, {
        ...{ depthFunc: AlwaysDepth, side: DoubleSide },
        uniforms: { colors: { value: texture }, depths: { value: depthTexture } },
      }),
    );
    this.backdrop.frustumCulled = this.backdrop.visible = false;
    this.backdrop.renderOrder = -1;
    root.add(this.backdrop);
  }

  // Draw a picture. look: how statics are drawn, which changes with the view.
  render(scene: Scene, camera: Camera, look: number): void {
    if (this.hasChanged(camera, look)) {
      this.isKept = false;
      this.renderer.render(scene, camera);
      return;
    }
    if (!this.isKept) this.keep(scene, camera);
    const shown = this.statics.map((each) => each.visible);
    for (const each of this.statics) each.visible = false;
    this.backdrop.visible = true;
    this.renderer.render(scene, camera);
    this.backdrop.visible = false;
    this.statics.forEach((each, place) => {
      each.visible = shown[place];
    });
  }

  dispose(): void {
    this.target.dispose();
  }

  // Draw what stands still, and nothing else, to be used for the next pictures.
  private keep(scene: Scene, camera: Camera): void {
    const { x, y } = this.shared.viewport.value;
    this.target.setSize(x, y);
    const others = (this.backdrop.parent?.children ?? []).filter((each) => !this.statics.includes(each));
    const shown = others.map((each) => each.visible);
    for (const each of others) each.visible = false;
    this.renderer.setRenderTarget(this.target);
    this.renderer.clear();
    this.renderer.render(scene, camera);
    this.renderer.setRenderTarget(null);
    others.forEach((each, place) => {
      each.visible = shown[place];
    });
    this.isKept = true;
  }

  // Whether statics look different than when this was last asked.
  private hasChanged(camera: Camera, look: number): boolean {
    const { viewport, zone, far } = this.shared;
    let place = 0;
    let hasChanged = false;
    const compare = (value: number) => {
      if (this.seen[place] !== value) hasChanged = true;
      this.seen[place++] = value;
    };
    camera.matrixWorld.elements.forEach(compare);
    camera.projectionMatrix.elements.forEach(compare);
    for (const each of [zone.value.x, zone.value.y, zone.value.z, zone.value.w]) compare(each);
    for (const each of [viewport.value.x, viewport.value.y, far.value, look]) compare(each);
    return hasChanged;
  }
}
