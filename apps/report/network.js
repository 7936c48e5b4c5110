/** A table of numbers in a box of its own. */
function numberTable(box, caption, head, lines) {
  const table = plainTable(caption, head, lines);
  table.style.margin = "0";
  table.caption.style.padding = "8px 12px";
  for (const cell of table.querySelectorAll("tr > :not(:first-child)")) cell.className = "number";
  box.style.marginTop = "14px";
  box.append(table);
}

/** Figures of the network by frame, what changed its topology, and that both agree. */
function buildNetwork() {
  const series = data.network, balance = summary.topology;
  if (!series || !balance) { $("network").hidden = true; return; }
  const um = summary.clip?.pixel_um;
  const plots = [["length", um ? "length, \u00b5m" : "length, px", um ?? 1, "#0068be"], ["tips", "tips", 1, "#b4451f"],
    ["junctions", "junctions", 1, "#1a7f4b"], ["loops", "loops", 1, "#7a3fa8"]];
  const xs = series.length.map((_, i) => Math.min(lastFrame, i * series.step + (series.step - 1) / 2));
  for (const [key, title, unit, colour] of plots) {
    const canvas = make("canvas", {class: "chart short", role: "img", "aria-label": `${title} in each frame`});
    $("network-plots").append(make("figure", {}, canvas, make("figcaption", {}, title)));
    const values = series[key].map((v) => v * unit);
    drawing(canvas, (context, width, height) => {
      const a = axes(context, width, height, [0, lastFrame], [0, Math.max(1e-9, ...values, unit) * 1.1], {left: 52});
      polyline(context, xs.map(a.px), values.map(a.py), colour);
    });
  }
  const sign = (value) => (value > 0 ? "+" : value < 0 ? "\u2212" : "") + number(Math.abs(value));
  const keys = ["tips", "branches", "components", "loops"];
  const lines = entries(balance.changes).filter(([, row]) => row.count > 0)
    .map(([name, row]) => [name.replace("_", " "), number(row.count), ...keys.map((key) => sign(row[key]))]);
  lines.push(["all of them", "", ...keys.map((key) => sign(balance.said[key]))],
    ["last frame less first", "", ...keys.map((key) => sign(balance.measured[key]))]);
  numberTable($("balance"), "What changed the topology, of any probability", ["", "number", "tips", "branches", "components", "loops"], lines);
  $("balance-caption").textContent = `In ${number(balance.balanced)} of ${number(balance.gaps)} gaps between frames, tips, branches, components and loops change by what is told of it ` +
    "(a single patch has two tips; a junction of three arms is one branch, of four two). topology.csv has each change, tips.csv what tips do.";
}

/** What a review says of the rates. */
function buildReview() {
  const review = summary.review;
  if (!review) return;
  $("reviewed").hidden = false;
  const told = review.yes + review.no + review.other;
  $("review-lead").textContent = `${plural(told, "event")} ${told === 1 ? "was" : "were"} answered: ${number(review.yes)} happened, ${number(review.no)} did not, ${number(review.other)} were of another class; ${number(review.added)} were added. ` +
    "They are facts here; the others were inferred anew from them. Intervals hold 90 % of what is then left open. Nothing is known of what neither program nor person saw.";
  const digits = (value) => (value >= 100 ? 0 : value >= 1 ? 1 : 3);
  const cell = (interval) => interval ? `${number(interval.mean, digits(interval.mean))} (${number(interval.low, digits(interval.mean))} to ${number(interval.high, digits(interval.mean))})` : "\u2013";
  numberTable($("review-table"), "Corrected by the review", ["", "events", "a frame", "a second"],
    entries(review.classes).map(([name, row]) => [name, cell(row.count), cell(row.a_frame), cell(row.a_second)]));
}
