// ---- how sure the sampler is

const chainColours = ["#0068be", "#d68100", "#009268", "#c83232", "#96469a", "#5b6270", "#7a5a00", "#30a0b0"];
const svgText = (text, attributes) => {
  const node = makeSvg("text", {"font-size": 11, fill: themed("soft"), ...attributes});
  node.textContent = text;
  return node;
};

function buildSampler() {
  const sampler = data.sampler;
  if (!sampler) return;
  $("sure").hidden = false;
  $("sure-lead").textContent = `${plural(sampler.chains, "chain")} of ${plural(sampler.length, "sweep")} each, the first ${number(sampler.burn_in)} of them for learning alone; ${number(sampler.proposals)} proposals.`;
  for (const sentence of sampler.sentences) $("sure-says").append(make("p", {class: sampler.sure ? "" : "note"}, sentence));
  buildProbabilities(sampler.probabilities);
  buildRateIntervals(sampler.rates);
  buildDiagnoses(sampler);
  $("traces").append(...sampler.traces.map((trace) => {
    const {svg, low, high} = drawTrace(trace, sampler);
    return make("figure", {}, svg, make("figcaption", {}, trace.name, ...(low < high ? [make("span", {class: "below"}, `, ${figure(low)} to ${figure(high)}`)] : [])));
  }));
  const thinned = sampler.step > 1 ? ` Every ${sampler.step}. sweep is drawn.` : "";
  const left = sampler.traces_total > sampler.traces.length ? ` ${sampler.traces.length} of ${sampler.traces_total} traces are shown.` : "";
  $("traces-caption").textContent = `One colour for each chain, sweeps from left to right; the shaded ones are burn-in and count for nothing.${thinned}${left}`;
}

/** The plot, and the values at its lower and upper edge. */
function drawTrace(trace, sampler) {
  const width = 340, height = 118, left = 6, right = width - 6, top = 6, bottom = height - 18;
  const svg = makeSvg("svg", {viewBox: `0 0 ${width} ${height}`, role: "img", class: "trace"});
  const title = makeSvg("title");
  title.textContent = `${trace.name}, sweep after sweep, ${plural(trace.chains.length, "chain")}`;
  svg.append(title);
  // burn-in may start far away: the plot is about what follows, and its beginning leaves the frame
  const kept = trace.chains.flatMap((chain) => chain.filter((v, i) => v !== null && i * sampler.step >= sampler.burn_in));
  const all = trace.chains.flat().filter((v) => v !== null), base = kept.length ? kept : all;
  let [low, high] = [base.reduce((a, b) => Math.min(a, b), Infinity), base.reduce((a, b) => Math.max(a, b), -Infinity)];
  if (!all.length) return {svg};
  const room = Math.max((high - low) * .6, Math.abs(high) * 1e-3, 1e-9);
  low = Math.max(all.reduce((a, b) => Math.min(a, b)), low - room) - room * .08;
  high = Math.min(all.reduce((a, b) => Math.max(a, b)), high + room) + room * .08;
  const px = (i) => left + i * sampler.step / Math.max(1, sampler.length - 1) * (right - left);
  const py = (v) => bottom - Math.min(1.05, Math.max(-.05, (v - low) / (high - low))) * (bottom - top);
  const burnt = left + Math.min(1, sampler.burn_in / Math.max(1, sampler.length - 1)) * (right - left);
  svg.append(makeSvg("rect", {x: left, y: top, width: right - left, height: bottom - top, fill: themed("ground")}));
  if (sampler.burn_in > 0) svg.append(makeSvg("rect", {x: left, y: top, width: burnt - left, height: bottom - top, fill: "#e2e6ec"}));
  trace.chains.forEach((chain, c) => {
    let d = "", pen = "M";
    chain.forEach((v, i) => {
      if (v === null) { pen = "M"; return; }
      d += `${pen}${px(i).toFixed(1)} ${py(v).toFixed(1)}`;
      pen = "L";
    });
    svg.append(makeSvg("path", {d, fill: "none", stroke: chainColours[c % chainColours.length], "stroke-width": 1.1, "stroke-opacity": .85, "stroke-linejoin": "round"}));
  });
  svg.append(svgText("0", {x: left, y: height - 5}), svgText(`sweep ${number(sampler.length - 1)}`, {x: right, y: height - 5, "text-anchor": "end"}));
  return {svg, low, high};
}

function buildDiagnoses(sampler) {
  const bad = (text, poor) => (poor ? make("strong", {class: "poor"}, text) : text);
  const value = (v) => (v === null ? "\u2013" : figure(v));
  $("diagnoses").append(tableBox("What the chains tell of themselves, after burn-in", ["", "mean", "SD", "R-hat", "effective draws"],
    sampler.table.map((row) => [row.name, value(row.mean), value(row.sd),
      row.rhat === null ? "\u2013" : bad(number(row.rhat, 3), row.rhat > 1.05),
      row.bulk_ess === null ? "\u2013" : bad(number(row.bulk_ess), row.bulk_ess < 100)])));
}

/** How many events have which probability: one bar for each tenth, its classes one above the other. */
function buildProbabilities(probabilities) {
  const totals = Array.from({length: 10}, (_, k) => sum(probabilities.tenths.map((list) => list[k]))), top = Math.max(1, ...totals);
  if (sum(totals) === 0) { $("probability-figure").hidden = true; return; }
  const width = 480, height = 170, left = 10, right = width - 10, base = height - 32, tall = base - 24, bar = (right - left) / 10;
  const svg = makeSvg("svg", {viewBox: `0 0 ${width} ${height}`, role: "img"});
  const title = makeSvg("title");
  title.textContent = "Events by probability";
  svg.append(title);
  svg.append(makeSvg("rect", {x: left, y: 10, width: bar * 5, height: base - 10, fill: themed("hover")}));
  svg.append(svgText("in events_all.json only", {x: left + bar + 6, y: 22}));
  totals.forEach((total, k) => {
    const x = left + bar * k;
    let y = base;
    classes.forEach((kind, type) => {
      const part = probabilities.tenths[type][k] / top * tall;
      if (part <= 0) return;
      y -= part;
      svg.append(makeSvg("rect", {x: x + 2, y, width: bar - 4, height: part, fill: kind.colour, "fill-opacity": k < 5 ? .45 : .9}));
    });
    if (total > 0) svg.append(svgText(number(total), {x: x + bar / 2, y: y - 4, "text-anchor": "middle"}));
  });
  svg.append(makeSvg("path", {d: `M${left} ${base}H${right}`, stroke: themed("faint"), "stroke-width": 1}));
  for (let k = 0; k <= 10; k += 1) svg.append(svgText((k / 10).toFixed(1), {x: left + bar * k, y: base + 14, "text-anchor": k === 0 ? "start" : k === 10 ? "end" : "middle"}));
  svg.append(svgText("probability", {x: right, y: base + 28, "text-anchor": "end"}));
  $("probabilities").append(svg);
  const certain = sum(probabilities.tenths.map((list) => list[9])), likely = sum(totals.slice(5));
  const expected = classes.map((kind, k) => [kind.name, probabilities.expected[k]]).filter(([, value]) => value > 0);
  $("probability-caption").textContent = `${number(likely)} events are likelier than not, ${number(certain)} of them have a probability of 0.9 or more. Expected to be true in all: ${number(sum(expected.map(([, v]) => v)), 0)} (${expected.map(([name, v]) => `${name} ${figure(v)}`).join(", ")}).`;
}

/** Rates, each with a line for its interval; the lines share one logarithmic scale. */
function buildRateIntervals(rates) {
  if (!rates.length) { $("rate-intervals").hidden = true; return; }
  const ends = rates.flatMap((r) => [r.low, r.rate, r.high]).filter((v) => v > 0).map(Math.log10);
  const low = Math.floor(Math.min(0, ...ends)), high = Math.ceil(Math.max(low + 1, ...ends));
  const at = (v) => 4 + 112 * Math.min(1, Math.max(0, ((v > 0 ? Math.log10(v) : low) - low) / (high - low)));
  const whisker = (rate) => {
    const svg = makeSvg("svg", {viewBox: "0 0 120 14", class: "whisker", "aria-hidden": "true"});
    svg.append(makeSvg("path", {d: "M4 7H116", stroke: themed("line"), "stroke-width": 1}));
    svg.append(makeSvg("path", {d: `M${at(rate.low).toFixed(1)} 7H${at(rate.high).toFixed(1)}`, stroke: themed("accent"), "stroke-width": 3, "stroke-linecap": "round"}));
    svg.append(makeSvg("circle", {cx: at(rate.rate).toFixed(1), cy: 7, r: 3.5, fill: "#fff", stroke: themed("accent"), "stroke-width": 2}));
    return svg;
  };
  $("rate-intervals").append(tableBox("Rates, with what holds 90 % of their probability", ["", "rate", "from", "to", `10${raised(low)} to 10${raised(high)}`],
    rates.map((r) => [make("span", {}, r.name, " ", make("span", {class: "below"}, r.unit)), figure(r.rate), figure(r.low), figure(r.high), whisker(r)])));
}
