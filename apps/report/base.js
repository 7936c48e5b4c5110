/** A colour of the style sheet, which knows whether the screen is light or dark. */
const themed = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const clip = data.clip, summary = data.summary, classes = data.classes;
const corner = summary.clip?.counted_from ?? {x: 0, y: 0};  // added to positions in words and tables

const number = (value, digits = 0) =>
  value === null || value === undefined ? "\u2013"
    : value.toLocaleString("en", {minimumFractionDigits: digits, maximumFractionDigits: digits}).replace(/,/g, "\u202f");
const plural = (count, word) => number(count) + "\u00a0" + word + (count === 1 ? "" : "s");
const sum = (list) => list.reduce((a, b) => a + b, 0);

/** The outline of an event's mark of radius r about (x, y), as an SVG path. */
function markPath(type, x, y, r) {
  const h = r * 0.866, d = r * 0.8, at = (a, b) => (x + a).toFixed(2) + " " + (y + b).toFixed(2);
  switch (classes[type].name) {
    case "birth": return `M${at(0, -r)}L${at(h, r / 2)}L${at(-h, r / 2)}Z`;
    case "death": return `M${at(0, r)}L${at(h, -r / 2)}L${at(-h, -r / 2)}Z`;
    case "split": return `M${at(-r * .9, 0)}a${r * .9} ${r * .9} 0 1 0 ${r * 1.8} 0a${r * .9} ${r * .9} 0 1 0 ${-r * 1.8} 0Z`;
    case "merge": return `M${at(-d, -d)}L${at(d, -d)}L${at(d, d)}L${at(-d, d)}Z`;
    case "connect": return `M${at(-r, 0)}L${at(r, 0)}M${at(0, -r)}L${at(0, r)}`;
    default: return `M${at(-d, -d)}L${at(d, d)}M${at(-d, d)}L${at(d, -d)}`;
  }
}
function glyph(type) {
  const svg = makeSvg("svg", {viewBox: "0 0 16 16", class: "glyph", "aria-hidden": "true"});
  const r = ["birth", "death"].includes(classes[type].name) ? 7 : 6;
  svg.append(makeSvg("path", {d: markPath(type, 8, 8, r), fill: "none", stroke: classes[type].colour, "stroke-width": 2}));
  return svg;
}

/** Buttons of which one is pressed; calls chosen(index). */
function choice(box, labels, chosen, start = 0) {
  const buttons = labels.map((label, i) =>
    make("button", {type: "button", "aria-pressed": i === start, onclick: () => pick(i)}, label));
  function pick(i) {
    buttons.forEach((button, k) => button.setAttribute("aria-pressed", k === i));
    chosen(i);
  }
  box.replaceChildren(...buttons);
}

const drawings = [];
/** Keeps a canvas drawn at the screen's resolution: draw(context, width, height), again whenever its size changes. */
function drawing(canvas, draw, aspect = null) {
  const again = () => {
    const width = canvas.clientWidth;
    if (width === 0) return;
    if (aspect) canvas.style.height = Math.round(width * aspect) + "px";
    const height = canvas.clientHeight, ratio = Math.min(3, window.devicePixelRatio || 1);
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    draw(context, width, height);
  };
  drawings.push(again);
  again();
  return again;
}
let lastWidth = window.innerWidth;
window.addEventListener("resize", () => {
  if (window.innerWidth === lastWidth) return;  // a phone's address bar changes the height alone
  lastWidth = window.innerWidth;
  drawings.forEach((again) => again());
});
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => drawings.forEach((again) => again()));
window.addEventListener("beforeprint", () => drawings.forEach((again) => again()));

/** Round steps that divide a range in about `count` parts. */
function ticks(from, to, count, whole = false) {
  const low = Math.min(from, to), high = Math.max(from, to);
  const span = Math.max(high - low, 1e-9), raw = span / Math.max(count, 1), power = 10 ** Math.floor(Math.log10(raw));
  let step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999);
  if (whole) step = Math.max(1, Math.round(step));
  const list = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + step * 1e-6; v += step) list.push(+v.toFixed(9));
  return list;
}
const font = "12px system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif";

/** The axes of a plot: returns where things lie. `x`, `y`: [low, high]. */
function axes(context, width, height, x, y, options = {}) {
  const left = options.left ?? 40, right = width - (options.right ?? 12), top = 8, bottom = height - 34;
  const share = (v, [from, to]) => (v - from) / (to - from || 1);
  const px = (v) => left + share(v, x) * (right - left), py = (v) => bottom - share(v, y) * (bottom - top);
  context.font = font;
  context.fillStyle = themed("soft");
  context.strokeStyle = themed("line");
  context.lineWidth = 1;
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const v of ticks(x[0], x[1], (right - left) / 64, true)) {
    context.beginPath();
    context.moveTo(px(v), top);
    context.lineTo(px(v), bottom);
    context.stroke();
    context.fillText(number(v), px(v), bottom + 5);
  }
  context.textAlign = "right";
  context.fillText(options.xName ?? "frame", right, bottom + 19);
  if (!options.lanes) {
    context.textBaseline = "middle";
    for (const v of ticks(y[0], y[1], (bottom - top) / 36)) {
      context.beginPath();
      context.moveTo(left, py(v));
      context.lineTo(right, py(v));
      context.stroke();
      context.fillStyle = options.yColour ?? themed("soft");
      context.fillText(number(v, v % 1 ? (Math.abs(v) < .1 ? 2 : 1) : 0), left - 6, py(v));
    }
  }
  return {px, py, left, right, top, bottom};
}
function polyline(context, xs, ys, colour, lineWidth = 1.6) {
  context.beginPath();
  xs.forEach((x, i) => (i ? context.lineTo(x, ys[i]) : context.moveTo(x, ys[i])));
  context.strokeStyle = colour;
  context.lineWidth = lineWidth;
  context.lineJoin = "round";
  context.stroke();
}
const lastFrame = Math.max(1, clip.frames - 1);
const backdropSource = data.stills.length ? data.stills[Math.floor(data.stills.length / 2)].uri : null;
const backdrop = backdropSource ? Object.assign(new Image(), {src: backdropSource}) : null;
/** The frame, pale, as the ground of maps. */
function drawBackdrop(context, width, height, veil) {
  context.fillStyle = "#eef0f3";
  context.fillRect(0, 0, width, height);
  if (!backdrop || !backdrop.complete || !backdrop.naturalWidth) return;
  context.imageSmoothingEnabled = clip.width > 16;
  context.drawImage(backdrop, 0, 0, width, height);
  context.fillStyle = veil;
  context.fillRect(0, 0, width, height);
}
