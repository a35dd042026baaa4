// Arrays from a file, as platform/wildscav_stage/scene/arrays.py packs them.

interface Description {
  name: string;
  type: "uint8" | "int32";
  shape: number[];
  at: number;
}

export type Planes = (Uint8Array | Int32Array)[];

// What a packed file holds: what its header says, and the planes of its arrays, some of which may be yet to come.
export class PackedFile {
  readonly fields: Record<string, unknown>;
  private readonly arrays = new Map<string, Description>();

  // content: the arrays, without the header.
  constructor(
    header: string,
    private readonly content: Arriving,
  ) {
    this.fields = JSON.parse(header);
    let size = 0;
    for (const described of this.fields.arrays as Description[]) {
      this.arrays.set(described.name, described);
      size = Math.max(size, endOf(described));
    }
    content.expect(size);
  }

  // Wait until an array is there, and so all before it.
  async has(name: string): Promise<void> {
    await this.content.until(endOf(this.described(name)));
  }

  // Wait for the end of the file: a browser keeps only what was read to its end.
  async end(): Promise<void> {
    await this.content.end();
  }

  // The planes of an array: one for each place along its last axis.
  planes(name: string): Planes {
    const { type, shape, at } = this.described(name);
    const count = countOf(shape) / shape[shape.length - 1];
    const kind = type === "uint8" ? Uint8Array : Int32Array;
    return Array.from({ length: shape[shape.length - 1] }, (_, plane) => {
      const begin = at + plane * count * kind.BYTES_PER_ELEMENT;
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

// Bytes that come one after the other.
export class Arriving {
  private bytes = new Uint8Array(0);
  private count = 0;
  private readonly reader: ReadableStreamDefaultReader<Uint8Array>;

  constructor(stream: ReadableStream<Uint8Array>) {
    this.reader = stream.getReader();
  }

  // Leave room for so many.
  expect(size: number): void {
    if (size <= this.bytes.length) return;
    const larger = new Uint8Array(size);
    larger.set(this.bytes.subarray(0, this.count));
    this.bytes = larger;
  }

  // Wait until so many have come.
  async until(count: number): Promise<void> {
    while (this.count < count) {
      const { done, value } = await this.reader.read();
      if (done) throw new Error("the file ends too early");
      this.expect(this.count + value.length);
      this.bytes.set(value, this.count);
      this.count += value.length;
    }
  }

  async end(): Promise<void> {
    while (!(await this.reader.read()).done);
  }

  slice(begin: number, end: number): ArrayBuffer {
    return this.bytes.slice(begin, end).buffer;
  }

  // Forget so many at the beginning.
  drop(count: number): void {
    this.bytes = this.bytes.slice(count);
    this.count -= count;
  }
}

// Read the header of a packed file, whose arrays may come later.
export async function openPacked(stream: ReadableStream<Uint8Array>): Promise<PackedFile> {
  const content = new Arriving(stream);
  await content.until(4);
  const length = new DataView(content.slice(0, 4)).getUint32(0, true);
  await content.until(4 + length);
  const header = new TextDecoder().decode(content.slice(4, 4 + length));
  content.drop(4 + length);
  return new PackedFile(header, content);
}

function countOf(shape: number[]): number {
  return shape.reduce((product, size) => product * size, 1);
}

function endOf({ type, shape, at }: Description): number {
  return at + countOf(shape) * (type === "uint8" ? 1 : 4);
}

// A stream that may be compressed with gzip, uncompressed; a server may have told the browser so, which then did it.
export async function unzipped(stream: ReadableStream<Uint8Array>): Promise<ReadableStream<Uint8Array>> {
  const [look, whole] = stream.tee();
  const reader = look.getReader();
  const { value } = await reader.read();
  reader.cancel();
  if (value?.[0] !== 0x1f || value[1] !== 0x8b) return whole;
  return whole.pipeThrough(new DecompressionStream("gzip") as ReadableWritablePair<Uint8Array, Uint8Array>);
}
