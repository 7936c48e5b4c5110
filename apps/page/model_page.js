// What the pages of models have in common: sliders, buttons, keys, and the address, which keeps them all. A page's own script
// names its `sliders`, the `neutral` settings, and the class of its page; and in `addressed` what else the address keeps: by its
// name the setting that a text tells, undefined where it tells none.

/** Settings, seed and whether to play, from the address; what it does not tell, or tells wrongly, is as learned. */
function readHash() {
  const words = new URLSearchParams(location.hash.slice(1)), settings = {...neutral};
  for (const name of sliders) {
    const value = Number(words.get(name) ?? "x"), {min, max} = $(name);
    if (value >= Number(min) && value <= Number(max)) settings[name] = value;
  }
  for (const [name, read] of Object.entries(addressed)) settings[name] = read(words.get(name) ?? "") ?? neutral[name];
  settings.reverse = words.get("reverse") === "1";
  return {settings, seed: seedOf(words.get("seed") ?? "") ?? 1n, playing: words.get("play") !== "0"};
}
const isNeutral = (settings) => Object.entries(neutral).every(([name, value]) => settings[name] === value);
function hashOf(settings, seed, playing) {
  const words = [...sliders, ...Object.keys(addressed)].filter((name) => settings[name] !== neutral[name])
    .map((name) => `${name}=${settings[name]}`);
  if (settings.reverse) words.push("reverse=1");
  if (seed !== 1n) words.push("seed=" + seed);
  if (!playing) words.push("play=0");
  return words.join("&");
}

/** A subclass has listenTo(slider), want(settings), command(), showSettings(settings) and showFrame(). */
class ModelPage {
  constructor(player) {
    this.player = player;
    this.clock = new Clock(data.fps, () => this.advance());
    this.hashTimer = 0;
    this.address = location.hash;  // as it was read or written last
    this.listen();
  }

  listen() {
    for (const name of sliders) {
      this.listenTo(name);
      $(name + "-reset").addEventListener("click", () => {
        this.want({[name]: neutral[name]});
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
      this.address = location.hash;
      if (location.hash.slice(1) !== this.hash()) this.begin(readHash());
    });
  }
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input[type=text], button, pre")) return;
    const action = {" ": () => this.play(!this.clock.playing), ".": () => this.step(), r: () => this.restart()}[event.key];
    if (!action || (event.key === " " && event.target.type === "checkbox")) return;
    event.preventDefault();
    action();
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
  /** Takes over what the address tells. */
  begin({settings, seed, playing}) {
    this.apply(settings);
    this.restart(seed);
    this.play(playing);
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
  async copy() {
    const text = this.command().replaceAll("\\\n", "");
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
    this.hashTimer = setTimeout(() => this.writeAddress(), 200);
  }
  writeAddress() {
    if (location.hash !== this.address) return;  // somebody has changed it: it is about to be read
    history.replaceState(null, "", "#" + this.hash());
    this.address = location.hash;
  }
  showSlider(name, value, text) {
    $(name).value = value;
    $(name).setAttribute("aria-valuetext", text);
    $(name + "-value").textContent = text;
    $(name + "-reset").disabled = value === neutral[name];
  }
  /** Words on the rate of frames, where the machine does not keep up. */
  rateText() {
    const rate = this.clock.playing ? this.clock.rate() : null;
    return rate !== null && rate < 0.9 * Math.min(data.fps, 60) ? `, ${rate.toFixed(0)} of ${+data.fps.toFixed(2)} frames a second` : "";
  }
  tell(text) {
    $("message").textContent = text;
  }
}

/** Red, green, blue, 255 of every pixel of a canvas, by way of one made to be read, so that the screens stay fast. */
function pixelsOf(canvas) {
  const copy = new OffscreenCanvas(data.width, data.height).getContext("2d", {willReadFrequently: true});
  copy.drawImage(canvas, 0, 0);
  return copy.getImageData(0, 0, data.width, data.height).data;
}

/** Starts the page; returns what scripts and tests may call, with the page's own `members` (of a function that gives the page). */
function publish(start, members) {
  let page = null;
  const ready = start().then(
    (started) => {
      page = started;
      $("loading").hidden = true;
      $("controls").disabled = false;
      const address = readHash();
      page.begin({...address, playing: address.playing && !matchMedia("(prefers-reduced-motion: reduce)").matches});
    }).catch((error) => {
    $("message").textContent = "This page cannot run here: " + error.message;
    throw error;
  });
  const shared = {
    data,
    ready,
    get settings() { return {...page.player.settings}; },
    get seed() { return page.player.seed; },
    get frame() { return page.player.frame; },
    get playing() { return page.clock.playing; },
    get command() { return page.command(); },
    set: (settings) => page.apply(settings),
    play: () => page.play(true),
    pause: () => page.play(false),
    step: () => page.step(),
    restart: (seed) => page.restart(seed === undefined ? undefined : BigInt(seed)),
  };
  return Object.defineProperties(shared, Object.getOwnPropertyDescriptors(members(() => page)));
}
