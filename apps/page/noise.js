// Noise that keeps a stationary covariance, as dytex/editing/edit_dynamics.cpp finds it.

const lostAtRest = 2 ** -40;  // of a state in a frame: stable all the same
const leastStateVariance = 1e-12, negativeRounding = 1e-13, leastSingular = 1e-12;  // of the largest, or of a matrix's size

/** x = L z of states in their own standard deviations. */
function whitening(covariance) {
  const {vectors, values} = symmetricEigen(covariance);
  if (!(values[0] > 0)) return {L: identity(covariance.rows), inverse: identity(covariance.rows)};
  const scale = values.map((v) => Math.sqrt(Math.max(v, leastStateVariance * values[0])));
  return {L: scaledColumns(vectors, scale), inverse: transposed(scaledColumns(vectors, scale.map((s) => 1 / s)))};
}
/** F with F F' = the symmetric matrix without its negative part. */
function positiveFactor(symmetric, size) {
  const {vectors, values} = symmetricEigen(symmetric), kept = values.filter((v) => v > negativeRounding * size);
  return scaledColumns(firstColumns(vectors, kept.length), kept.map(Math.sqrt));
}

/** v without what lies along the rows, of length 1; null where next to nothing is left. */
function acrossAll(v, rows) {
  const before = Math.hypot(...v), left = v.slice();
  for (const row of [...rows, ...rows]) {  // twice: what rounding left
    const along = row.reduce((sum, x, i) => sum + x * left[i], 0);
    row.forEach((x, i) => { left[i] -= along * x; });
  }
  const length = Math.hypot(...left);
  return length > 1e-6 * before ? left.map((x) => x / length) : null;
}
/** W with W W' = I that is nearest to M, with more columns where M has fewer than rows. */
function nearestOrthogonal(M) {
  const {vectors, values} = symmetricEigen(multiplied(M, transposed(M)));
  const p = M.rows, cols = Math.max(p, M.cols), rows = [];
  for (let i = 0, unit = cols; i < p; ++i) {
    const v = new Float64Array(cols);
    v.set(times(transposed(M), vectors.data.subarray(i * p, (i + 1) * p)));
    let row = values[i] > leastSingular * values[0] ? acrossAll(v, rows) : null;
    while (!row) row = acrossAll(new Float64Array(cols).fill(1, --unit, unit + 1), rows);  // M says nothing: any other
    rows.push(row);
  }
  const V = matrix(cols, p);
  rows.forEach((row, i) => V.data.set(row, i * cols));
  return multiplied(vectors, transposed(V));
}
/** The factor F times an orthogonal matrix that is nearest to `like`. */
function alignedFactor(F, like) {
  if (F.cols === 0) return matrix(like.rows, like.cols);
  return multiplied(F, nearestOrthogonal(multiplied(transposed(F), like)));
}

/** B' with P = A P A' + B' B'', as far as it can be, nearest to B. */
function noiseThatKeeps(P, A, B) {
  const {L, inverse} = whitening(P), left = multiplied(inverse, A);
  const white = multiplied(multiplied(inverse, P), transposed(inverse));
  const rest = added(white, multiplied(multiplied(left, P), transposed(left)), -1);
  const even = scaled(added(rest, transposed(rest)), 0.5);
  return alignedFactor(multiplied(L, positiveFactor(even, norm(white))), B);
}
/** Motion that stands still, anywhere it could be. */
function atRest(A, B) {
  const left = 1 - lostAtRest, {L} = whitening(stationaryCovariance(A, B)), noise = Math.sqrt(1 - left * left);
  return {A: scaled(identity(A.rows), left), B: alignedFactor(scaled(L, noise), B)};
}
