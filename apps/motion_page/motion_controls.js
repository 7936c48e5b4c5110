// The page: sliders, buttons, keys, and the address, which keeps them all.

const factors = ["speed", "intensity", "flicker", "contrast", ...eventNames];
const sliders = [...factors, "windx", "windy"];
const learned = (name) => neutral[name];
const windText = (value) => (value < 0 ? "\u2212" : "") + Math.abs(value).toFixed(2) + "\u00a0px";
const valueText = (name, value) => (name.startsWith("wind") ? windText : factorText)(value);

/** Settings, seed and whether to play, from the address; what it does not tell, or tells wrongly, is as learned. */
function readHash() {
  const words = new URLSearchParams(location.hash.slice(1)), settings = {...neutral};
  for (const name of sliders) {
    const value = Number(words.get(name) ?? "x"), {min, max} = $(name);
    if (value >= Number(min) && value <= Number(max)) settings[name] = value;
  }
  settings.reverse = words.get("reverse") === "1";
  return {settings, seed: seedOf(words.get("seed") ?? "") ?? 1n, playing: words.get("play") !== "0"};
}
function hashOf(settings, seed, playing) {
  const words = sliders.filter((name) => settings[name] !== learned(name)).map((name) => `${name}=${settings[name]}`);
  if (settings.reverse) words.push("reverse=1");
  if (seed !== 1n) words.push("seed=" + seed);
  if (!playing) words.push("play=0");
  return words.join("&");
}

/** The command that writes the clip of these settings. */
function commandFor(model, settings, seed) {
  const quoted = /^[\w./-]+$/.test(model) ? model : "'" + model.replaceAll("'", "'\\''") + "'";
  const words = ["emberfold synth", quoted, "-o new.mp4 --fill diffusion"];
  for (const name of factors)
    if (settings[name] !== 1) words.push(eventNames.includes(name) ? `--set synth.${name}=${settings[name]}` : `--${name} ${settings[name]}`);
  if (settings.reverse) words.push("--reverse");
  if (settings.windx !== 0 || settings.windy !== 0) words.push(`--wind=${settings.windx},${settings.windy}`);
  if (seed !== 1n) words.push("--seed " + seed);
  return words.join(" ");
}

class MotionPage {
  constructor(player) {
    this.player = player;
    this.clock = new Clock(data.fps, () => this.advance());
    this.hashTimer = 0;
    this.listen();
  }

  listen() {
    for (const name of sliders) {
      $(name).addEventListener("input", () => this.showSlider(name, Number($(name).value)));
      $(name).addEventListener("change", () => this.want({[name]: Number($(name).value)}));
      $(name + "-reset").addEventListener("click", () => {
        this.want({[name]: learned(name)});
        $(name).focus();
      });
    }
    $("reverse").addEventListener("change", () => this.want({reverse: $("reverse").checked}));
    $("strokes").addEventListener("change", () => this.showStrokes($("strokes").checked));
    $("all-reset").addEventListener("click", () => this.want({...neutral}));
    $("play").addEventListener("click", () => this.play(!this.clock.playing));
    $("step").addEventListener("click", () => this.step());
    $("restart").addEventListener("click", () => this.restart());
    $("seed").addEventListener("change", () => this.takeSeed($("seed").value));
    $("new-seed").addEventListener("click", () => this.takeSeed(String(Math.floor(Math.random() * 1e6))));
    $("copy").addEventListener("click", () => this.copy());
    document.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener("hashchange", () => {
      if (location.hash.slice(1) !== this.hash()) this.takeHash();
    });
  }
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input[type=text], button, pre")) return;
    const action = {" ": () => this.play(!this.clock.playing), ".": () => this.step(), r: () => this.restart()}[event.key];
    if (!action || (event.key === " " && event.target.type === "checkbox")) return;
    event.preventDefault();
    action();
  }

  /** Edited models settle by simulation, which takes a moment: the page says so first. */
  want(settings) {
    this.tell("The model settles into its new balance\u2026");
    requestAnimationFrame(() => setTimeout(() => this.apply(settings)));
  }
  apply(settings) {
    try {
      this.player.set(settings);
      this.tell("");
    } catch (error) {
      this.tell(error.message);
    }
    this.changed();
  }
  takeSeed(text) {
    const seed = seedOf(text.trim());
    if (seed === null) {
      $("seed").value = this.player.seed;
      this.tell("A seed is a whole number from 0 to 2^64 \u2212 1.");
      return;
    }
    this.tell("");
    this.restart(seed);
  }
  takeHash() {
    const {settings, seed, playing} = readHash();
    this.player.seed = seed;
    this.apply(settings);
    this.play(playing);
  }
  showStrokes(strokes) {
    this.player.strokes = strokes;
    this.player.show();
  }

  play(playing) {
    this.clock.play(playing);
    this.changed();
  }
  advance() {
    this.player.step();
    this.showFrame();
  }
  step() {
    this.play(false);
    this.advance();
  }
  restart(seed = this.player.seed) {
    this.player.restart(seed);
    this.changed();
  }

  hash() {
    return hashOf(this.player.settings, this.player.seed, this.clock.playing);
  }
  command() {
    return commandFor(data.model, this.player.settings, this.player.seed);
  }
  async copy() {
    try {
      await navigator.clipboard.writeText(this.command());
      $("copy").textContent = "Copied";
    } catch {
      getSelection().selectAllChildren($("command"));
      $("copy").textContent = "Selected";
    }
    setTimeout(() => { $("copy").textContent = "Copy"; }, 1500);
  }

  /** All that is not a picture. */
  changed() {
    const {settings} = this.player;
    for (const name of sliders) {
      $(name).value = settings[name];
      this.showSlider(name, settings[name]);
    }
    $("reverse").checked = settings.reverse;
    $("strokes").checked = this.player.strokes;
    $("all-reset").disabled = isNeutral(settings);
    $("seed").value = this.player.seed;
    $("play").textContent = this.clock.playing ? "Pause" : "Play";
    $("command").textContent = this.command();
    this.showFrame();
    clearTimeout(this.hashTimer);  // browsers slow down pages that change their address too often
    this.hashTimer = setTimeout(() => history.replaceState(null, "", "#" + this.hash()), 200);
  }
  showSlider(name, value) {
    $(name).setAttribute("aria-valuetext", valueText(name, value));
    $(name + "-value").textContent = valueText(name, value);
    $(name + "-reset").disabled = value === learned(name);
  }
  showFrame() {
    const {player} = this, rate = this.clock.playing ? this.clock.rate() : null, {frames, sums} = player.recent();
    $("frame").textContent = `frame ${player.frame}` +
      (rate !== null && rate < 0.9 * Math.min(data.fps, 60) ? `, ${rate.toFixed(0)} of ${+data.fps.toFixed(2)} frames a second` : "");
    $("events-frames").textContent = frames === 0 ? "so far" : `in the last ${frames} frames`;
    eventNames.forEach((name, k) => { $(name + "-count").textContent = sums[k]; });
  }
  tell(text) {
    $("message").textContent = text;
  }
}

function describe() {
  $("about").textContent = `${data.width} \u00d7 ${data.height}, ${+data.fps.toFixed(2)} frames a second; strokes learned from ${data.frames} frames.`;
  $("foot").textContent = `Made by emberfold ${data.version} of the motion model ${data.model}.`;
  document.documentElement.style.setProperty("--aspect", data.width / data.height);
  for (const id of ["result"]) Object.assign($(id), {width: data.width, height: data.height});
}

async function start() {
  describe();
  const [program, bytes] = await Promise.all(["program", "files"].map(async (id) => new Uint8Array(await inflated($(id).textContent))));
  for (const id of ["program", "files"]) $(id).remove();
  const simulation = new Simulation(await WebAssembly.compile(program), data, bytes);
  const sizes = {width: data.width, height: data.height, empty: data.look.empty_level};
  const fill = makeGraphicsFill(sizes) ?? new PlainFill(sizes);
  if (fill.name !== "webgl2")
    $("slow").textContent = "This browser offers no WebGL 2 with textures of floats: the processor fills instead, which is slower.";
  fill.lost(() => { $("slow").textContent = "The graphics processor was taken away. Load the page again."; });
  const page = new MotionPage(new MotionPlayer(data, simulation, fill, stillPixels(data, bytes), $("result").getContext("2d", {alpha: false})));
  $("loading").hidden = true;
  $("controls").disabled = false;
  const {settings, seed, playing} = readHash();
  page.player.seed = seed;
  page.apply(settings);
  page.play(playing && !matchMedia("(prefers-reduced-motion: reduce)").matches);
  return page;
}

/** For scripts and tests. */
window.emberfold = (() => {
  let page = null;
  const ready = start().then((started) => { page = started; }, (error) => {
    $("message").textContent = "This page cannot run here: " + error.message;
    throw error;
  });
  return {
    data,
    ready,
    get renderer() { return page.player.fill.name; },
    get settings() { return {...page.player.settings}; },
    get seed() { return page.player.seed; },
    get frame() { return page.player.frame; },
    get playing() { return page.clock.playing; },
    get command() { return page.command(); },
    get events() { return page.player.recent(); },
    set: (settings) => page.apply(settings),
    play: () => page.play(true),
    pause: () => page.play(false),
    step: () => page.step(),
    restart: (seed) => page.restart(seed === undefined ? undefined : BigInt(seed)),
    strokes: (shown) => page.showStrokes(shown),
    /** Plain numbers of the frame's graph: patches of id, x, y, direction; edges of two patches' numbers. */
    graph: () => {
      const {patches, edges} = page.player.simulation.graph();
      return {patches: [...patches], edges: [...edges]};
    },
    /** Red, green, blue, 255 of every pixel. */
    pixels: () => {
      const copy = new OffscreenCanvas(data.width, data.height).getContext("2d", {willReadFrequently: true});
      copy.drawImage(page.player.screen.canvas, 0, 0);
      return copy.getImageData(0, 0, data.width, data.height).data;
    },
  };
})();
