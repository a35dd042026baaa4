// Arrays from a file, as platform/wildscav_stage/scene/arrays.py packs them.

interface Description {
  name: string;
  type: "uint8" | "int32";
  shape: number[];
  at: number;
}

export type Planes = (Uint8Array | Int32Array)[];

// What a packed file holds: what its header says, and the planes of its arrays.
export class PackedFile {
  readonly fields: Record<string, unknown>;
  private readonly arrays = new Map<string, Description>();
  private readonly start: number;

  constructor(private readonly content: ArrayBuffer) {
    const length = new DataView(content).getUint32(0, true);
    this.start = 4 + length;
    this.fields = JSON.parse(new TextDecoder().decode(new Uint8Array(content, 4, length)));
    for (const described of this.fields.arrays as Description[]) this.arrays.set(described.name, described);
  }

  // The planes of an array: one for each place along its last axis.
  planes(name: string): Planes {
    const { type, shape, at } = this.described(name);
    const count = shape.slice(0, -1).reduce((product, size) => product * size, 1);
    const kind = type === "uint8" ? Uint8Array : Int32Array;
    return Array.from({ length: shape[shape.length - 1] }, (_, plane) => {
      const begin = this.start + at + plane * count * kind.BYTES_PER_ELEMENT;
      const values = new kind(this.content.slice(begin, begin + count * kind.BYTES_PER_ELEMENT));
      for (let place = 1; place < count; place++) values[place] += values[place - 1];
      return values;
    });
  }

  shape(name: string): number[] {
    return this.described(name).shape;
  }

  private described(name: string): Description {
    const described = this.arrays.get(name);
    if (!described) throw new Error(`the file has no array "${name}"`);
    return described;
  }
}

// The content of a file that is compressed with gzip; a server may have told the browser so, which then did it.
export async function unzipped(content: ArrayBuffer): Promise<ArrayBuffer> {
  const start = new Uint8Array(content, 0, Math.min(2, content.byteLength));
  if (start[0] !== 0x1f || start[1] !== 0x8b) return content;
  const stream = new Blob([content]).stream().pipeThrough(new DecompressionStream("gzip"));
  return await new Response(stream).arrayBuffer();
}
