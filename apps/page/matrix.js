// Small dense matrices: {rows, cols, data}, doubles, a column after the other.

function matrix(rows, cols, data = new Float64Array(rows * cols)) {
  return {rows, cols, data};
}
function copied(m) {
  return matrix(m.rows, m.cols, m.data.slice());
}
/** The entries at these rows and columns; all columns where none are named. */
function part(m, rows, cols = null) {
  const columns = cols ?? Array.from({length: m.cols}, (_, j) => j);
  const result = matrix(rows.length, columns.length);
  columns.forEach((j, q) => rows.forEach((i, p) => { result.data[q * rows.length + p] = m.data[j * m.rows + i]; }));
  return result;
}
function multiplied(a, b) {
  const result = matrix(a.rows, b.cols), n = a.rows;
  for (let j = 0; j < b.cols; ++j)
    for (let k = 0; k < a.cols; ++k) {
      const factor = b.data[j * b.rows + k];
      if (factor === 0) continue;
      for (let i = 0, to = j * n, from = k * n; i < n; ++i) result.data[to + i] += a.data[from + i] * factor;
    }
  return result;
}
function transposed(m) {
  const result = matrix(m.cols, m.rows);
  for (let j = 0; j < m.cols; ++j)
    for (let i = 0; i < m.rows; ++i) result.data[i * m.cols + j] = m.data[j * m.rows + i];
  return result;
}
/** Adds m x to `to`. */
function addProduct(to, m, x) {
  for (let j = 0; j < m.cols; ++j)
    for (let i = 0; i < m.rows; ++i) to[i] += m.data[j * m.rows + i] * x[j];
}

function identity(n) {
  const result = matrix(n, n);
  for (let i = 0; i < n; ++i) result.data[i * n + i] = 1;
  return result;
}
function added(a, b, factor = 1) {
  return matrix(a.rows, a.cols, a.data.map((v, i) => v + factor * b.data[i]));
}
function scaled(m, factor) {
  return matrix(m.rows, m.cols, m.data.map((v) => v * factor));
}
function firstColumns(m, count) {
  return matrix(m.rows, count, m.data.slice(0, count * m.rows));
}
/** The columns times these factors. */
function scaledColumns(m, factors) {
  return matrix(m.rows, m.cols, m.data.map((v, i) => v * factors[Math.floor(i / m.rows)]));
}
/** m x. */
function times(m, x) {
  const result = new Float64Array(m.rows);
  addProduct(result, m, x);
  return result;
}

/** P = A P A' + B B' by doubling; null where there is none. */
function stationaryCovariance(A, B) {
  let covariance = multiplied(B, transposed(B)), power = A;
  for (let step = 0; step < 64; ++step) {
    const more = multiplied(multiplied(power, covariance), transposed(power));
    for (let i = 0; i < more.data.length; ++i) covariance.data[i] += more.data[i];
    power = multiplied(power, power);
    const whole = norm(covariance);
    if (!Number.isFinite(whole)) return null;
    if (norm(more) <= Number.EPSILON * whole) return covariance;
  }
  return null;
}
function norm(m) {
  let sum = 0;
  for (const v of m.data) sum += v * v;
  return Math.sqrt(sum);
}

/** One rotation of Jacobi's method: makes entry (p, q) of the symmetric matrix 0. */
function rotate(a, vectors, p, q) {
  const n = a.rows, d = a.data, v = vectors.data, apq = d[q * n + p];
  const slope = (d[q * n + q] - d[p * n + p]) / (2 * apq);
  const t = (slope >= 0 ? 1 : -1) / (Math.abs(slope) + Math.sqrt(1 + slope * slope));
  const c = 1 / Math.sqrt(1 + t * t), s = t * c;
  for (let k = 0; k < n; ++k) {
    const kp = d[p * n + k], kq = d[q * n + k];
    d[p * n + k] = c * kp - s * kq;
    d[q * n + k] = s * kp + c * kq;
  }
  for (let k = 0; k < n; ++k) {
    const pk = d[k * n + p], qk = d[k * n + q];
    d[k * n + p] = c * pk - s * qk;
    d[k * n + q] = s * pk + c * qk;
    const vp = v[p * n + k], vq = v[q * n + k];
    v[p * n + k] = c * vp - s * vq;
    v[q * n + k] = s * vp + c * vq;
  }
  d[q * n + p] = d[p * n + q] = 0;
}

/** Eigenvalues of a symmetric matrix, falling, and their vectors, of each the largest entry positive. */
function symmetricEigen(symmetric) {
  const n = symmetric.rows, a = copied(symmetric), vectors = matrix(n, n), negligible = 1e-17 * norm(symmetric);
  for (let i = 0; i < n; ++i) vectors.data[i * n + i] = 1;
  for (let sweep = 0, turned = true; sweep < 60 && turned; ++sweep) {
    turned = false;
    for (let p = 0; p < n; ++p)
      for (let q = p + 1; q < n; ++q) {
        if (!(Math.abs(a.data[q * n + p]) > negligible)) continue;
        rotate(a, vectors, p, q);
        turned = true;
      }
  }
  const order = Array.from({length: n}, (_, i) => i).sort((i, k) => a.data[k * n + k] - a.data[i * n + i]);
  const sorted = part(vectors, Array.from({length: n}, (_, i) => i), order);
  for (let j = 0; j < n; ++j) {
    const column = sorted.data.subarray(j * n, (j + 1) * n);
    const largest = column.reduce((best, v) => (Math.abs(v) > Math.abs(best) ? v : best), 0);
    if (largest < 0) for (let i = 0; i < n; ++i) column[i] = -column[i];
  }
  return {values: order.map((i) => a.data[i * n + i]), vectors: sorted};
}
