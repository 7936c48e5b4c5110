// ---- new clips, playing in step: they lie side by side in one video, so that they cannot part

function buildClips() {
  const shown = data.clips;
  if (!shown && !data.measures) return;
  $("clips").hidden = false;
  $("clips-lead").textContent = shown
    ? `${plural(shown.frames, "frame")} of each, in step and over again; the models were learned from the first alone.`
    : "How close the new clips come to the one that the models were learned from.";
  if (shown) buildPlayer(shown);
  else for (const node of document.querySelectorAll("#clips .bar")) node.hidden = true, node.style.display = "none";
  if (data.measures) buildMeasures(data.measures);
}

function buildPlayer(shown) {
  const video = $("strip"), number = shown.names.length, slider = $("strip-frame"), play = $("strip-play");
  const bytes = Uint8Array.from(atob(shown.mp4), (c) => c.charCodeAt(0));
  video.src = URL.createObjectURL(new Blob([bytes], {type: "video/mp4"}));
  const screens = shown.names.map((name) => {
    const canvas = make("canvas", {width: shown.width, height: shown.height, role: "img", "aria-label": name});
    $("screens").append(make("figure", {}, canvas, make("figcaption", {}, name)));
    return canvas.getContext("2d");
  });
  slider.max = shown.frames - 1;
  const show = () => {
    if (video.readyState < 2) return;
    const width = video.videoWidth / number, height = video.videoHeight;
    screens.forEach((screen, i) => screen.drawImage(video, i * width, 0, width, height, 0, 0, shown.width, shown.height));
    const frame = Math.min(shown.frames - 1, Math.floor(video.currentTime * shown.fps + .01));
    slider.value = frame;
    $("strip-number").textContent = frame;
  };
  const follow = () => {
    show();
    if (!video.paused) again();
  };
  const again = () => (video.requestVideoFrameCallback ? video.requestVideoFrameCallback(follow) : requestAnimationFrame(follow));
  const stopped = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  let wanted = !stopped;
  video.addEventListener("play", () => { play.textContent = "Pause"; again(); });
  video.addEventListener("pause", () => { play.textContent = "Play"; });
  for (const moment of ["loadeddata", "seeked"]) video.addEventListener(moment, show);
  video.addEventListener("error", () => {
    $("clips-lead").textContent = "This browser cannot play the clips that the page carries (H.264); they lie beside it as files.";
  });
  play.addEventListener("click", () => {
    wanted = video.paused;
    if (wanted) video.play().catch(() => {}); else video.pause();
  });
  slider.addEventListener("input", () => {
    wanted = false;
    video.pause();
    video.currentTime = (+slider.value + .5) / shown.fps;
  });
  const speeds = [.25, .5, 1, 2];
  choice($("strip-speed"), ["\u00bc\u00d7", "\u00bd\u00d7", "1\u00d7", "2\u00d7"], (i) => { video.playbackRate = speeds[i]; }, 2);
  // plays while it is in sight
  new IntersectionObserver((seen) => {
    if (!seen[0].isIntersecting) video.pause();
    else if (wanted) video.play().catch(() => {});
  }, {threshold: .1}).observe($("screens"));
}

function buildMeasures(measures) {
  const head = make("tr", {}, make("th", {scope: "col"}, "Measure"),
    ...measures.columns.map((name) => make("th", {scope: "col", class: "number"}, name)));
  const lines = measures.rows.map((row) => make("tr", {}, make("th", {scope: "row", class: "measure"}, row.name,
    ...(row.about ? [make("span", {class: "below"}, row.about)] : [])),
  ...row.values.map((value) => make("td", {class: "number"}, value === null ? "\u2013" : figure(value)))));
  $("measures").append(make("div", {class: "table-box"}, make("table", {}, make("thead", {}, head), make("tbody", {}, ...lines))));
  if (measures.note) $("measures").append(make("p", {class: "caption"}, measures.note));
}

/** A power's digits. */
const raised = (power) => String(power).replace("-", "\u207b").replace(/\d/g, (d) => "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[d]);
/** A number in three or four digits. */
function figure(value) {
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size < 1e-3 || size >= 1e6) {
    const [mantissa, power] = value.toExponential(1).split("e");
    return `${mantissa}\u00b710${raised(+power)}`;
  }
  return number(value, size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= .01 ? 3 : 4);
}

// ---- what the models hold

function buildLearned() {
  const learned = data.learned;
  if (!learned) return;
  $("learned").hidden = false;
  const m = learned.motion;
  $("learned-lead").textContent = (m ? `Motion model: every patch of a stroke sways about its rest place by a second-order auto-regression, tied to its neighbours; strokes change at the rates counted in this clip, and new ones take the shape of one of ${plural(m.exemplars_total, "stroke")} seen in it. ` : "")
    + (learned.eigenvalues ? `Linear dynamic texture: ${plural(learned.eigenvalues.length, "component")}, frames as points that a linear system drives.` : "");
  if (m) {
    buildMotionTable(m);
    buildOperators(m);
    heatMap("birth", m.birth, 1e4, false);
    $("birth-caption").textContent = "Births per frame and 100\u00d7100 px; dots are those found";
    heatMap("death", m.death, 1, true);
    $("death-caption").textContent = "Deaths, times what is usual for a stroke's size; dots are those found";
    driftMap($("drift-map"), m.drift);
    $("drift-caption").textContent = `Drift of the rest shapes: the longest arrow is ${figure(m.drift.most)} px a frame`;
    buildExemplars(m);
  } else {
    for (const id of ["birth-map", "death-map", "drift-map"]) $(id).parentElement.hidden = true;
  }
  buildCircle(learned);
}

function tableBox(caption, head, lines) {
  const table = plainTable(caption, head, lines);
  for (const row of table.querySelectorAll("tr")) [...row.cells].forEach((cell, i) => { cell.className = i ? "number" : ""; });
  table.caption.style.padding = "8px 12px";
  table.style.margin = "0";
  return make("div", {class: "table-box tight-table"}, table);
}

function buildMotionTable(m) {
  const line = (name, of) => [[name, (v) => of(v)]];
  const rows = [
    ...line("weight of the frame before, a\u2081", (v) => number(v.a1, 3)),
    ...line("weight of the one before that, a\u2082", (v) => number(v.a2, 3)),
    ...line("pull of the neighbours", (v) => number(v.coupling, 3)),
    ...line("noise, SD a frame", (v) => figure(v.noise)),
    ...line("its reach along the curve, px", (v) => figure(v.range)),
    ...line("SD in the long run", (v) => (v.deviation === null ? "\u2013" : figure(v.deviation))),
    ...line("added by the sketch alone, SD", (v) => figure(v.measurement)),
    ...line("spectral radius", (v) => number(v.radius, 3)),
  ];
  $("motion-table").append(tableBox("How patches move", ["", "place, px", "log contrast"],
    rows.map(([name, of]) => [name, of(m.sway), of(m.contrast)])));
}

function buildOperators(m) {
  $("rate-table").append(tableBox("How often strokes change", ["", "seen", "rate a frame"],
    m.rates.map((r) => [make("span", {}, r.name, " ", make("span", {class: "below"}, r.per)), r.seen === null ? "" : number(r.seen), figure(r.rate)])));
}

const most = (list) => list.reduce((a, b) => Math.max(a, b), 0);
/** A map of rates, smooth between the cells' middles, with the events of its class as dots and its scale below: from 0, or ratios on both sides of 1. */
function heatMap(name, map, factor, relative) {
  const canvas = $(name + "-map"), shape = clip.height / clip.width, bar = 30;
  const top = relative ? Math.max(1.5, most(map.values), ...map.values.filter((v) => v > 0).map((v) => 1 / v)) : most(map.values);
  const shareOf = (v) => (relative ? Math.max(-1, Math.min(1, Math.log(Math.max(v, 1e-9)) / Math.log(top))) : top > 0 ? v / top : 0);
  const valueAt = (place) => (relative ? top ** (2 * place - 1) : top * place);
  const colour = (share) => (share < 0 ? [30, 90, 190] : [200, 70, 20]);
  const type = classes.findIndex((kind) => kind.name === name), strength = (share) => .82 * Math.abs(share) ** .7;
  const small = make("canvas", {width: map.columns, height: map.rows}), pixels = new ImageData(map.columns, map.rows);
  map.values.forEach((value, i) => pixels.data.set([...colour(shareOf(value)), 255 * strength(shareOf(value))], 4 * i));
  small.getContext("2d").putImageData(pixels, 0, 0);
  const draw = drawing(canvas, (context, width, whole) => {
    const height = whole - bar, scale = width / clip.width;
    drawBackdrop(context, width, height, "rgba(255,255,255,.72)");
    context.save();
    context.beginPath();
    context.rect(0, 0, width, height);
    context.clip();
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = "high";
    context.drawImage(small, 0, 0, map.columns * map.cell * scale, map.rows * map.cell * height / clip.height);
    const own = [];
    for (let i = 0; i < eventCount; ++i) if (events.type[i] === type) own.push(i);
    context.globalAlpha = Math.max(.25, Math.min(.9, 150 / own.length));
    for (const i of own) {
      context.beginPath();
      context.arc((events.x[i] + .5) * scale, (events.y[i] + .5) * height / clip.height, own.length > 400 ? 1.2 : 1.8, 0, 7);
      context.fillStyle = themed("ink");
      context.fill();
    }
    context.restore();
    const right = width * .98;
    for (let x = 0; x < right; ++x) {
      const share = shareOf(valueAt(x / right));
      context.fillStyle = `rgba(${colour(share).join(",")},${strength(share).toFixed(3)})`;
      context.fillRect(x, height + 5, 1, 8);
    }
    context.font = font;
    context.fillStyle = themed("soft");
    context.textBaseline = "top";
    [["left", 0], ["center", .5], ["right", 1]].forEach(([align, share]) => {
      context.textAlign = align;
      context.fillText(figure(factor * valueAt(share)), share * right, height + 16);
    });
  }, Math.min(1.6, shape) + .12);
  if (backdrop) backdrop.decode().then(draw, () => {});
}

function driftMap(canvas, map) {
  const draw = drawing(canvas, (context, width, height) => {
    drawBackdrop(context, width, height, "rgba(255,255,255,.72)");
    const scale = width / clip.width, every = Math.max(1, Math.ceil(map.columns / 14));
    const longest = every * map.cell * scale * .9;
    context.strokeStyle = context.fillStyle = themed("accent");
    context.lineWidth = 1.4;
    for (let row = Math.floor(every / 2); row < map.rows; row += every)
      for (let column = Math.floor(every / 2); column < map.columns; column += every) {
        const i = row * map.columns + column, x = (column + .5) * map.cell * scale, y = (row + .5) * map.cell * scale;
        const unit = map.most > 0 ? longest / map.most : 0, dx = map.x[i] * unit, dy = map.y[i] * unit;
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo(x + dx, y + dy);
        context.stroke();
        context.beginPath();
        context.arc(x, y, 1.5, 0, 7);
        context.fill();
      }
  }, Math.min(1.6, clip.height / clip.width));
  if (backdrop) backdrop.decode().then(draw, () => {});
}

const kindColours = {ridge: "#ffb35c", valley: "#62b5ff", step: "#9be08a"};
function buildExemplars(m) {
  if (!m.exemplars.length) return;
  $("exemplars-title").textContent = m.exemplars.length < m.exemplars_total
    ? `Strokes to be born again: ${m.exemplars.length} of ${number(m.exemplars_total)}` : `Strokes to be born again: ${number(m.exemplars_total)}`;
  for (const exemplar of m.exemplars) {
    const all = exemplar.curves.flatMap((curve) => curve.slice(1)), xs = all.filter((_, i) => i % 2 === 0), ys = all.filter((_, i) => i % 2);
    const side = Math.max(16, Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys)) * 1.25;
    const cx = (Math.max(...xs) + Math.min(...xs)) / 2, cy = (Math.max(...ys) + Math.min(...ys)) / 2;
    const svg = makeSvg("svg", {viewBox: `${cx - side / 2} ${cy - side / 2} ${side} ${side}`, role: "img"});
    svg.append(makeSvg("title"));
    svg.firstChild.textContent = `${plural(exemplar.patches, "patch").replace("patchs", "patches")}, seen at (${exemplar.x}, ${exemplar.y})`;
    for (const curve of exemplar.curves) {
      let d = "";
      for (let k = 1; k + 1 < curve.length; k += 2) d += (k === 1 ? "M" : "L") + curve[k] + " " + curve[k + 1];
      svg.append(makeSvg("path", {d, fill: "none", stroke: kindColours[curve[0]] ?? "#fff", "stroke-width": side / 36, "stroke-linecap": "round", "stroke-linejoin": "round"}));
      for (let k = 1; k + 1 < curve.length; k += 2)
        svg.append(makeSvg("circle", {cx: curve[k], cy: curve[k + 1], r: side / 42, fill: "#15171c", stroke: kindColours[curve[0]] ?? "#fff", "stroke-width": side / 90}));
    }
    $("exemplars").append(svg);
  }
}

function buildCircle(learned) {
  const texture = learned.eigenvalues ?? [], own = learned.motion?.poles ?? [];
  if (!texture.length && !own.length) { $("circle-figure").hidden = true; return; }
  drawing($("circle"), (context, width, height) => {
    const r = Math.min(width, height) / 2 - 14, x0 = width / 2, y0 = height / 2;
    context.strokeStyle = themed("line");
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(x0 - r - 8, y0);
    context.lineTo(x0 + r + 8, y0);
    context.moveTo(x0, y0 - r - 8);
    context.lineTo(x0, y0 + r + 8);
    context.stroke();
    context.strokeStyle = themed("faint");
    context.beginPath();
    context.arc(x0, y0, r, 0, 2 * Math.PI);
    context.stroke();
    context.fillStyle = "rgba(0,104,190,.7)";
    for (const [re, im] of texture) {
      context.beginPath();
      context.arc(x0 + re * r, y0 - im * r, 3, 0, 7);
      context.fill();
    }
    context.lineWidth = 2;
    for (const {of, re, im} of own) {
      context.strokeStyle = of === "sway" ? themed("accent") : "#3d8b37";
      const x = x0 + re * r, y = y0 - im * r;
      context.beginPath();
      context.moveTo(x - 5, y - 5);
      context.lineTo(x + 5, y + 5);
      context.moveTo(x - 5, y + 5);
      context.lineTo(x + 5, y - 5);
      context.stroke();
    }
  }, Math.min(1, Math.max(.62, clip.height / clip.width)));
  const parts = [];
  if (own.length) parts.push("crosses: a patch's place (red) and contrast (green)");
  if (texture.length) parts.push(`dots: the linear dynamic texture, radius ${number(learned.texture_radius, 3)}`);
  $("circle-caption").textContent = `Poles in the unit circle; ${parts.join(", ")}`;
}
