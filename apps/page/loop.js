// Clips that repeat, as `emberfold dytex synth --loop` draws them (dytex/synthesis/loop.hpp has the equations).

const leastLoopVariance = 1e-13;  // of the largest; directions below it do not move

function powerOf(base, exponent) {
  let result = identity(base.rows);
  for (; exponent > 0; exponent = Math.floor(exponent / 2)) {
    if (exponent % 2 === 1) result = multiplied(result, base);
    base = multiplied(base, base);
  }
  return result;
}
/** (I - m)^-1 of a matrix whose powers vanish: the product of all I + m^(2^k). */
function closingMatrix(m) {
  const one = identity(m.rows);
  let result = added(one, m);
  for (let step = 0; step < 64; ++step) {
    m = multiplied(m, m);
    const size = norm(m);
    if (size <= Number.EPSILON) return result;
    if (!Number.isFinite(size)) break;
    result = multiplied(result, added(one, m));
  }
  throw new Error("this loop cannot be closed: its motion lasts too long");
}
function squareRoot(positive) {
  const {vectors, values} = symmetricEigen(positive);
  return multiplied(scaledColumns(vectors, values.map((v) => Math.sqrt(Math.max(v, 0)))), transposed(vectors));
}
/** The symmetric M with M from M = to on the range of `from`; 0 across it. */
function transport(from, to) {
  const {vectors, values} = symmetricEigen(from);
  const kept = values.filter((v) => v > leastLoopVariance * values[0]);
  const U = firstColumns(vectors, kept.length);
  const F = scaledColumns(U, kept.map(Math.sqrt)), inverse = scaledColumns(U, kept.map((v) => 1 / Math.sqrt(v)));
  return multiplied(multiplied(inverse, squareRoot(multiplied(multiplied(transposed(F), to), F))), transposed(inverse));
}

/** The states of all frames of a loop. */
function loopStates(edit, seed, frames) {
  const {A, B} = edit, n = A.rows;
  if (n === 0 || B.cols === 0) return Array.from({length: frames}, () => new Float64Array(n));
  const driven = Array.from({length: frames}, (_, t) => times(B, drivingNoise(edit, seed, t + 1)));
  const next = (x, t) => times(A, x).map((v, i) => v + driven[t][i]);
  const once = powerOf(A, frames), close = closingMatrix(once), P = stationaryCovariance(A, B);
  const start = times(close, driven.reduce((x, _, t) => next(x, t), new Float64Array(n)));
  const rest = added(P, multiplied(multiplied(once, P), transposed(once)), -1);
  const even = transport(multiplied(multiplied(close, rest), transposed(close)), P);
  const states = [];
  for (let t = 0, x = start; t < frames; x = next(x, t), ++t) states.push(times(even, x));
  return states;
}
