// Edits, as `emberfold dytex edit` makes them, in this order: --reverse, --speed, --flow, --intensity, --coarse, --medium, --fine,
// --weights.

/**
 * weights: of single components, as in "3:0.5,7:2"; loop: frames after which the clip repeats, 0 where it does not.
 */
const neutral = {reverse: false, speed: 1, flow: 1, intensity: 1, coarse: 1, medium: 1, fine: 1, weights: "", loop: 0};
const scaleOf = (i) => (i < 5 ? "coarse" : i < 15 ? "medium" : "fine");  // of component i, the first being 0

/** The weights of components, by their numbers from 1 on. */
const weightsOf = (text) => new Map(text === "" ? [] : text.split(",").map((one) => one.split(":").map(Number)));
/** The same as a text, without those that are as learned. */
const weightsText = (weights) => [...weights].filter(([, factor]) => factor !== 1).sort((a, b) => a[0] - b[0])
  .map(([component, factor]) => `${component}:${factor}`).join(",");

/** The model from the page's data: forward and backward, each {A, B} and the form of A that the speed changes. */
function readModel(data, numbers) {
  const direction = (name) => ({
    blocks: data[name].blocks,
    ...Object.fromEntries(["A", "B", "basis", "inverse", "diagonal", "turn"].map((part) => [part, numbers[`${name}.${part}`]])),
  });
  return {
    forward: direction("forward"),
    backward: direction("backward"),
    weights: numbers.weights.data,
    states: numbers.states,
  };
}

/** Rows of a block. */
const rowsOf = ({first, size}) => Array.from({length: size}, (_, i) => first + i);
function putPart(m, first, values) {
  for (let j = 0; j < values.cols; ++j)
    for (let i = 0; i < values.rows; ++i) m.data[(first + j) * m.rows + first + i] = values.data[j * values.rows + i];
}

/** The diagonal of a direction with its turning blocks at the speed; and how many poles became 0. */
function diagonalAtSpeed(direction, speed) {
  const diagonal = copied(direction.diagonal);
  let dropped = 0;
  for (const block of direction.blocks.filter(({turns}) => turns)) {
    const rows = rowsOf(block), still = part(diagonal, rows, rows), turned = multiplied(still, part(direction.turn, rows, rows));
    const gone = Math.abs(speed) * block.phase > Math.PI * (1 + 1e-12), angle = (speed - 1) * block.phase;
    if (gone) dropped += block.size;
    const [plain, across] = gone ? [0, 0] : [Math.cos(angle), Math.sin(angle)];
    putPart(diagonal, block.first, matrix(block.size, block.size, still.data.map((v, i) => plain * v + across * turned.data[i])));
  }
  return {diagonal, dropped};
}

/** The power of a diagonal whose blocks are alone, its pairs at the speed. */
function powerOfDiagonal(direction, diagonal, speed, exponent) {
  const result = copied(diagonal), n = diagonal.rows;
  for (const block of direction.blocks) {
    const {first, size, phase} = block, rows = rowsOf(block), d = part(diagonal, rows, rows).data;
    if (size === 1) {
      result.data[first * n + first] = Math.sign(d[0]) * Math.abs(d[0]) ** exponent;
      continue;
    }
    const modulus = Math.max(d[0] * d[3] - d[1] * d[2], 0) ** (exponent / 2), angle = exponent * speed * phase;
    const turn = part(direction.turn, rows, rows).data, c = modulus * Math.cos(angle), s = modulus * Math.sin(angle);
    putPart(result, first, matrix(2, 2, turn.map((v, i) => s * v + (i === 0 || i === 3 ? c : 0))));
  }
  return result;
}

/** Variance of what is shown, tr W P W; unweighted where all weights are 0. */
function contrast(weights, A, B) {
  const P = stationaryCovariance(A, B);
  if (!P) throw new Error("these settings leave the motion without bounds");
  let shown = 0, plain = 0;
  weights.forEach((weight, i) => {
    const variance = P.data[i * P.rows + i];
    shown += variance * weight * weight;
    plain += variance;
  });
  return shown > 0 ? shown : plain;
}

/** B times what brings the contrast back. */
function withContrast(weights, A, B, wanted) {
  const now = contrast(weights, A, B), factor = now > 0 ? Math.sqrt(wanted / now) : 1;
  return scaled(B, factor);
}

/** {A, B, dropped} of a direction at the speed, then the flow. */
function changedDynamics(direction, weights, {speed, flow}) {
  const through = (diagonal) => multiplied(multiplied(direction.basis, diagonal), direction.inverse);
  let {A, B} = direction;
  if ((speed === 1 && flow === 1) || weights.length === 0) return {A, B, dropped: 0};
  direction.contrast ??= contrast(weights, A, B);
  const {diagonal, dropped} = diagonalAtSpeed(direction, speed);
  if (speed !== 1) {
    A = through(diagonal);
    B = withContrast(weights, A, B, direction.contrast);
  }
  if (flow === 0) return {...atRest(A, B), dropped};
  if (flow === 1) return {A, B, dropped};
  if (!direction.blocks.every(({alone}) => alone)) throw new Error("poles of this model lie too close together for another flow of time");
  const P = stationaryCovariance(A, B);
  A = through(powerOfDiagonal(direction, diagonal, speed, flow));
  return {A, B: withContrast(weights, A, noiseThatKeeps(P, A, B), direction.contrast), dropped};
}

/** {A, B, weights, dropped} of the model with the settings. */
function edited(model, settings) {
  const weights = model.weights.map((weight, i) => weight * settings[scaleOf(i)]);
  for (const [component, factor] of weightsOf(settings.weights))
    if (component <= weights.length) weights[component - 1] *= factor;
  const {A, B, dropped} = changedDynamics(settings.reverse ? model.backward : model.forward, model.weights, settings);
  return {A, B: scaled(B, Math.sqrt(settings.intensity)), weights, dropped};
}

/** x(0), drawn from the stationary distribution. */
function firstState(edit, seed) {
  const {vectors, values} = symmetricEigen(stationaryCovariance(edit.A, edit.B));
  const noise = frameStream(seed, 0, purposes.first).normals(edit.A.rows);
  const state = new Float64Array(edit.A.rows);
  addProduct(state, vectors, noise.map((v, i) => v * Math.sqrt(Math.max(values[i], 0))));
  return state;
}

/** What drives a frame from the one before it. */
const drivingNoise = ({B}, seed, frame) => frameStream(seed, frame, purposes.driving).normals(B.cols);
/** x(t) from x(t - 1); t: its frame. */
function nextState(edit, state, seed, frame) {
  const next = times(edit.A, state);
  addProduct(next, edit.B, drivingNoise(edit, seed, frame));
  return next;
}

/** What makes the same clip on the command line, from the first frame on. */
function commandFor(modelName, settings, seed) {
  const words = [];
  if (settings.reverse) words.push("--reverse");
  for (const name of ["speed", "flow", "intensity", "coarse", "medium", "fine"])
    if (settings[name] !== 1) words.push(`--${name} ${settings[name]}`);
  const weights = weightsOf(settings.weights);
  if (weights.size > 0) {
    const last = Math.max(...weights.keys());
    words.push("--weights " + Array.from({length: last}, (_, i) => weights.get(i + 1) ?? 1).join(","));
  }
  const to = modelName.replace(/\/+$/, "") + "_edited";
  const synth = (from, clip) => `emberfold dytex synth ${shellWord(from)} -o ${clip}${settings.loop > 0 ? " --loop " + settings.loop : ""} --seed ${seed}`;
  if (words.length === 0) return synth(modelName, "clip.mp4");
  return `emberfold dytex edit ${shellWord(modelName)} -o ${shellWord(to)} ${words.join(" ")} && \\\n${synth(to, "clip.mp4")}`;
}
