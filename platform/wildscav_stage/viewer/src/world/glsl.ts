// What all shaders of the world share. Places and directions are in the game's frame: x east, y up, z north.
// Colours are as the engine's cameras compute with them: 0-1, without conversion. DETAIL says how much of surfaces
// is drawn: 0 = the coarser grain of the ground, 1 = textures of solids as well, 2 = the finest grain too.

export const COMMON = /* glsl */ `
uniform vec3 eye; // m
uniform float far; // m, where everything has faded into the haze; 0 without haze
uniform float pixel; // m, the side of a pixel 1 m away; without perspective anywhere
uniform vec3 sun, sunlight, skylight, zenith, horizon, below, disc, cloud, ceiling, deep;
uniform float direct; // see Light in data/map.ts
uniform vec2 open, roofed, side;
uniform sampler2D noiseMap;
uniform highp sampler2DShadow shadowMap, roofMap;
uniform vec4 shadowFrame; // half the side of the map, lowest and highest place, and whether there are shadows
uniform vec2 viewport; // pixels of the picture
uniform float perPixel; // of them in a CSS pixel
uniform vec4 zone; // x, z and radius of the safe zone, and whether there is one

float square(float value) { return value * value; }

// Smooth noise 0-1 over a plane.
float noise(vec2 at) {
  vec2 corner = floor(at), share = at - corner;
  share = share * share * (3.0 - 2.0 * share);
  return texture(noiseMap, (corner + share + 0.5) * (1.0 / 128.0)).r;
}

// A number 0-1 for a point of a lattice.
float grain(vec2 at) { return texture(noiseMap, (floor(at) + 0.5) * (1.0 / 128.0)).r; }

// How visible details of some size are, where a pixel has another size.
float sharpness(float size, float footprint) { return clamp(1.6 - footprint * (2.4 / size), 0.0, 1.0); }

// The clear sky in a direction.
vec3 haze(float up) {
  float level = square(square(1.0 - max(0.0, up)));
  return zenith + (horizon - zenith) * level + (below - horizon) * clamp(-2.5 * up, 0.0, 1.0);
}

// Where a place is seen by the sun, or from straight above: see shadow.ts.
vec3 inShadowMap(vec3 place, vec2 lean) {
  vec2 across = (place.xz - lean * (place.y - shadowFrame.y)) / shadowFrame.x;
  return vec3(across, (shadowFrame.z - place.y) / (shadowFrame.z - shadowFrame.y));
}

float sunShare(vec3 place, vec3 normal) {
  if (shadowFrame.w == 0.0) return 1.0;
  vec3 at = inShadowMap(place + 0.09 * normal + vec3(0.0, 0.04, 0.0), sun.xz / sun.y);
  if (abs(at.x) > 1.0 || abs(at.y) > 1.0) return 1.0;
  return texture(shadowMap, vec3(0.5 + 0.5 * at.xy, at.z));
}

// How much of the sky is seen between floors and roofs.
float skyShare(vec3 place, vec3 normal) {
  if (shadowFrame.w == 0.0) return 1.0;
  vec3 at = inShadowMap(place + 0.12 * normal + vec3(0.0, 0.06, 0.0), vec2(0.0));
  if (abs(at.x) > 1.0 || abs(at.y) > 1.0) return 1.0;
  return texture(roofMap, vec3(0.5 + 0.5 * at.xy, at.z));
}

// The light on a surface, given the shares of the sun and of the sky that it sees.
vec3 lightOn(vec3 normal, float shine, float sky) {
  vec2 around = mix(roofed, open, sky);
  float ambient = around.x + dot(normal, vec3(side.x, around.y, side.y));
  return direct * max(0.0, dot(normal, sun)) * shine * sunlight + ambient * skylight;
}

// What is seen of a colour through the air, and where the safe zone does not reach.
vec3 throughAir(vec3 color, vec3 place) {
  if (zone.w > 0.0 && distance(place.xz, zone.xy) > zone.z) {
    color = mix(color, vec3(0.42, 0.16, 0.55) * (0.35 + dot(color, vec3(0.4))), 0.45);
  }
  if (far == 0.0) return color;
  vec3 ray = place - eye;
  float way = length(ray);
  return mix(color, haze(ray.y / way), square(min(1.0, way / far)));
}

// What is seen of an object, on which so much light falls at least.
vec4 objectAt(vec3 place, vec3 facing, vec3 base, float least) {
  vec3 normal = normalize(facing);
  vec3 light = lightOn(normal, sunShare(place, normal), skyShare(place, normal));
  return vec4(throughAir(base * max(light, vec3(least)), place), 1.0);
}
`;

export const PROJECT = /* glsl */ `
vec4 project(vec3 place) { return projectionMatrix * modelViewMatrix * vec4(place, 1.0); }
`;
