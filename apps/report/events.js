const events = data.events, eventCount = events.frame.length;
const filter = {shown: classes.map(() => true), from: 0, to: lastFrame, stroke: null};
const sorting = {key: "frame", up: true};
let rows = [];          // indices of the events that pass the filter, in the table's order
let selected = -1, page = 0;
const rowsOnPage = 12;
const filterWatchers = [];

const passes = (i) => filter.shown[events.type[i]] && events.frame[i] >= filter.from && events.frame[i] <= filter.to &&
  (filter.stroke === null || events.before[i].includes(filter.stroke) || events.after[i].includes(filter.stroke));

function refilter() {
  rows = [];
  for (let i = 0; i < eventCount; ++i) if (passes(i)) rows.push(i);
  const column = events[sorting.key], sign = sorting.up ? 1 : -1;
  rows.sort((a, b) => sign * (column[a] - column[b]) || a - b);
  page = 0;
  showTable();
  filterWatchers.forEach((watch) => watch());
}

// ---- the viewer

const viewer = {image: $("event-image"), marks: $("event-marks"), stage: $("event-image").parentElement};
function nearestFrame(frame) {
  let best = null;
  for (const candidate of data.frames)
    if (!best || Math.abs(candidate.frame - frame) < Math.abs(best.frame - frame)) best = candidate;
  return best;
}
function drawCurves(svg, shown, unit) {
  for (const curve of shown.curves) {
    let d = "";
    for (let k = 1; k + 1 < curve.length; k += 2) d += (k === 1 ? "M" : "L") + curve[k] + " " + curve[k + 1];
    if (curve.length === 3) d += "l0.01 0";
    const common = {d, fill: "none", "stroke-linecap": "round", "stroke-linejoin": "round"};
    svg.append(makeSvg("path", {...common, stroke: "#15171c", "stroke-opacity": .6, "stroke-width": 3.4 * unit}));
    svg.append(makeSvg("path", {...common, stroke: curve[0], "stroke-width": 1.8 * unit}));
  }
}
function drawEventMark(svg, i, unit, strong) {
  const d = markPath(events.type[i], events.x[i], events.y[i], (strong ? 11 : 7) * unit);
  const common = {d, fill: "none", "stroke-linejoin": "round", "stroke-opacity": strong ? 1 : .3 + .7 * Math.max(0, 2 * events.p[i] - 1)};
  svg.append(makeSvg("path", {...common, stroke: "#fff", "stroke-width": (strong ? 6 : 4) * unit}));
  svg.append(makeSvg("path", {...common, stroke: classes[events.type[i]].colour, "stroke-width": (strong ? 3 : 2) * unit}));
  if (!strong) return;
  svg.append(makeSvg("circle", {cx: events.x[i], cy: events.y[i], r: 19 * unit, fill: "none", stroke: "#fff",
    "stroke-width": 1.5 * unit, "stroke-dasharray": `${4 * unit} ${3 * unit}`}));
}
const strokeNames = (list) => list.length ? list.join(", ") : "none";
function drawViewer() {
  const shown = selected < 0 ? null : nearestFrame(events.frame[selected]);
  if (!shown) return;
  viewer.image.src = shown.uri;
  viewer.image.alt = `Frame ${shown.frame} of the clip`;
  viewer.stage.style.aspectRatio = `${clip.width} / ${clip.height}`;
  const tall = clip.height / clip.width;
  viewer.stage.style.maxWidth = tall > 1 ? Math.round(520 / tall) + "px" : "";
  const svg = viewer.marks;
  svg.setAttribute("viewBox", `-0.5 -0.5 ${clip.width} ${clip.height}`);
  svg.replaceChildren();
  const unit = clip.width / Math.max(1, viewer.stage.clientWidth || 440);
  if ($("event-sketch").checked) drawCurves(svg, shown, unit);
  if ($("event-others").checked)
    for (let i = 0; i < eventCount; ++i)
      if (events.frame[i] === events.frame[selected] && i !== selected && passes(i)) drawEventMark(svg, i, unit, false);
  drawEventMark(svg, selected, unit, true);
  const frame = events.frame[selected], type = classes[events.type[selected]].name;
  $("event-title").replaceChildren(glyph(events.type[selected]), ` ${type} at frame ${frame}, (${+(events.x[selected] + corner.x).toFixed(1)}, ${+(events.y[selected] + corner.y).toFixed(1)})`);
  $("event-caption").textContent =
    (shown.frame === frame ? `Frame ${frame}. ` : `Frame ${shown.frame} is shown, the nearest that this page carries to frame ${frame}. `) +
    `Strokes before: ${strokeNames(events.before[selected])}; after: ${strokeNames(events.after[selected])}.` +
    (events.p[selected] < 1 ? ` Probability ${number(events.p[selected], 2)}.` : "");
}
function select(i, reveal = false) {
  selected = i;
  const at = rows.indexOf(i);
  if (at >= 0) page = Math.floor(at / rowsOnPage);
  $("event-previous").disabled = at <= 0;
  $("event-next").disabled = at < 0 || at + 1 >= rows.length;
  drawViewer();
  showTable();
  drawLanes();
  if (!reveal) return;
  const box = $("viewer").getBoundingClientRect();
  if (box.top < 0 || box.top > window.innerHeight - 160) $("viewer").scrollIntoView({block: "nearest"});
}
function step(by) {
  const at = rows.indexOf(selected) + by;
  if (at >= 0 && at < rows.length) select(rows[at]);
}

// ---- the table

function showTable() {
  const body = $("table").tBodies[0], pages = Math.max(1, Math.ceil(rows.length / rowsOnPage));
  page = Math.min(page, pages - 1);
  body.replaceChildren(...rows.slice(page * rowsOnPage, (page + 1) * rowsOnPage).map((i) => make("tr", {
    tabindex: 0, "aria-selected": i === selected,
    onclick: () => select(i, true),
    onkeydown: (key) => { if (key.key === "Enter" || key.key === " ") { key.preventDefault(); select(i, true); } },
  },
  make("td", {}, String(events.frame[i])),
  make("td", {}, glyph(events.type[i]), " " + classes[events.type[i]].name),
  make("td", {class: "number"}, number(events.x[i] + corner.x, 1)), make("td", {class: "number"}, number(events.y[i] + corner.y, 1)),
  make("td", {class: "number"}, number(events.p[i], 2)),
  make("td", {}, strokeNames(events.before[i])), make("td", {}, strokeNames(events.after[i])))));
  if (!rows.length) body.append(make("tr", {}, make("td", {colspan: 7, class: "empty"}, "No event passes.")));
  $("row-count").textContent = rows.length === eventCount ? plural(eventCount, "event") : `${number(rows.length)} of ${plural(eventCount, "event")}`;
  const turn = (label, to, name) => make("button", {type: "button", "aria-label": name, onclick: () => { page = to; showTable(); },
    ...(to < 0 || to >= pages || to === page ? {disabled: ""} : {})}, label);
  $("pages").replaceChildren(...(pages < 2 ? [] : [turn("\u00ab", page === 0 ? -1 : 0, "First page"), turn("\u2039", page - 1, "Previous page"),
    make("button", {type: "button", disabled: ""}, `${page + 1} of ${pages}`),
    turn("\u203a", page + 1, "Next page"), turn("\u00bb", page === pages - 1 ? -1 : pages - 1, "Last page")]));
  for (const head of document.querySelectorAll("#table th[data-key]"))
    if (head.dataset.key === sorting.key) head.setAttribute("aria-sort", sorting.up ? "ascending" : "descending");
    else head.removeAttribute("aria-sort");
}

// ---- the time line and the rate

let drawLanes = () => {};
let laneScale = null;
const laneLeft = 84;
function buildLanes() {
  drawLanes = drawing($("lanes"), (context, width, height) => {
    const frame = axes(context, width, height, [0, lastFrame], [0, 1], {lanes: true, left: laneLeft});
    const lane = (frame.bottom - frame.top) / classes.length;
    laneScale = {...frame, lane};
    classes.forEach((kind, k) => {
      const y = frame.top + lane * (k + .5);
      context.fillStyle = filter.shown[k] ? themed("ink") : themed("faint");
      context.textAlign = "right";
      context.textBaseline = "middle";
      context.fillText(kind.name, frame.left - 10, y);
      context.strokeStyle = themed("line");
      context.beginPath();
      context.moveTo(frame.left, y);
      context.lineTo(frame.right, y);
      context.stroke();
    });
    const thick = Math.max(1.5, Math.min(4, (frame.right - frame.left) / clip.frames * .6));
    // one bar for each frame and class: the more events, the higher; pale where the filter holds them back
    const bars = new Map();
    let most = 1;
    for (let i = 0; i < eventCount; ++i) {
      if (!filter.shown[events.type[i]]) continue;
      const key = events.frame[i] * classes.length + events.type[i];
      const bar = bars.get(key) ?? bars.set(key, {all: 0, passing: 0}).get(key);
      bar.all += 1;
      bar.passing += passes(i) ? 1 : 0;
      most = Math.max(most, bar.all);
    }
    for (const [key, {all, passing}] of bars) {
      const type = key % classes.length, y = frame.top + lane * (type + .5);
      const part = most === 1 ? 1 : .3 + .7 * (passing || all) / most;
      context.globalAlpha = passing ? .85 : .12;
      context.fillStyle = classes[type].colour;
      context.fillRect(frame.px((key - type) / classes.length) - thick / 2, y - lane * .4 * part, thick, lane * .8 * part);
    }
    context.globalAlpha = 1;
    if (selected < 0) return;
    const x = frame.px(events.frame[selected]);
    context.strokeStyle = themed("accent");
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(x, frame.top - 4);
    context.lineTo(x, frame.bottom);
    context.stroke();
    const y = frame.top + lane * (events.type[selected] + .5);
    context.strokeRect(x - thick / 2 - 2, y - lane * .4 - 1, thick + 4, lane * .8 + 2);
  });
}
function pickLane(pointer) {
  const box = $("lanes").getBoundingClientRect(), x = pointer.clientX - box.left, y = pointer.clientY - box.top;
  let best = -1, least = 40;
  for (const i of rows) {
    const dx = Math.abs(laneScale.px(events.frame[i]) - x);
    const dy = Math.abs(laneScale.top + laneScale.lane * (events.type[i] + .5) - y);
    const away = dx + (dy > laneScale.lane / 2 ? dy : 0);
    if (away < least) [best, least] = [i, away];
  }
  if (best >= 0) select(best);
}
function buildRates() {
  const {step: bin, events: counts} = data.series;
  // a running mean, wide enough to be a rate rather than a row of spikes
  const half = Math.max(1, Math.round(counts[0].length / 32));
  const smooth = (list) => list.map((_, i) => {
    const part = list.slice(Math.max(0, i - half), i + half + 1);
    return sum(part) / part.length;
  });
  const curves = counts.map(smooth), xs = counts[0].map((_, i) => Math.min(lastFrame, i * bin + (bin - 1) / 2));
  $("rate-unit").textContent = `per frame, mean over ${(2 * half + 1) * bin} frames`;
  filterWatchers.push(drawing($("rates"), (context, width, height) => {
    const shown = curves.filter((_, k) => filter.shown[k]);
    const top = Math.max(.05, ...shown.map((list) => Math.max(...list))) * 1.08;
    const frame = axes(context, width, height, [0, lastFrame], [0, top], {left: laneLeft});
    curves.forEach((list, k) => {
      if (filter.shown[k]) polyline(context, xs.map(frame.px), list.map(frame.py), classes[k].colour);
    });
  }));
}

// What is said where no event is probable enough to be listed.
function withoutEvents(expected, least) {
  if (!expected?.of) return "The graphs of this clip show no change.";
  const range = [expected.total - 1.645 * expected.sd, expected.total + 1.645 * expected.sd].map((v) => number(Math.max(0, Math.round(v))));
  const classes = Object.entries(expected.classes).filter(([, n]) => n >= .5).map(([name, n]) => `${name} ${number(Math.round(n))}`);
  return `No single change has a probability of ${least} or more (the likeliest has ${expected.likeliest}). Of the ${number(expected.of)} changes that the graphs show, `
    + `${range[0]} to ${range[1]} are expected to have happened (90 %${classes.length ? "; " + classes.join(", ") : ""}). events_all.json lists them, `
    + `review.html shows the doubtful ones, and analyze --least-probability lowers the limit. Shapes that the sketch leaves out have no events.`;
}

function buildEvents() {
  const totals = data.series.events.map((list, k) => summary.events?.classes?.[classes[k].name] ?? Math.round(sum(list) * data.series.step));
  $("events-lead").textContent = events.total === 0 ? withoutEvents(summary.events?.expected, summary.options?.least_probability ?? .5)
    : events.every === 1 ? "Choose one on the time line or in the table to see its place; the arrow keys walk on from there."
      : `Choose one to see its place. Of ${number(events.total)} events every ${events.every}. is listed here; events.csv has all. Counts and rates are of all.`;
  $("chips").append(...classes.map((kind, k) => make("button", {type: "button", "aria-pressed": true, onclick: (click) => {
    filter.shown[k] = !filter.shown[k];
    click.currentTarget.setAttribute("aria-pressed", filter.shown[k]);
    refilter();
  }}, glyph(k), kind.name, make("b", {}, number(totals[k])))));
  if (events.total === 0) {
    for (const node of document.querySelectorAll("#events .columns, #events .bar, #events .table-box")) node.hidden = true, node.style.display = "none";
    return;
  }
  buildLanes();
  buildRates();
  filterWatchers.push(() => drawLanes(), drawViewer);
  for (const head of document.querySelectorAll("#table th[data-key]"))
    head.firstElementChild.addEventListener("click", () => {
      const key = head.dataset.key;
      Object.assign(sorting, {key, up: sorting.key === key ? !sorting.up : true});
      refilter();
    });
  const [from, to, stroke] = [$("from"), $("to"), $("stroke")];
  from.value = 0;
  to.value = from.max = to.max = lastFrame;
  const whole = (input, otherwise) => (input.value.trim() === "" || !Number.isFinite(+input.value) ? otherwise : +input.value);
  const read = () => {
    Object.assign(filter, {from: whole(from, 0), to: whole(to, lastFrame), stroke: whole(stroke, null)});
    refilter();
  };
  for (const input of [from, to, stroke]) input.addEventListener("input", read);
  $("reset").addEventListener("click", () => {
    [from.value, to.value, stroke.value] = [0, lastFrame, ""];
    filter.shown.fill(true);
    for (const chip of $("chips").children) chip.setAttribute("aria-pressed", true);
    read();
  });
  $("event-previous").addEventListener("click", () => step(-1));
  $("event-next").addEventListener("click", () => step(1));
  for (const id of ["event-sketch", "event-others"]) $(id).addEventListener("change", drawViewer);
  $("lanes").addEventListener("click", pickLane);
  const walk = (key) => {
    const by = {ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1}[key.key];
    if (by && !["INPUT"].includes(key.target.tagName)) { key.preventDefault(); step(by); }
  };
  $("lanes").addEventListener("keydown", walk);
  $("viewer").addEventListener("keydown", walk);
  $("table").addEventListener("keydown", walk);
  refilter();
  // begin with one that shows much: a change of topology whose own frame the page carries
  const carried = new Set(data.frames.map((shown) => shown.frame));
  const late = rows.filter((i) => carried.has(events.frame[i]) && events.frame[i] > clip.frames / 4);
  select(late.find((i) => !["birth", "death"].includes(classes[events.type[i]].name)) ?? late[0] ?? rows[0]);
  drawings.push(drawViewer);
}
