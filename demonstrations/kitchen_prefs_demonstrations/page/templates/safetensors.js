// Weights as checkpoints hold them: the format of safetensors.

const DTYPES = {
  F32: (bytes) => new Float32Array(bytes.buffer),
  F16: (bytes) => Float32Array.from(new Uint16Array(bytes.buffer), fromHalf),
  BF16: (bytes) => {
    const upperHalves = Uint32Array.from(new Uint16Array(bytes.buffer), (bits) => bits << 16);
    return new Float32Array(upperHalves.buffer);
  },
};

/** A number of half precision: a sign, five bits of exponent, ten of fraction. */
function fromHalf(bits) {
  const [sign, exponent, fraction] = [bits >> 15 ? -1 : 1, (bits >> 10) & 31, bits & 1023];
  if (exponent === 31) return fraction ? NaN : sign * Infinity;
  if (exponent === 0) return sign * 2 ** -14 * (fraction / 1024);
  return sign * 2 ** (exponent - 15) * (1 + fraction / 1024);
}

/** The tensors of a file by their names: { shape, values }. */
function readSafetensors(bytes) {
  const begin = 8 + Number(new DataView(bytes.buffer).getBigUint64(0, true));
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(8, begin)));
  delete header.__metadata__;
  return Object.fromEntries(Object.entries(header).map(([name, { dtype, shape, data_offsets }]) => {
    const [from, to] = data_offsets;
    return [name, { shape, values: DTYPES[dtype](bytes.slice(begin + from, begin + to)) }];
  }));
}

/** The weights of one module: those whose names begin with its name. */
function weightsOf(weights, module) {
  const prefix = `${module}.`;
  const inside = Object.entries(weights).filter(([name]) => name.startsWith(prefix));
  return Object.fromEntries(inside.map(([name, one]) => [name.slice(prefix.length), one]));
}
