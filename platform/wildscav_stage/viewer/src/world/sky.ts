// The sky behind everything: a gradient, the sun, and clouds, as rendering/shading/sky.py draws them.

import { BufferAttribute, BufferGeometry, DoubleSide, Mesh } from "three";
import { material, type Shared } from "./shared";

const VERTEX = /* glsl */ `
uniform mat4 toPlace; // from a place on the screen to one in the world
out vec3 ray;
void main() {
  vec4 distant = toPlace * vec4(position.xy, 1.0, 1.0);
  ray = distant.xyz / distant.w - eye;
  gl_Position = vec4(position.xy, 1.0, 1.0);
}`;
const FRAGMENT = /* glsl */ `
uniform sampler2D cloudMap;
in vec3 ray;
void main() {
  vec3 way = normalize(ray);
  vec2 at = way.xz * 1.6 / (max(0.04, way.y) + 0.12);
  float seen = clamp((way.y - 0.04) * 6.0, 0.0, 1.0) * texture(cloudMap, 0.5 + at / 20.0).r;
  float toSun = dot(way, sun);
  float near = max(0.0, (toSun - 0.97) / 0.03);
  float glow = toSun > 0.9994 ? 1.0 : 0.7 * near * near;
  shown = vec4(mix(mix(haze(way.y), cloud, seen), disc, glow), 1.0);
}`;

export function createSky(shared: Shared): Mesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute(
    "position",
    new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3),
  );
  const sky = new Mesh(
    geometry,
    material(shared, VERTEX, FRAGMENT, {
      depthWrite: false,
      side: DoubleSide,
      uniforms: { toPlace: shared.toPlace },
    }),
  );
  sky.frustumCulled = false;
  sky.renderOrder = 1; // after what hides it
  return sky;
}
