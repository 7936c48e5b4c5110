const entries = (object) => Object.entries(object ?? {});
function plainTable(caption, head, lines) {
  return make("table", {class: "plain-table"}, make("caption", {}, caption),
    ...(head ? [make("thead", {}, make("tr", {}, ...head.map((text) => make("th", {scope: "col"}, text))))] : []),
    make("tbody", {}, ...lines.map((line) => make("tr", {}, ...line.map((text, i) => make("td", i ? {class: "wide"} : {}, text))))));
}

function buildHead() {
  $("meta").textContent = `${clip.width} \u00d7 ${clip.height} px \u00b7 ${plural(clip.frames, "frame")} \u00b7 ${number(clip.fps, clip.fps % 1 ? 2 : 0)} frames a second${summary.clip?.fps_is_known === false ? " (taken, not known)" : ""} \u00b7 ${number(clip.frames / clip.fps, 1)} s${summary.clip?.pixel_um ? ` \u00b7 ${number(summary.clip.pixel_um, 4)} \u00b5m a pixel` : ""}${summary.clip?.counted_from ? ` \u00b7 positions count from the ${corner.origin}` : ""}`;
  for (const warning of summary.warnings ?? []) $("warnings").append(make("p", {class: "note"}, warning));
  const tiles = [], figures = summary.sketch ?? {}, count = data.events.total;
  const tile = (name, value, unit, below) => tiles.push(make("div", {}, make("dt", {}, name),
    make("dd", {}, value, ...(unit ? [make("small", {}, "\u2009" + unit)] : [])), ...(below ? [make("dd", {class: "sub"}, below)] : [])));
  const told = summary.events?.sure === undefined ? `${number(count / Math.max(1, clip.frames - 1), 2)} a frame`
    : `${number(summary.events.sure)} sure, ${number(summary.events.likely)} likely; ${number(summary.events.doubtful)} doubtful ones are left out`;
  tile("Events", number(count), "", told);
  const rates = summary.rates?.classes?.all;
  const range = (rate) => `${number(rate.low, 3)} to ${number(rate.high, 3)}, 90 %`;
  if (rates?.a_second) tile("Events", number(rates.a_second.mean, 3), "a second", range(rates.a_second));
  if (rates?.a_second_and_mm2) tile("Events", number(rates.a_second_and_mm2.mean, 3), "a second and mm\u00b2", range(rates.a_second_and_mm2));
  const life = summary.strokes?.life;
  if (life) tile("Life of a stroke", number(life.median_s ?? life.median, 2), life.median_s == null ? "frames" : "s", `${number(life.low_s ?? life.low, 2)} to ${number(life.high_s ?? life.high, 2)}, 90 % of them`);
  tile("Strokes", number(figures.strokes_per_frame, 1), "a frame", `${number(summary.motion?.strokes)} in all`);
  tile("Patches", number(figures.patches_per_frame, 0), "a frame", `${number(figures.patches)} in all`);
  tile("Sketchable", number((figures.sketchable_share ?? 0) * 100, 1), "%", "of the frame, under patches");
  tile("Reconstruction", number(figures.psnr?.mean, 1), "dB", figures.psnr ? `PSNR, ${number(figures.psnr.min, 1)} to ${number(figures.psnr.max, 1)}` : "");
  if (summary.score) tile("F1, four classes", number(summary.score.four.all.f1, 3), "", "against the truth");
  if (summary.seconds) tile("Time", number(summary.seconds.total, summary.seconds.total < 10 ? 1 : 0), "s", `${number(summary.peak_memory_mb)} MB at most`);
  $("tiles").append(...tiles);
}

function buildStills() {
  if (!data.stills.length) { $("sketches").hidden = true; return; }
  let current = 0, mode = 0;
  const trio = ["Input", "Sketch", "Reconstruction"].map((name) => {
    const image = make("img", {alt: ""});
    $("trio").append(make("figure", {}, image, make("figcaption", {}, name)));
    return image;
  });
  const slide = () => {
    const share = $("wipe-slider").value;
    $("wipe-over").style.clipPath = `inset(0 ${100 - share}% 0 0)`;
    $("wipe-edge").style.left = share + "%";
  };
  const show = () => {
    const still = data.stills[current];
    [still.uri, still.sketch, still.reconstruction].forEach((uri, i) => {
      trio[i].src = uri;
      trio[i].alt = `${["Input", "Sketch", "Reconstruction"][i]}, frame ${still.frame}`;
      trio[i].style.aspectRatio = `${clip.width} / ${clip.height}`;
      if (clip.width < 64) trio[i].style.imageRendering = "pixelated";
    });
    $("trio").hidden = mode !== 0;
    $("wipe").hidden = mode === 0;
    $("wipe-over").src = still.uri;
    $("wipe-under").src = mode === 1 ? still.sketch : still.reconstruction;
    $("wipe-under").style.aspectRatio = `${clip.width} / ${clip.height}`;
    $("wipe").style.maxWidth = Math.round(Math.min(760, 560 * clip.width / clip.height)) + "px";
    $("wipe-name").textContent = mode === 1 ? "Sketch" : "Reconstruction";
    $("still-caption").textContent = `Frame ${still.frame}: ${number(still.share * 100, 1)} % of the pixels lie under patches; the reconstruction is at ${number(still.psnr, 1)} dB PSNR.`;
    slide();
  };
  choice($("still-frames"), data.stills.map((still) => String(still.frame)), (i) => { current = i; show(); }, 0);
  choice($("still-modes"), ["Side by side", "Input | sketch", "Input | reconstruction"], (i) => { mode = i; show(); });
  $("wipe-slider").addEventListener("input", slide);
  const middle = Math.floor(data.stills.length / 2);
  $("still-frames").children[middle].click();
}

function buildPlaces() {
  if (data.events.total === 0) { $("places").hidden = true; return; }
  let density = rows.length > 1500;
  const shape = clip.height / clip.width;
  const shown = () => rows;
  const dots = (context, list, x, y, r) => {
    if (list.length > 2500) {  // marks would hide one another
      context.globalAlpha = Math.max(.12, Math.min(.7, 2500 / list.length));
      for (const i of list) {
        context.fillStyle = classes[events.type[i]].colour;
        context.fillRect(x(i) - 1.2, y(i) - 1.2, 2.4, 2.4);
      }
      context.globalAlpha = 1;
      return;
    }
    for (const i of list) {
      context.globalAlpha = i === selected ? 1 : .75;
      const path = new Path2D(markPath(events.type[i], x(i), y(i), r));
      context.lineWidth = 3;
      context.strokeStyle = "rgba(255,255,255,.8)";
      context.stroke(path);
      context.lineWidth = 1.6;
      context.strokeStyle = classes[events.type[i]].colour;
      context.stroke(path);
    }
    context.globalAlpha = 1;
  };
  const glow = (context, list, width, height) => {
    // a Gaussian for each event, summed on a coarse grid
    const columns = 80, lines = Math.max(1, Math.round(columns * Math.min(shape, 4))), grid = new Float32Array(columns * lines);
    const spread = 2.4, reach = 7;
    for (const i of list) {
      const cx = (events.x[i] + .5) / clip.width * columns, cy = (events.y[i] + .5) / clip.height * lines;
      for (let y = Math.max(0, Math.floor(cy - reach)); y <= Math.min(lines - 1, cy + reach); ++y)
        for (let x = Math.max(0, Math.floor(cx - reach)); x <= Math.min(columns - 1, cx + reach); ++x)
          grid[y * columns + x] += Math.exp(-((x + .5 - cx) ** 2 + (y + .5 - cy) ** 2) / (2 * spread * spread));
    }
    const most = Math.max(1e-6, ...grid), picture = new ImageData(columns, lines);
    grid.forEach((value, i) => {
      const share = value / most;
      picture.data.set([200 - 90 * share, 80 - 50 * share, 20 + 40 * share, 235 * Math.sqrt(share)], i * 4);
    });
    const small = make("canvas", {width: columns, height: lines});
    small.getContext("2d").putImageData(picture, 0, 0);
    context.drawImage(small, 0, 0, width, height);
  };
  const map = drawing($("map"), (context, width, height) => {
    drawBackdrop(context, width, height, "rgba(255,255,255,.62)");
    const list = shown(), scale = width / clip.width;
    if (density) glow(context, list, width, height);
    else dots(context, list, (i) => (events.x[i] + .5) * scale, (i) => (events.y[i] + .5) * scale, list.length > 600 ? 3.5 : 5.5);
  }, shape);
  const wide = clip.width >= clip.height, place = wide ? events.x : events.y;
  $("course-caption").textContent = `Through time: frame across, ${wide ? "x" : "y"} down, in pixels`;
  const course = drawing($("course"), (context, width, height) => {
    const frame = axes(context, width, height, [0, lastFrame], [(wide ? clip.width : clip.height), 0], {left: 44});
    const list = shown();
    dots(context, list, (i) => frame.px(events.frame[i]), (i) => frame.py(place[i]), list.length > 600 ? 3 : 4.5);
  }, Math.min(1, Math.max(.6, shape)));
  choice($("map-modes"), ["Marks", "Density"], (i) => { density = i === 1; map(); }, density ? 1 : 0);
  filterWatchers.push(map, course);
  if (backdrop) backdrop.decode().then(map, () => {});
}

/** Early is deep blue, late is warm yellow. */
function timeColour(share) {
  const stops = [[38, 60, 140], [30, 130, 150], [80, 175, 90], [225, 165, 30], [205, 70, 30]];
  const at = Math.min(.9999, Math.max(0, share)) * (stops.length - 1), k = Math.floor(at), f = at - k;
  return `rgb(${stops[k].map((v, c) => Math.round(v + (stops[k + 1][c] - v) * f)).join(",")})`;
}
function buildPaths() {
  if (!data.strokes.length && !data.patches.length) { $("trajectories").hidden = true; return; }
  if (data.space_time)
    $("space-time").append(make("figure", {}, make("img", {src: data.space_time.uri, width: data.space_time.width, height: data.space_time.height, loading: "lazy", alt: "Strokes in space and time, with their events"}),
      make("figcaption", {}, "Left: strokes that last and move, x in depth, y down, time to the right. Right: the middles of strokes against time. One colour a stroke.")));
  const sets = [data.patches, data.strokes], names = ["patch", "stroke"];
  let which = data.patches.length ? 0 : 1;
  const least = $("path-least"), lengthOf = (path) => (path.length - 1) / 2, shape = clip.height / clip.width;
  $("paths-lead").textContent = "Those that go farthest and those that live longest, coloured by time. A patch is followed as long as it goes on one to one; of a stroke the middle is drawn.";
  const draw = drawing($("paths"), (context, width, height) => {
    const base = height - 34, scale = Math.min(width / clip.width, base / clip.height), left = (width - clip.width * scale) / 2;
    context.save();
    context.translate(left, 0);
    drawBackdrop(context, clip.width * scale, clip.height * scale, "rgba(255,255,255,.72)");
    context.lineCap = "round";
    for (const path of sets[which]) {
      if (lengthOf(path) < +least.value) continue;
      for (let k = 1; k + 3 < path.length; k += 2) {
        const mid = path[0] + (k - 1) / 2 + .5;
        context.beginPath();
        context.moveTo((path[k] + .5) * scale, (path[k + 1] + .5) * scale);
        context.lineTo((path[k + 2] + .5) * scale, (path[k + 3] + .5) * scale);
        context.strokeStyle = timeColour(mid / lastFrame);
        context.lineWidth = 1.8;
        context.stroke();
      }
      context.beginPath();
      context.arc((path[1] + .5) * scale, (path[2] + .5) * scale, 2, 0, 7);
      context.fillStyle = timeColour(path[0] / lastFrame);
      context.fill();
    }
    context.restore();
    const bar = Math.min(360, width - 120), x0 = (width - bar) / 2;
    for (let i = 0; i < bar; ++i) {
      context.fillStyle = timeColour(i / bar);
      context.fillRect(x0 + i, height - 20, 1.5, 9);
    }
    context.font = font;
    context.fillStyle = themed("soft");
    context.textBaseline = "middle";
    context.textAlign = "right";
    context.fillText("frame 0", x0 - 8, height - 15);
    context.textAlign = "left";
    context.fillText(String(clip.frames - 1), x0 + bar + 8, height - 15);
  }, Math.min(shape, .75) + .03);
  const refresh = () => {
    const list = sets[which], longest = list.reduce((most, path) => Math.max(most, lengthOf(path)), 3);
    least.max = longest;
    $("path-least-value").textContent = least.value;
    $("path-count").textContent = plural(list.filter((path) => lengthOf(path) >= +least.value).length, names[which] + " path");
    draw();
  };
  least.addEventListener("input", refresh);
  choice($("path-modes"), ["Patches", "Strokes"], (i) => { which = i; least.value = 3; refresh(); }, which);
  refresh();
  if (backdrop) backdrop.decode().then(draw, () => {});
}

function buildSeries() {
  const {step: bin, strokes, patches} = data.series, xs = strokes.map((_, i) => Math.min(lastFrame, i * bin + (bin - 1) / 2));
  drawing($("series"), (context, width, height) => {
    const left = 44, right = 48, topOf = (list) => Math.max(1, ...list) * 1.12;
    const a = axes(context, width, height, [0, lastFrame], [0, topOf(patches)], {left, right, yColour: themed("blue")});
    const most = topOf(strokes), py = (v) => a.bottom - v / most * (a.bottom - a.top);
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.fillStyle = themed("accent");
    for (const v of ticks(0, most, (a.bottom - a.top) / 36, true)) context.fillText(number(v), a.right + 7, py(v));
    polyline(context, xs.map(a.px), patches.map(a.py), themed("blue"));
    polyline(context, xs.map(a.px), strokes.map(py), themed("accent"));
    context.textBaseline = "top";
    context.fillStyle = themed("blue");
    context.fillText("patches (left)", a.left + 4, a.bottom + 19);
    context.fillStyle = themed("accent");
    context.fillText("strokes (right)", a.left + 100, a.bottom + 19);
  });
}

function buildMatches() {
  if (!data.matches.length) { $("matching").hidden = true; return; }
  $("matches").append(...data.matches.map((match) => {
    const tally = classes.map((kind, k) => [kind.name, events.frame.filter((f, i) => f === match.frame && events.type[i] === k).length]);
    const words = tally.filter(([, count]) => count).map(([name, count]) => plural(count, name));
    return make("figure", {}, make("img", {src: match.uri, width: match.width, height: match.height, loading: "lazy", alt: `Frames ${match.frame - 1} and ${match.frame}, matched`}),
      make("figcaption", {}, `Frames ${match.frame - 1} and ${match.frame}` + (words.length ? ": " + words.join(", ") : "")));
  }));
}

function buildScore() {
  const score = summary.score;
  if (!score) return;
  $("scores").hidden = false;
  $("score-lead").textContent = `A found event counts when a true one of its class lies within ${number(score.tolerance.frames)} frames and ${number(score.tolerance.radius)} px of it; they pair one to one.`;
  for (const [reading, name] of [["four", "Four classes"], ["six", "Six classes"]])
    $("score-tables").append(make("div", {class: "table-box"}, plainTable(name, ["", "true", "found", "hit", "precision", "recall", "F1"],
      entries(score[reading]).map(([kind, s]) => [kind, number(s.true), number(s.found), number(s.hit), number(s.precision, 3), number(s.recall, 3), number(s.f1, 3)]))));
  for (const table of document.querySelectorAll("#score-tables table")) {
    table.style.margin = "0";
    table.caption.style.padding = "8px 12px";
    for (const cell of table.querySelectorAll("tr > :not(:first-child)")) cell.className = "number";
  }
}

function buildMaking() {
  $("command").textContent = data.command;
  $("copy").addEventListener("click", async (click) => {
    const button = click.currentTarget;
    try {
      await navigator.clipboard.writeText(data.command);
    } catch {  // opened from a file there may be no clipboard
      getSelection().selectAllChildren($("command"));
      document.execCommand("copy");
    }
    button.textContent = "Copied";
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  });
  const text = (value) => (typeof value === "boolean" ? (value ? "yes" : "no") : value === null ? "\u2013" : String(value));
  const lines = [];
  for (const [group, fields] of entries(summary.options))
    for (const [name, value] of entries(fields)) lines.push([`${group}: ${name.replace(/_/g, " ")}`, text(value)]);
  lines.push(["seed", text(summary.seed)]);
  const stages = entries(summary.seconds).map(([name, seconds]) => [name.replace(/_/g, " "), number(seconds, 2)]);
  $("making-tables").append(make("div", {}, plainTable("Options", null, lines)),
    make("div", {}, plainTable("Seconds by stage", null, stages),
      plainTable("Written beside this page", null, entries(summary.files))));
  $("foot").textContent = `emberfold ${data.version}. This page is one file and asks for nothing from the network.`;
}

function buildContents() {
  for (const section of document.querySelectorAll("section[data-title]"))
    if (!section.hidden) $("contents").append(make("a", {href: "#" + section.id}, section.dataset.title));
}

buildHead();
buildStills();
buildEvents();
buildSampler();
buildPlaces();
buildPaths();
buildClips();
buildLearned();
buildSeries();
buildNetwork();
buildReview();
buildMatches();
buildScore();
buildMaking();
buildContents();
