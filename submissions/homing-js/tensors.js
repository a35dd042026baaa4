// Sensor readings: what a message `Tensor` contains, as typed arrays.

import os from "node:os";

// The types of the sensors' numbers, as NumPy writes them.
const ARRAYS = {
  "|b1": Uint8Array,
  "|u1": Uint8Array,
  "<i4": Int32Array,
  "<f4": Float32Array,
  "<f8": Float64Array,
};

/**
 * Returns readings by the name of their sensor, each as {shape, numbers}; the last axis changes fastest.
 *
 * @throws {Error} for a type that is not known, or an array whose length does not fit its shape.
 */
export function decodeTensors(tensors) {
  return Object.fromEntries(tensors.map((tensor) => [tensor.name, decode(tensor)]));
}

function decode({ name, dtype, shape, data }) {
  const Numbers = ARRAYS[dtype];
  if (Numbers === undefined || os.endianness() !== "LE") {
    throw new Error(`sensor ${name}: numbers of type ${dtype} cannot be read here`);
  }
  const length = shape.reduce((product, axis) => product * axis, 1);
  if (data.length !== length * Numbers.BYTES_PER_ELEMENT) {
    throw new Error(`sensor ${name}: ${data.length} bytes are no ${dtype} of shape ${shape}`);
  }
  // A typed array must begin at a multiple of its number's size, which bytes of a message need not: copy them.
  return { shape, numbers: new Numbers(new Uint8Array(data).buffer) };
}
