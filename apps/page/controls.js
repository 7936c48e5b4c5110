// The page: sliders, buttons, keys, and the address, which keeps them all.

const sliders = ["speed", "intensity", "coarse", "medium", "fine"];
/** The sliders that a preset sets: one that names no speed leaves it. */
const slidersOf = (preset) => sliders.filter((name) => name !== "speed" || preset.speed !== 1);

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
  const words = sliders.filter((name) => settings[name] !== 1).map((name) => `${name}=${settings[name]}`);
  if (settings.reverse) words.push("reverse=1");
  if (seed !== 1n) words.push("seed=" + seed);
  if (!playing) words.push("play=0");
  return words.join("&");
}

class Page {
  constructor(player) {
    this.player = player;
    this.clock = new Clock(data.fps, () => this.advance());
    this.wanted = null;  // settings that the next animation frame takes over
    this.hashTimer = 0;
    this.listen();
  }

  listen() {
    for (const name of sliders) {
      $(name).addEventListener("input", () => this.want({[name]: Number($(name).value)}));
      $(name + "-reset").addEventListener("click", () => {
        this.want({[name]: 1});
        $(name).focus();
      });
    }
    $("reverse").addEventListener("change", () => this.want({reverse: $("reverse").checked}));
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

  /** Settings of sliders take effect once a picture, however fast they come. */
  want(settings) {
    if (!this.wanted) requestAnimationFrame(() => this.apply(this.wanted ?? {}));
    this.wanted = {...(this.wanted ?? {}), ...settings};
    this.showSettings({...this.player.settings, ...this.wanted});
  }
  apply(settings) {
    this.wanted = null;
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
    this.apply(settings);
    this.restart(seed);
    this.play(playing);
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
    const text = this.command().replace("\\\n", "");
    try {
      await navigator.clipboard.writeText(text);
      $("copy").textContent = "Copied";
    } catch {
      getSelection().selectAllChildren($("command"));
      $("copy").textContent = "Selected";
    }
    setTimeout(() => { $("copy").textContent = "Copy"; }, 1500);
  }

  /** All that is not a picture. */
  changed() {
    this.showSettings(this.player.settings);
    $("seed").value = this.player.seed;
    $("play").textContent = this.clock.playing ? "Pause" : "Play";
    $("command").textContent = this.command();
    this.showFrame();
    clearTimeout(this.hashTimer);  // browsers slow down pages that change their address too often
    this.hashTimer = setTimeout(() => history.replaceState(null, "", "#" + this.hash()), 200);
  }
  showSettings(settings) {
    for (const name of sliders) {
      $(name).value = settings[name];
      $(name).setAttribute("aria-valuetext", factorText(settings[name]));
      $(name + "-value").textContent = factorText(settings[name]);
      $(name + "-reset").disabled = settings[name] === 1;
    }
    $("intensity-amplitude").textContent = (100 * Math.sqrt(settings.intensity)).toFixed(0) + "\u00a0%";
    $("reverse").checked = settings.reverse;
    $("all-reset").disabled = hashOf(settings, 1n, true) === "";
    for (const button of document.querySelectorAll("[data-preset]")) {
      const preset = data.presets[button.dataset.preset];
      const fits = slidersOf(preset).every((name) => preset[name] === settings[name]);
      button.setAttribute("aria-pressed", fits);
    }
    const {dropped} = this.player.edit;
    $("dropped").textContent = dropped === 0 ? "" :
      `${dropped} of ${data.order} poles became 0: their phase would pass half a turn a frame.`;
  }
  showFrame() {
    const {player} = this, rate = this.clock.playing ? this.clock.rate() : null;
    $("source-frame").textContent = `frame ${player.sourceFrame} of ${data.frames}`;
    $("result-frame").textContent = `frame ${player.frame}` +
      (rate !== null && rate < 0.9 * Math.min(data.fps, 60) ? `, ${rate.toFixed(0)} of ${+data.fps.toFixed(2)} frames a second` : "");
  }
  tell(text) {
    $("message").textContent = text;
  }
}

function describe() {
  const colour = data.channels === 3 ? "colour" : "grey", plural = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;
  $("about").textContent = [`${data.width} \u00d7 ${data.height} px, ${colour}`, `${+data.fps.toFixed(2)} frames a second`,
    plural(data.components, "component"), `learned from ${plural(data.frames, "frame")}`,
    ...data.edits.map((words) => "edited: " + words)].join(" \u00b7 ");
  $("foot").textContent = `Made by emberfold ${data.version}. This file needs nothing else; it asks for nothing from the network.`;
  const groups = new Map();
  data.presets.forEach((preset, i) => {
    const [subject, effect] = preset.about.split(": ");
    if (!groups.has(subject)) groups.set(subject, make("span", {class: "chips", role: "group", "aria-label": subject}));
    groups.get(subject).append(make("button", {type: "button", "data-preset": i, "aria-pressed": false, title: effect}, preset.name));
  });
  for (const [subject, chips] of groups) $("presets").append(make("div", {}, make("i", {}, subject), chips));
  for (const name of ["source", "result"]) {
    $(name).width = data.width;
    $(name).height = data.height;
  }
  document.documentElement.style.setProperty("--aspect", data.width / data.height);
}

async function start() {
  describe();
  const images = [...document.querySelectorAll("script.image")];
  const drawer = makeGraphicsDrawer(data) ?? makePlainDrawer(data);
  if (drawer.name !== "webgl2")
    $("slow").textContent = "This browser offers no WebGL 2 that is large enough: the processor draws instead, which is slower.";
  drawer.lost(() => { $("slow").textContent = "The graphics processor was taken away. Load the page again."; });
  for (const [i, element] of images.entries()) {
    drawer.addImage(i, await unpackImage(element.textContent, data.width, data.height, data.channels));
    element.remove();
    $("loading").value = (i + 1) / images.length;
  }
  const model = readModel(data, await unpackNumbers($("numbers").textContent, data.numbers));
  const screens = {source: $("source").getContext("2d", {alpha: false}), result: $("result").getContext("2d", {alpha: false})};
  const page = new Page(new Player(data, model, drawer, screens));
  for (const button of document.querySelectorAll("[data-preset]")) {
    const preset = data.presets[button.dataset.preset];
    button.addEventListener("click", () => page.want(Object.fromEntries(slidersOf(preset).map((name) => [name, preset[name]]))));
  }
  $("loading").hidden = true;
  $("controls").disabled = false;
  if (data.components === 0) page.tell("The model has no components: it stands still.");
  const {settings, seed, playing} = readHash();
  page.apply(settings);
  page.restart(seed);
  page.play(playing && !matchMedia("(prefers-reduced-motion: reduce)").matches);
  return page;
}

/** For scripts and tests. Matrices are {rows, cols, data}, a column after the other. */
window.emberfold = (() => {
  let page = null;
  const ready = start().then((started) => { page = started; }, (error) => {
    $("message").textContent = "This page cannot run here: " + error.message;
    throw error;
  });
  return {
    data,
    ready,
    get renderer() { return page.player.drawer.name; },
    get settings() { return {...page.player.settings}; },
    get seed() { return page.player.seed; },
    get frame() { return page.player.frame; },
    get state() { return page.player.state.slice(); },
    get model() { return page.player.edit; },
    get playing() { return page.clock.playing; },
    get command() { return page.command(); },
    set: (settings) => page.apply(settings),
    play: () => page.play(true),
    pause: () => page.play(false),
    step: () => page.step(),
    restart: (seed) => page.restart(seed === undefined ? undefined : BigInt(seed)),
    /** Red, green, blue, 255 of every pixel of "source" or "result". */
    pixels: (name = "result") => {  // by way of a canvas made to be read, so that the screens stay fast
      const copy = new OffscreenCanvas(data.width, data.height).getContext("2d", {willReadFrequently: true});
      copy.drawImage(page.player.screens[name].canvas, 0, 0);
      return copy.getImageData(0, 0, data.width, data.height).data;
    },
  };
})();
