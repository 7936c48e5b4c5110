// Edits, as `emberfold dytex edit` makes them, in this order: --reverse, --speed, --intensity, --coarse, --medium,
// --fine, --weights.

/** weights: of single components, as in "3:0.5,7:2"; loop: frames after which the clip repeats, 0 where it does not. */
const neutral = {reverse: false, speed: 1, intensity: 1, coarse: 1, medium: 1, fine: 1, weights: "", loop: 0};
const scaleOf = (i) => (i < 5 ? "coarse" : i < 15 ? "medium" : "fine");  // of component i, the first being 0

/** The weights of components, by their numbers from 1 on. */
const weightsOf = (text) => new Map(text === "" ? [] : text.split(",").map((one) => one.split(":").map(Number)));
/** The same as a text, without those that are as learned. */
const weightsText = (weights) => [...weights].filter(([, factor]) => factor !== 1).sort((a, b) => a[0] - b[0])
  .map(([component, factor]) => `${component}:${factor}`).join(",");

/** The model from the page's data: forward and backward, each {A, B, residuals, marginals, groups}. */
function readModel(data, numbers) {
  const direction = (name) => ({
    A: numbers[name + ".A"],
    B: numbers[name + ".B"],
    residuals: data[name].residuals ? numbers.residuals : null,
    marginals: data[name].marginals ? numbers.marginals : null,
    groups: data.groups.map((group, g) => ({
      ...group,
      turning: data[name].turning[g],
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

/** basis D inverse, D the diagonal with its turning blocks at the speed; and how many poles became 0. */
function atSpeed(group, speed) {
  const n = group.diagonal.rows, diagonal = copied(group.diagonal);
  let dropped = 0;
  for (const {first, size, phase} of group.turning) {
    const rows = Array.from({length: size}, (_, i) => first + i);
    const gone = Math.abs(speed) * phase > Math.PI * (1 + 1e-12), angle = (speed - 1) * phase;
    const block = part(group.diagonal, rows, rows), turned = multiplied(block, part(group.turn, rows, rows));
    if (gone) dropped += size;
    for (let j = 0; j < size; ++j)
      for (let i = 0; i < size; ++i)
        diagonal.data[(first + j) * n + first + i] =
          gone ? 0 : Math.cos(angle) * block.data[j * size + i] + Math.sin(angle) * turned.data[j * size + i];
  }
  return {A: multiplied(multiplied(group.basis, diagonal), group.inverse), dropped};
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

function changeSpeed(result, direction, weights, speed) {
  const {A, B} = result, n = A.rows;
  for (const group of direction.groups) {
    const {states} = group, before = part(direction.A, states, states), noise = part(direction.B, states);
    const {A: after, dropped} = atSpeed(group, speed);
    group.contrast ??= contrast(group, weights, before, noise);
    const now = contrast(group, weights, after, noise);
    const factor = now > 0 ? Math.sqrt(group.contrast / now) : 1;
    result.dropped += dropped;
    states.forEach((j, q) => states.forEach((i, p) => { A.data[j * n + i] = after.data[q * states.length + p]; }));
    for (let k = 0; k < B.cols; ++k) for (const i of states) B.data[k * n + i] *= factor;
  }
}

/** {A, B, weights, residuals, marginals, dropped} of the model with the settings. */
function edited(model, settings) {
  const direction = settings.reverse ? model.backward : model.forward;
  const result = {
    A: copied(direction.A), B: copied(direction.B), weights: model.weights.slice(),
    residuals: direction.residuals, marginals: direction.marginals, dropped: 0,
  };
  if (settings.speed !== 1) changeSpeed(result, direction, model.weights, settings.speed);
  const strength = Math.sqrt(settings.intensity);
  for (let i = 0; i < result.B.data.length; ++i) result.B.data[i] *= strength;
  for (const group of direction.groups)
    for (let i = 0; i < group.shown; ++i) result.weights[group.states[i]] *= settings[scaleOf(i)];
  for (const [component, factor] of weightsOf(settings.weights))
    for (const group of direction.groups)
      if (component <= group.shown) result.weights[group.states[component - 1]] *= factor;
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

/** Independent numbers by their quantiles, the first ones; the others are normal. */
function marginalNoise(marginals, count, rng) {
  const {rows, cols, data} = marginals, noise = new Float64Array(count);
  for (let i = 0; i < rows; ++i) {
    const at = rng.uniform() * (cols - 1), below = Math.floor(at);
    const low = data[below * rows + i], high = data[(below + 1) * rows + i];
    noise[i] = low + (at - below) * (high - low);
  }
  for (let i = rows; i < count; ++i) noise[i] = rng.normal();
  return noise;
}

/** What drives a frame from the one before it. */
function drivingNoise({B, residuals, marginals}, seed, frame) {
  const rng = frameStream(seed, frame, purposes.driving);
  if (residuals) {
    const k = residuals.rows, at = rng.below(residuals.cols);
    return residuals.data.subarray(at * k, (at + 1) * k);
  }
  return marginals ? marginalNoise(marginals, B.cols, rng) : rng.normals(B.cols);
}
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
  for (const name of ["speed", "intensity", "coarse", "medium", "fine"])
    if (settings[name] !== 1) words.push(`--${name} ${settings[name]}`);
  const weights = weightsOf(settings.weights);
  if (weights.size > 0) {
    const last = Math.max(...weights.keys());
    words.push("--weights " + Array.from({length: last}, (_, i) => weights.get(i + 1) ?? 1).join(","));
  }
  const to = modelName.replace(/\/+$/, "") + "_edited";
  const synth = (from) => `emberfold dytex synth ${shellWord(from)} -o clip.mp4${settings.loop > 0 ? " --loop " + settings.loop : ""} --seed ${seed}`;
  if (words.length === 0) return synth(modelName);
  return `emberfold dytex edit ${shellWord(modelName)} -o ${shellWord(to)} ${words.join(" ")} && \\\n` + synth(to);
}
