// Random numbers, the same as core::Rng's: Philox4x32-10 (Salmon et al. 2011), counter-based.

/** High and low 32 bits of a product of two 32-bit numbers. */
function product(a, b) {
  const aLow = a & 0xffff, aHigh = a >>> 16, bLow = b & 0xffff, bHigh = b >>> 16;
  const low = aLow * bLow, one = aHigh * bLow, two = aLow * bHigh;
  const middle = (low >>> 16) + (one & 0xffff) + (two & 0xffff);
  return [(aHigh * bHigh + (one >>> 16) + (two >>> 16) + (middle >>> 16)) >>> 0,
          ((middle << 16) | (low & 0xffff)) >>> 0];
}

function philox4x32(counter, key) {
  let [c0, c1, c2, c3] = counter, [k0, k1] = key;
  for (let round = 0; round < 10; ++round) {
    const [high0, low0] = product(0xd2511f53, c0), [high1, low1] = product(0xcd9e8d57, c2);
    c0 = (high1 ^ c1 ^ k0) >>> 0;
    c1 = low1;
    c2 = (high0 ^ c3 ^ k1) >>> 0;
    c3 = low0;
    k0 = (k0 + 0x9e3779b9) >>> 0;
    k1 = (k1 + 0xbb67ae85) >>> 0;
  }
  return [c0, c1, c2, c3];
}

/** A stream of a seed. seed: BigInt, 0 ... 2^64 - 1; stream: three 32-bit numbers. */
class Rng {
  constructor(seed, stream) {
    this.key = [Number(seed & 0xffffffffn), Number(seed >> 32n)];
    this.counter = [0, ...stream];
    this.block = [];
    this.spare = null;
  }
  bits() {
    if (this.block.length === 0) {
      this.block = philox4x32(this.counter, this.key).reverse();
      this.counter[0] = (this.counter[0] + 1) >>> 0;
    }
    return this.block.pop();
  }
  /** On [0, 1), a multiple of 2^-53. */
  uniform() {
    const high = this.bits() >>> 5, low = this.bits() >>> 6;
    return (high * 2 ** 26 + low) * 2 ** -53;
  }
  /** On 0 ... count - 1, without bias. */
  below(count) {
    const remainder = 2 ** 32 % count;
    for (;;) {
      const [high, low] = product(this.bits(), count);
      if (low >= remainder) return high;
    }
  }
  normal() {
    if (this.spare !== null) {
      const spare = this.spare;
      this.spare = null;
      return spare;
    }
    const radius = Math.sqrt(-2 * Math.log(1 - this.uniform()));
    const angle = 2 * Math.PI * this.uniform();
    this.spare = radius * Math.sin(angle);
    return radius * Math.cos(angle);
  }
  normals(count) {
    return Float64Array.from({length: count}, () => this.normal());
  }
}

/** Streams as dytex::Synthesis names them. */
const purposes = {first: 1, driving: 2};
function frameStream(seed, frame, purpose) {
  return new Rng(seed, [frame >>> 0, 0, (purpose + Math.floor(frame / 2 ** 32) * 4) >>> 0]);
}
