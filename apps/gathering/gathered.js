const significant = (value) => value === null || value === undefined ? "\u2013" : String(+value.toPrecision(3));
const per = {frame: "frame", second: "second", "second and mm2": "second and mm\u00b2"}[data.per];
const types = Object.keys(data.groups[0].rates);
let type = "all";

function save(name, kind, text) {
  const link = make("a", {href: URL.createObjectURL(new Blob([text], {type: kind})), download: name});
  link.click();
  URL.revokeObjectURL(link.href);
}

/** Round steps that divide 0…most in about `count` parts. */
function ticks(most, count) {
  const raw = most / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999), list = [];
  for (let v = 0; v <= most * (1 + 1e-9); v += step) list.push(+v.toPrecision(6));
  return list;
}
const shortened = (text, most) => text.length > most ? "\u2026" + text.slice(text.length - most + 1) : text;

function drawPlot() {
  const rows = [];
  for (const group of data.groups) {
    rows.push({name: group.group + " (" + group.clips + ")", group: true, rate: group.rates[type]});
    for (const run of data.runs.filter((r) => r.group === group.group))
      rows.push({name: run.run, group: false, rate: run.rates[type]});
  }
  const width = Math.max(300, $("plot").clientWidth), line = 22, top = 6, bottom = top + rows.length * line;
  const left = Math.min(260, width * 0.38), right = width - 14;
  const most = Math.max(...rows.map((row) => row.rate.high ?? row.rate.mean ?? 0), 1e-12);
  const px = (v) => left + v / most * (right - left);
  const svg = makeSvg("svg", {viewBox: `0 0 ${width} ${bottom + 44}`, role: "img",
    "aria-label": "Rates of " + type + " with their 90 % intervals, by group and clip"});
  for (const v of ticks(most, Math.max(2, Math.floor((right - left) / 70))))
    svg.append(makeSvg("line", {x1: px(v), x2: px(v), y1: top, y2: bottom, class: "grid"}),
               makeSvg("text", {x: px(v), y: bottom + 18, "text-anchor": "middle"}, String(v)));
  svg.append(makeSvg("text", {x: right, y: bottom + 38, "text-anchor": "end"}, "events a " + per));
  rows.forEach((row, i) => {
    const y = top + (i + 0.5) * line, {mean, low, high} = row.rate;
    const one = makeSvg("g", {class: row.group ? "group" : "clip"});
    one.append(makeSvg("title", {}, `${row.name}: ${significant(mean)} (${significant(low)} to ${significant(high)}), ${row.rate.count} events`),
               makeSvg("text", {x: left - 10, y: y + 4, "text-anchor": "end", class: row.group ? "" : "clip-name"},
                       shortened(row.name, Math.floor(left / 8))),
               makeSvg("line", {x1: px(low ?? 0), x2: px(high ?? most), y1: y, y2: y, class: "interval"}),
               makeSvg("circle", {cx: px(mean ?? 0), cy: y, r: row.group ? 5 : 3.5, class: "point"}));
    svg.append(one);
  });
  $("plot").replaceChildren(svg);
}

function drawTests() {
  $("tests").hidden = data.tests.length === 0;
  const rows = data.tests.filter((test) => test.type === type).map((test) => make("tr", {},
    make("td", {}, test.second + " to " + test.first), make("td", {class: "number"}, significant(test.ratio)),
    make("td", {class: "number"}, significant(test.low) + " to " + (test.high === null ? "any" : significant(test.high))),
    make("td", {class: "number"}, significant(test.p)), make("td", {}, test.test)));
  $("test-table").replaceChildren(make("thead", {}, make("tr", {}, make("th", {}, "Groups"), make("th", {class: "number"}, "Ratio"),
    make("th", {class: "number"}, "90 % interval"), make("th", {class: "number"}, "p"), make("th", {}, "Test"))), make("tbody", {}, ...rows));
}

let order = {key: (run) => run.run, sign: 1};
function drawClips() {
  const columns = [["Clip", (run) => run.run], ["Group", (run) => run.group], ["Frames", (run) => run.frames],
                   ...types.map((t) => [t, (run) => run.rates[t].count])];
  const head = make("tr", {}, ...columns.map(([name, key], i) => make("th", {class: i > 1 ? "number" : ""},
    make("button", {type: "button", onclick: () => { order = {key, sign: order.name === name ? -order.sign : i > 1 ? -1 : 1, name}; drawClips(); }}, name))));
  const sorted = [...data.runs].sort((a, b) => {
    const [x, y] = [order.key(a), order.key(b)];
    return order.sign * (typeof x === "number" ? x - y : String(x).localeCompare(String(y)));
  });
  const rows = sorted.map((run) => make("tr", {},
    make("td", {}, make("a", {href: run.link}, run.run)), make("td", {}, run.group),
    ...columns.slice(2).map(([, key]) => make("td", {class: "number"}, String(key(run))))));
  $("clip-table").replaceChildren(make("thead", {}, head), make("tbody", {}, ...rows));
}

function drawWarnings() {
  const items = [...data.failed.map((text) => "failed: " + text),
                 ...data.runs.flatMap((run) => run.warnings.map((text) => run.run + ": " + text))];
  $("warnings").hidden = items.length === 0;
  $("warning-list").replaceChildren(...items.map((text) => make("li", {}, text)));
}

/** The plot as a file of its own, with the colours that are on the screen. */
function plotFile() {
  const svg = $("plot").firstElementChild.cloneNode(true), shown = $("plot").firstElementChild;
  svg.setAttribute("xmlns", "http:" + "//www.w3.org/2000/svg");
  const from = shown.querySelectorAll("text, line, circle"), to = svg.querySelectorAll("text, line, circle");
  from.forEach((node, i) => {
    const look = getComputedStyle(node);
    for (const name of ["fill", "stroke", "stroke-width", "font"]) to[i].style.setProperty(name, look.getPropertyValue(name));
  });
  return new XMLSerializer().serializeToString(svg);
}

$("rates-lead").textContent = "Events a " + per + ", with 90 % intervals. A group's interval allows for differences between its clips.";
types.unshift(types.splice(types.indexOf("all"), 1)[0]);
const buttons = types.map((name) => make("button", {type: "button", "aria-pressed": name === type, onclick: () => {
  type = name;
  buttons.forEach((button) => button.setAttribute("aria-pressed", button.textContent === type));
  drawPlot(); drawTests();
}}, name));
$("types").replaceChildren(...buttons);
$("save-plot").addEventListener("click", () => save("rates_" + type + ".svg", "image/svg+xml", plotFile()));
$("save-table").addEventListener("click", () => save("table.csv", "text/csv", data.table));
drawPlot(); drawTests(); drawClips(); drawWarnings();
let lastWidth = window.innerWidth;
window.addEventListener("resize", () => {
  if (window.innerWidth !== lastWidth) lastWidth = window.innerWidth, drawPlot();
});
