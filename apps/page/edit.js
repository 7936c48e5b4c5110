// Edits, as `emberfold dytex edit` makes them, in this order: --channel, --reverse, --speed, --flow, --intensity, --coarse, --medium,
// --fine, --weights.

/**
 * weights: of single components, as in "3:0.5,7:2"; channel: the one that is edited, "" for all; loop: frames after which the clip repeats, 0 where it does not;
 * swap: 1 where a mask's black is edited; feather: px, of a mask.
 */
const neutral = {reverse: false, speed: 1, flow: 1, intensity: 1, coarse: 1, medium: 1, fine: 1, weights: "", channel: "", loop: 0, swap: 0, feather: 8};
const channelLetters = ["b", "g", "r"];
const scaleOf = (i) => (i < 5 ? "coarse" : i < 15 ? "medium" : "fine");  // of component i, the first being 0

/** The weights of components, by their numbers from 1 on. */
const weightsOf = (text) => new Map(text === "" ? [] : text.split(",").map((one) => one.split(":").map(Number)));
/** The same as a text, without those that are as learned. */
const weightsText = (weights) => [...weights].filter(([, factor]) => factor !== 1).sort((a, b) => a[0] - b[0])
  .map(([component, factor]) => `${component}:${factor}`).join(",");

/** The model from the page's data: forward and backward, each {A, B, groups}. */
function readModel(data, numbers) {
  const direction = (name) => ({
    A: numbers[name + ".A"],
    B: numbers[name + ".B"],
    groups: data.groups.map((group, g) => ({
      ...group,
      blocks: data[name].blocks[g],
      basis: numbers[`${name}.${g}.basis`],
      inverse: numbers[`${name}.${g}.inverse`],
      diagonal: numbers[`${name}.${g}.diagonal`],
      turn: numbers[`${name}.${g}.turn`],
    })),
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

/** The diagonal with its turning blocks at the speed; and how many poles became 0. */
function diagonalAtSpeed(group, speed) {
  const diagonal = copied(group.diagonal);
  let dropped = 0;
  for (const block of group.blocks.filter(({turns}) => turns)) {
    const rows = rowsOf(block), still = part(diagonal, rows, rows), turned = multiplied(still, part(group.turn, rows, rows));
    const gone = Math.abs(speed) * block.phase > Math.PI * (1 + 1e-12), angle = (speed - 1) * block.phase;
    if (gone) dropped += block.size;
    const [plain, across] = gone ? [0, 0] : [Math.cos(angle), Math.sin(angle)];
    putPart(diagonal, block.first, matrix(block.size, block.size, still.data.map((v, i) => plain * v + across * turned.data[i])));
  }
  return {diagonal, dropped};
}

/** The power of a diagonal whose blocks are alone, its pairs at the speed. */
function powerOfDiagonal(group, diagonal, speed, exponent) {
  const result = copied(diagonal), n = diagonal.rows;
  for (const block of group.blocks) {
    const {first, size, phase} = block, rows = rowsOf(block), d = part(diagonal, rows, rows).data;
    if (size === 1) {
      result.data[first * n + first] = Math.sign(d[0]) * Math.abs(d[0]) ** exponent;
      continue;
    }
    const modulus = Math.max(d[0] * d[3] - d[1] * d[2], 0) ** (exponent / 2), angle = exponent * speed * phase;
    const turn = part(group.turn, rows, rows).data, c = modulus * Math.cos(angle), s = modulus * Math.sin(angle);
    putPart(result, first, matrix(2, 2, turn.map((v, i) => s * v + (i === 0 || i === 3 ? c : 0))));
  }
  return result;
}

/** Variance of what the group shows, tr W P W; unweighted where all weights are 0. */
function contrast(group, weights, A, B) {
  const P = stationaryCovariance(A, B);
  if (!P) throw new Error("these settings leave the motion without bounds");
  let shown = 0, plain = 0;
  for (let i = 0; i < group.shown; ++i) {
    const variance = P.data[i * P.rows + i], weight = weights[group.states[i]];
    shown += variance * weight * weight;
    plain += variance;
  }
  return shown > 0 ? shown : plain;
}

/** B with more columns, of zeros. */
function widened(B, cols) {
  const result = matrix(B.rows, cols);
  result.data.set(B.data);
  return result;
}
/** Gives the group its motion. */
function storeGroup(result, group, A, B) {
  if (B.cols > result.B.cols) result.B = widened(result.B, B.cols);
  const n = result.A.rows, {states} = group, m = states.length;
  states.forEach((j, q) => states.forEach((i, p) => { result.A.data[j * n + i] = A.data[q * m + p]; }));
  for (let k = 0; k < B.cols; ++k) states.forEach((i, p) => { result.B.data[k * n + i] = B.data[k * m + p]; });
}
/** B times what brings the contrast back. */
function withContrast(group, weights, A, B, wanted) {
  const now = contrast(group, weights, A, B), factor = now > 0 ? Math.sqrt(wanted / now) : 1;
  return scaled(B, factor);
}

/** {A, B, dropped} of a group at the speed, then the flow. */
function changedDynamics(group, direction, weights, {speed, flow}) {
  const {states} = group, through = (diagonal) => multiplied(multiplied(group.basis, diagonal), group.inverse);
  let A = part(direction.A, states, states), B = part(direction.B, states);
  if (speed === 1 && flow === 1) return {A, B, dropped: 0};
  group.contrast ??= contrast(group, weights, A, B);
  const {diagonal, dropped} = diagonalAtSpeed(group, speed);
  if (speed !== 1) {
    A = through(diagonal);
    B = withContrast(group, weights, A, B, group.contrast);
  }
  if (flow === 0) return {...atRest(A, B), dropped};
  if (flow === 1) return {A, B, dropped};
  if (!group.blocks.every(({alone}) => alone)) throw new Error("poles of this model lie too close together for another flow of time");
  const P = stationaryCovariance(A, B);
  A = through(powerOfDiagonal(group, diagonal, speed, flow));
  return {A, B: withContrast(group, weights, A, noiseThatKeeps(P, A, B), group.contrast), dropped};
}

/** {A, B, weights, dropped} of the model with the settings. */
function edited(model, settings) {
  const {forward, backward} = model, result = {A: copied(forward.A), B: copied(forward.B), weights: model.weights.slice(), dropped: 0};
  const strength = Math.sqrt(settings.intensity), direction = settings.reverse ? backward : forward;
  for (const group of direction.groups) {
    if (settings.channel !== "" && channelLetters[group.channel] !== settings.channel) continue;
    const {A, B, dropped} = changedDynamics(group, direction, model.weights, settings);
    storeGroup(result, group, A, scaled(B, strength));
    result.dropped += dropped;
    for (let i = 0; i < group.shown; ++i) result.weights[group.states[i]] *= settings[scaleOf(i)];
    for (const [component, factor] of weightsOf(settings.weights))
      if (component <= group.shown) result.weights[group.states[component - 1]] *= factor;
  }
  return result;
}

/** x(0), drawn from the stationary distribution. */
function firstState(edit, seed) {
  const {vectors, values} = symmetricEigen(stationaryCovariance(edit.A, edit.B));
  const noise = frameStream(seed, 0, purposes.first).normals(edit.A.rows);
  const state = new Float64Array(edit.A.rows);
  addProduct(state, vectors, noise.map((v, i) => v * Math.sqrt(Math.max(values[i], 0))));
  return state;
}

/** x(t) from x(t - 1); t: its frame. */
function nextState(edit, state, seed, frame) {
  const next = times(edit.A, state);
  addProduct(next, edit.B, frameStream(seed, frame, purposes.driving).normals(edit.B.cols));
  return next;
}

/** What makes the same clip on the command line, from the first frame on; with a mask (mask.png) in a loop, its two parts. */
function commandFor(modelName, settings, seed, masked) {
  const words = [];
  if (settings.channel !== "") words.push("--channel " + settings.channel);
  const before = words.length;
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
  if (words.length === before) return synth(modelName, "clip.mp4");
  const edit = `emberfold dytex edit ${shellWord(modelName)} -o ${shellWord(to)} ${words.join(" ")}`, all = (...commands) => commands.join(" && \\\n");
  if (!masked) return all(edit, synth(to, "clip.mp4"));
  if (settings.loop > 0) return all(edit, synth(modelName, "learned.avi"), synth(to, "edited.avi"));
  const layer = `--layer ${shellWord(to + ":mask.png")} --feather ${settings.feather}`;
  return all(edit, synth(modelName, "learned.avi"), `emberfold dytex compose learned.avi ${layer} -o clip.mp4 --seed ${seed}`);
}
