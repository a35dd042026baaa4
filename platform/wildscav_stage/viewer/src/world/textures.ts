// The textures of solids, as rendering/shading/surfaces.py makes them: boards, tiles, courses of stone, spots.

export const TEXTURES = /* glsl */ `
const int WALL = 3, FLOOR = 4, STAIR = 5, ROOF = 6, TRUNK = 7, CROWN = 8, ROCK = 9, FURNITURE = 10, BUSH = 11;

// The share of a pixel that evenly spaced lines cover.
float line(float coordinate, float spacing, float width, float footprint) {
  float phase = coordinate / spacing;
  float aside = abs(phase - floor(phase + 0.5)) * spacing;
  float soft = max(0.5 * footprint, 0.25 * width);
  return clamp((0.5 * width + soft - aside) / (2.0 * soft), 0.0, 1.0) * sharpness(spacing, footprint);
}

// How bright spots of some kind are.
float spots(vec3 at, vec3 kind, float footprint) {
  float size = kind.x, seen = kind.z * sharpness(size, footprint);
  if (seen == 0.0) return 1.0;
  float up = at.y * kind.y / size, level = floor(up), rise = up - level;
  vec2 aside = vec2(57.0 * mod(level, 64.0), 113.0 * mod(level, 32.0));
  vec2 over = vec2(57.0 * mod(level + 1.0, 64.0), 113.0 * mod(level + 1.0, 32.0));
  vec2 plane = at.xz / size;
  float bright = mix(noise(plane + aside), noise(plane + over), rise * rise * (3.0 - 2.0 * rise));
  return 1.0 + seen * (bright - 0.5);
}

// The level direction along a face, exactly along or across the boards of its solid where it nearly is.
vec2 alongFace(vec3 normal, vec2 axis) {
  vec2 level = normalize(normal.xz);
  float ahead = dot(level, axis), aside = level.y * axis.x - level.x * axis.y;
  if (abs(ahead) > 0.995) level = sign(ahead) * axis;
  if (abs(aside) > 0.995) level = sign(aside) * vec2(-axis.y, axis.x);
  return vec2(level.y, -level.x);
}

float courses(vec3 at, vec3 normal, vec2 axis, float footprint) {
  float level = length(normal.xz);
  if (level < 0.5) return 1.0;
  float course = floor(at.y / 0.32);
  float along = dot(alongFace(normal, axis), at.xz) + 0.31 * mod(course, 2.0);
  float joint = max(line(at.y, 0.32, 0.016, footprint), line(along, 0.62, 0.016, footprint));
  float own = 1.0 + 0.07 * (grain(vec2(course + 5.0, along / 0.62)) - 0.5) * sharpness(0.32, footprint);
  return own * (1.0 - 0.13 * joint);
}

float boards(float across, float along, float width, float footprint) {
  float board = floor(across / width);
  float piece = floor(along / 2.6 + grain(vec2(board, 7.0)));
  float own = 0.18 * (grain(vec2(board, piece + 11.0)) - 0.5) * sharpness(width, footprint);
  float fibre = 0.10 * sharpness(0.05, footprint);
  if (fibre > 0.0) fibre *= noise(vec2(across / 0.03, along * 2.0)) - 0.5;
  return (1.0 + own + fibre) * (1.0 - 0.40 * line(across, width, 0.014, footprint));
}

float tiles(vec3 at, vec3 normal, vec2 axis, float footprint) {
  float level = length(normal.xz);
  float up = at.y / level, row = floor(up / 0.34);
  float along = dot(alongFace(normal, axis), at.xz) + 0.14 * mod(row, 2.0);
  float own = 0.22 * (grain(vec2(row, along / 0.28)) - 0.5) + 0.16 * (up / 0.34 - row - 0.5);
  float joint = max(line(up, 0.34, 0.03, footprint), 0.6 * line(along, 0.28, 0.02, footprint));
  return (1.0 + sharpness(0.34, footprint) * own) * (1.0 - 0.38 * joint);
}

// The colour of a solid's surface, given the direction of its boards and the size of a pixel there.
vec3 textured(int kind, vec3 color, vec3 normal, vec3 at, vec2 axis, float footprint) {
  float across = axis.y * at.x - axis.x * at.z, along = dot(axis, at.xz);
  bool isTop = normal.y > 0.5;
  if (kind == FLOOR && normal.y < -0.5) return mix(color, ceiling, 0.8);
  if (kind == FLOOR && !isTop) return 0.8 * color;
  if (kind == STAIR && !isTop) return 0.68 * color;
  if (kind == ROOF && normal.y < 0.05) return 0.62 * color;
#if DETAIL < 1
  return color;
#else
  bool isFlat = kind == ROOF && normal.y > 0.995;
  if (kind == FLOOR) color *= boards(across, along, 0.18, footprint);
  else if (kind == STAIR) color *= boards(along, across, 0.3, footprint);
  else if (kind == WALL) color *= courses(at, normal, axis, footprint);
  else if (kind == ROOF && !isFlat) color *= tiles(at, normal, axis, footprint);
  // The sizes of spots in m, how much flatter than wide they are, and between the darkest and the brightest.
  vec3 small = vec3(0.2, 1.0, 0.55), large = vec3(0.75, 1.0, 0.3); // of plants
  if (kind == WALL) small = vec3(0.9, 1.0, 0.07);
  if (kind == TRUNK) small = vec3(0.09, 0.22, 0.5);
  if (kind == FURNITURE) small = vec3(0.14, 6.0, 0.22);
  if (kind == ROCK) small = vec3(0.12, 1.0, 0.3);
  if (kind == ROCK) large = vec3(0.6, 1.0, 0.24);
  if (isFlat) small = vec3(0.15, 1.0, 0.2);
  if (isFlat) large = vec3(1.2, 1.0, 0.12);
  bool hasLarge = isFlat || kind == ROCK || kind == CROWN || kind == BUSH;
  bool hasSmall = hasLarge || kind == WALL || kind == TRUNK || kind == FURNITURE;
  if (hasSmall) color *= spots(at, small, footprint);
  if (hasLarge) color *= spots(at, large, footprint);
  return color;
#endif
}
`;
