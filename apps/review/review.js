"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);
const events = data.events, others = data.others, classes = data.classes;
// What each class means at a look, and its key.
const meanings = {
  birth: ["b", "a stroke appears that was not there"],
  death: ["d", "a stroke vanishes"],
  split: ["s", "a stroke parts into two along its length or at a fork"],
  merge: ["m", "two strokes run together into one"],
  connect: ["c", "two strokes that stay where they are get joined by a piece between them"],
  disconnect: ["x", "a piece between two strokes goes, and they stay"],
};
const answers = events.map((event) => event.answer ?? null);
let order = [], at = 0, unsaved = false;
const done = [];  // what each answer replaced, for undo

const doubt = (event) => Math.abs(event.probability - .5);
function sortEvents() {
  const current = order[at];
  order = events.map((_, i) => i);
  if ($("order").value === "frame") order.sort((a, b) => events[a].frame - events[b].frame || a - b);
  else order.sort((a, b) => doubt(events[a]) - doubt(events[b]) || a - b);
  at = current === undefined ? Math.max(0, order.findIndex((i) => answers[i] === null)) : order.indexOf(current);
}

// ---- what is shown

const images = new Map();
function imageOf(i) {
  if (!images.has(i)) {
    const image = Object.assign(new Image(), {src: events[i].strip});
    images.set(i, image);
    if (images.size > 24) images.delete(images.keys().next().value);
  }
  return images.get(i);
}
function drawStrip() {
  const i = order[at], image = imageOf(i), canvas = $("strip");
  const side = canvas.clientWidth / data.cells, ratio = Math.min(3, window.devicePixelRatio || 1);
  canvas.width = Math.round(side * data.cells * ratio);
  canvas.height = Math.round(side * ratio);
  canvas.style.height = side + "px";
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  const paint = () => {
    if (i !== order[at]) return;
    context.imageSmoothingEnabled = true;
    context.drawImage(image, 0, 0, side * data.cells, side);
    context.lineWidth = 1;
    for (let k = 0; k < data.cells; ++k) {
      context.strokeStyle = "rgb(255 255 255 / .5)";
      context.strokeRect(k * side + .5, .5, side - 1, side - 1);
      if (!$("marks").checked) continue;
      // ticks that point at the place and leave it free
      context.strokeStyle = "#ffd23f";
      context.lineWidth = 1.5;
      const x = (k + .5) * side, y = side / 2, r = side * .16, far = side * .26;
      context.beginPath();
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        context.moveTo(x + dx * r, y + dy * r);
        context.lineTo(x + dx * far, y + dy * far);
      }
      context.stroke();
    }
    // between these two frames it happened
    const change = (data.cells - 1) / 2 * side;
    context.strokeStyle = "#b4451f";
    context.lineWidth = 4;
    context.beginPath();
    context.moveTo(change, 0);
    context.lineTo(change, side);
    context.stroke();
  };
  if (image.complete) paint(); else image.onload = paint;
  if (at + 1 < order.length) imageOf(order[at + 1]);
}
const kindOf = (name) => classes.find((kind) => kind.name === name);
function show() {
  const none = events.length === 0;
  for (const id of ["yes", "no", "previous", "next"]) $(id).disabled = none;
  if (none) {
    $("event-name").textContent = "There is no event to ask about.";
    $("strip").hidden = $("frames").hidden = true;
    return showProgress();
  }
  const i = order[at], event = events[i], dot = document.createElement("span");
  dot.className = "dot";
  dot.style.background = kindOf(event.type).colour;
  $("event-name").replaceChildren(dot, `${event.type} at frame ${event.frame}?`);
  $("event-facts").textContent = `${at + 1} of ${events.length}. Place (${event.x.toFixed(1)}, ${event.y.toFixed(1)}), ` +
    `probability ${event.probability.toFixed(2)}.`;
  $("meaning").textContent = `A ${event.type}: ${meanings[event.type][1]}.`;
  $("strip").setAttribute("aria-label", `Seven frames around a ${event.type} at frame ${event.frame}; it would happen between the third and the fourth`);
  $("frames").replaceChildren(...Array.from({length: data.cells}, (_, k) => {
    const item = document.createElement("li"), frame = event.frame + k - (data.cells - 1) / 2;
    item.textContent = frame >= 0 && frame < data.clip.frames ? frame : "\u2013";
    if (frame === event.frame) item.className = "at";
    return item;
  }));
  const given = answers[i];
  $("yes").setAttribute("aria-pressed", given === "yes" || given === event.type);
  $("no").setAttribute("aria-pressed", given === "no");
  for (const button of $("types").children) {
    button.hidden = button.dataset.type === event.type;
    button.setAttribute("aria-pressed", given === button.dataset.type);
  }
  $("previous").disabled = at === 0;
  $("next").disabled = at + 1 >= order.length;
  drawStrip();
  showProgress();
}
function showProgress() {
  const given = answers.filter((answer) => answer !== null);
  $("progress").value = events.length ? given.length / events.length : 0;
  $("progress-text").textContent = `${given.length} of ${events.length} answered` +
    (others.length ? `; ${others.length} more have no picture here` : "");
  const count = (test) => given.filter(test).length;
  $("tally").textContent = given.length === 0 ? "" :
    `${count((a) => a === "yes")} happened, ${count((a) => a === "no")} did not, ` +
    `${count((a) => a !== "yes" && a !== "no")} were of another class.`;
  $("undo").disabled = done.length === 0;
}

// ---- answering

function answer(given) {
  if (events.length === 0) return;
  const i = order[at];
  const value = given === events[i].type ? "yes" : given;
  done.push({event: i, before: answers[i]});
  answers[i] = value;
  unsaved = true;
  const left = order.findIndex((k, place) => place > at && answers[k] === null);
  if (left >= 0) at = left;
  else if (at + 1 < order.length) ++at;
  show();
}
function undo() {
  const last = done.pop();
  if (!last) return;
  answers[last.event] = last.before;
  at = order.indexOf(last.event);
  unsaved = true;
  show();
}
function go(by) {
  at = Math.max(0, Math.min(order.length - 1, at + by));
  show();
}

// ---- the file

/** The content of review.json: all events, those without an answer too, in order of time. */
function reviewText() {
  const list = [...events.map((event, i) => ({...event, answer: answers[i]})), ...others.map((event) => ({answer: null, ...event}))];
  list.sort((a, b) => a.frame - b.frame);
  const lines = list.map(({frame, type, x, y, probability, answer: given}) => JSON.stringify({frame, type, x, y, probability, answer: given}));
  return `{"format":"emberfold.review","version":1,"clip":${JSON.stringify(data.clip.name)},"events":[\n${lines.join(",\n")}\n]}\n`;
}
function save() {
  const url = URL.createObjectURL(new Blob([reviewText()], {type: "application/json"}));
  const link = Object.assign(document.createElement("a"), {href: url, download: "review.json"});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
  unsaved = false;
}
const keyOf = ({frame, type, x, y}) => [frame, type, x.toFixed(3), y.toFixed(3)].join();
function load(text) {
  const saved = JSON.parse(text);
  if (saved?.format !== "emberfold.review" || !Array.isArray(saved.events)) throw new Error("this is no review.json");
  const byKey = new Map(saved.events.filter((one) => one.answer).map((one) => [keyOf(one), one.answer]));
  let taken = 0;
  events.forEach((event, i) => {
    const given = byKey.get(keyOf(event));
    if (given !== undefined) { answers[i] = given; ++taken; }
  });
  done.length = 0;
  at = Math.max(0, order.findIndex((i) => answers[i] === null));
  show();
  return taken;
}

// ---- begin

for (const kind of classes) {
  const button = document.createElement("button"), key = document.createElement("kbd");
  button.type = "button";
  button.dataset.type = kind.name;
  key.textContent = meanings[kind.name][0];
  button.append(key, " " + kind.name);
  button.addEventListener("click", () => answer(kind.name));
  $("types").append(button);
}
$("yes").addEventListener("click", () => answer("yes"));
$("no").addEventListener("click", () => answer("no"));
$("previous").addEventListener("click", () => go(-1));
$("next").addEventListener("click", () => go(1));
$("undo").addEventListener("click", undo);
$("save").addEventListener("click", save);
$("order").addEventListener("change", () => { sortEvents(); show(); });
$("marks").addEventListener("change", () => events.length && drawStrip());
$("load").addEventListener("change", async () => {
  const file = $("load").files[0];
  if (!file) return;
  try {
    $("note").textContent = `${load(await file.text())} answers taken from ${file.name}.`;
  } catch (error) {
    $("note").textContent = `${file.name} was not taken: ${error.message}.`;
  }
});
const keys = {y: () => answer("yes"), n: () => answer("no"), u: undo, w: save, ArrowLeft: () => go(-1), ArrowRight: () => go(1),
  h: () => { $("marks").checked = !$("marks").checked; if (events.length) drawStrip(); }};
for (const [type, [key]] of Object.entries(meanings)) keys[key] = () => answer(type);
document.addEventListener("keydown", (pressed) => {
  if (pressed.ctrlKey || pressed.metaKey || pressed.altKey || pressed.target.tagName === "SELECT") return;
  const act = keys[pressed.key];
  if (!act) return;
  pressed.preventDefault();
  act();
});
window.addEventListener("beforeunload", (leaving) => { if (unsaved) leaving.preventDefault(); });
window.addEventListener("resize", () => events.length && drawStrip());
window.emberfold = {get answers() { return answers; }, get current() { return order[at]; }, reviewText, load};
sortEvents();
show();
