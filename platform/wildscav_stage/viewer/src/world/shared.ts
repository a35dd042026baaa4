// The numbers and textures that all shaders of a world share.

import {
  ClampToEdgeWrapping,
  DataTexture,
  type DepthTexture,
  GLSL3,
  LinearFilter,
  Matrix4,
  RedFormat,
  RepeatWrapping,
  ShaderMaterial,
  type ShaderMaterialParameters,
  Vector2,
  Vector3,
  Vector4,
} from "three";
import type { Color, Light } from "../data/map";
import { CLOUDS, clouds, lattice, PERIOD } from "../view/noise";
import { COMMON, PROJECT } from "./glsl";

export interface Shared {
  eye: { value: Vector3 };
  far: { value: number };
  pixel: { value: number };
  viewport: { value: Vector2 };
  perPixel: { value: number };
  toPlace: { value: Matrix4 }; // from a place on the screen to one in the world
  shadowMap: { value: DepthTexture | null };
  roofMap: { value: DepthTexture | null };
  shadowFrame: { value: Vector4 };
  sun: { value: Vector3 };
  zone: { value: Vector4 };
  [name: string]: { value: unknown };
}

export interface Sharing {
  shared: Shared;
  // Draw surfaces with so much detail from now on; see glsl.ts.
  setDetail(detail: number): void;
  dispose(): void;
}

const materialsOf = new WeakMap<Shared, ShaderMaterial[]>();

export function createShared(light: Light): Sharing {
  const noise = map(lattice(), PERIOD, true);
  const sky = map(clouds(), CLOUDS, false);
  const color = (value: Color) => ({ value: new Vector3(...value).divideScalar(255) });
  const shared: Shared = {
    eye: { value: new Vector3() },
    far: { value: 0 },
    pixel: { value: 0.001 },
    viewport: { value: new Vector2() },
    perPixel: { value: 1 },
    toPlace: { value: new Matrix4() },
    shadowMap: { value: null },
    roofMap: { value: null },
    shadowFrame: { value: new Vector4() },
    zone: { value: new Vector4() },
    sun: { value: new Vector3(...light.sun).normalize() },
    sunlight: { value: new Vector3(...light.sunlight) },
    skylight: { value: new Vector3(...light.skylight) },
    zenith: color(light.zenith),
    horizon: color(light.horizon),
    below: color(light.below),
    disc: color(light.disc),
    cloud: color(light.cloud),
    ceiling: color(light.ceiling),
    deep: color(light.deep),
    direct: { value: light.direct },
    open: { value: new Vector2(...light.open) },
    roofed: { value: new Vector2(...light.roofed) },
    side: { value: new Vector2(...light.side) },
    noiseMap: { value: noise },
    cloudMap: { value: sky },
  };
  const materials: ShaderMaterial[] = [];
  materialsOf.set(shared, materials);
  return {
    shared,
    setDetail: (detail) => {
      for (const each of materials) {
        if (each.defines.DETAIL === detail) continue;
        each.defines.DETAIL = detail;
        each.needsUpdate = true;
      }
    },
    dispose: () => {
      for (const each of materials) each.dispose();
      noise.dispose();
      sky.dispose();
    },
  };
}

// A material of shaders that begin with what all share; it is freed with that.
export function material(
  shared: Shared,
  vertex: string,
  fragment: string,
  others: ShaderMaterialParameters = {},
): ShaderMaterial {
  const made = new ShaderMaterial({
    ...others,
    glslVersion: GLSL3,
    defines: { DETAIL: 0, ...others.defines },
    uniforms: { ...shared, ...others.uniforms },
    vertexShader: COMMON + PROJECT + vertex,
    fragmentShader: `${COMMON}out vec4 shown;\n${fragment}`,
  });
  materialsOf.get(shared)?.push(made);
  return made;
}

function map(values: Uint8Array<ArrayBuffer>, side: number, isEndless: boolean): DataTexture {
  const texture = new DataTexture(values, side, side, RedFormat);
  texture.wrapS = texture.wrapT = isEndless ? RepeatWrapping : ClampToEdgeWrapping;
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}
