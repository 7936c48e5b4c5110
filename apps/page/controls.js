// The page of a texture: its sliders, presets and pictures.

const sliders = ["speed", "flow", "intensity", "coarse", "medium", "fine"];
const longestLoop = 1000;
const addressed = {
  weights(text) {
    const fits = ([component, factor]) => Number.isInteger(component) && component >= 1 && component <= data.components && factor >= 0 && factor <= 3;
    return /^\d+:[\d.]+(,\d+:[\d.]+)*$/.test(text) && [...weightsOf(text)].every(fits) ? weightsText(weightsOf(text)) : undefined;
  },
  loop: (text) => (/^\d+$/.test(text) && Number(text) >= 2 && Number(text) <= longestLoop ? Number(text) : undefined),
};
/** The sliders that a preset sets: one that names no speed leaves it. */
const slidersOf = (preset) => sliders.filter((name) => name in preset && (name !== "speed" || preset.speed !== 1));

class TexturePage extends ModelPage {
  constructor(player) {
    super(player);
    this.wanted = null;  // settings that the next animation frame takes over
    this.listenToComponents();
    this.listenToLoop();
  }
  listenToComponents() {
    $("component").max = data.components;
    const weigh = (factor) => {
      const {weights: text} = {...this.player.settings, ...this.wanted}, weights = weightsOf(text);
      this.want({weights: weightsText(weights.set(Number($("component").value), factor))});
    };
    $("component").addEventListener("change", () => {
      $("component").value = Math.min(Math.max(Math.round(Number($("component").value)) || 1, 1), data.components);
      this.showSettings(this.player.settings);
    });
    $("weight").addEventListener("input", () => weigh(Number($("weight").value)));
    $("weight-reset").addEventListener("click", () => weigh(1));
  }
  listenToLoop() {
    const take = () => {
      $("loop").value = Math.min(Math.max(Math.round(Number($("loop").value)) || 2, 2), longestLoop);
      this.want({loop: $("looped").checked ? Number($("loop").value) : 0});
    };
    $("looped").addEventListener("change", take);
    $("loop").addEventListener("change", take);
  }
  listenTo(name) {
    $(name).addEventListener("input", () => this.want({[name]: Number($(name).value)}));
  }
  /** Settings of sliders take effect once a picture, however fast they come. */
  want(settings) {
    if (!this.wanted) requestAnimationFrame(() => this.apply(this.wanted ?? {}));
    this.wanted = {...(this.wanted ?? {}), ...settings};
    this.showSettings({...this.player.settings, ...this.wanted});
  }
  apply(settings) {
    this.wanted = null;
    super.apply(settings);
  }
  command() {
    const {settings, seed} = this.player;
    return commandFor(data.model, settings, seed);
  }
  showSettings(settings) {
    for (const name of sliders) this.showSlider(name, settings[name], factorText(settings[name]));
    $("intensity-amplitude").textContent = (100 * Math.sqrt(settings.intensity)).toFixed(0) + "\u00a0%";
    $("reverse").checked = settings.reverse;
    const weights = weightsOf(settings.weights), weight = weights.get(Number($("component").value)) ?? 1;
    $("weight").value = weight;
    $("weight").setAttribute("aria-valuetext", factorText(weight));
    $("weight-value").textContent = factorText(weight);
    $("weight-reset").disabled = weight === 1;
    $("weights").textContent = weights.size === 0 ? "" : "Changed: " + [...weights].map(([i, factor]) => `${i} (${factorText(factor)})`).join(", ");
    $("looped").checked = settings.loop > 0;
    if (settings.loop > 0) $("loop").value = settings.loop;
    $("all-reset").disabled = isNeutral(settings);
    for (const button of document.querySelectorAll("[data-preset]")) {
      const preset = data.presets[button.dataset.preset];
      const fits = slidersOf(preset).every((name) => preset[name] === settings[name]);
      button.setAttribute("aria-pressed", fits);
    }
    const {dropped} = this.player.result.edit;
    $("dropped").textContent = dropped === 0 ? "" :
      `${dropped} of ${data.order} poles became 0: their phase would pass half a turn a frame.`;
  }
  showFrame() {
    const {player} = this;
    $("source-frame").textContent = `frame ${player.sourceFrame} of ${data.frames}`;
    $("result-frame").textContent = `frame ${player.frame}` + (player.settings.loop > 0 ? ` of ${player.settings.loop}` : "") + this.rateText();
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
  const page = new TexturePage(new Player(data, model, drawer, screens));
  for (const button of document.querySelectorAll("[data-preset]")) {
    const preset = data.presets[button.dataset.preset];
    button.addEventListener("click", () => page.want(Object.fromEntries(slidersOf(preset).map((name) => [name, preset[name]]))));
  }
  if (data.components === 0) page.tell("The model has no components: it stands still.");
  return page;
}

window.emberfold = publish(start, (page) => ({
  get renderer() { return page().player.drawer.name; },
  get state() { return page().player.result.state.slice(); },
  /** Matrices are {rows, cols, data}, a column after the other. */
  get model() { return page().player.result.edit; },
  /** Of "source" or "result". */
  pixels: (name = "result") => pixelsOf(page().player.screens[name].canvas),
}));
