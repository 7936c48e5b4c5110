// The page of a texture: its sliders, presets and pictures.

const sliders = ["speed", "intensity", "coarse", "medium", "fine"];
/** The sliders that a preset sets: one that names no speed leaves it. */
const slidersOf = (preset) => sliders.filter((name) => name !== "speed" || preset.speed !== 1);

class TexturePage extends ModelPage {
  constructor(player) {
    super(player);
    this.wanted = null;  // settings that the next animation frame takes over
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
    return commandFor(data.model, this.player.settings, this.player.seed);
  }
  showSettings(settings) {
    for (const name of sliders) this.showSlider(name, settings[name], factorText(settings[name]));
    $("intensity-amplitude").textContent = (100 * Math.sqrt(settings.intensity)).toFixed(0) + "\u00a0%";
    $("reverse").checked = settings.reverse;
    $("all-reset").disabled = isNeutral(settings);
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
    const {player} = this;
    $("source-frame").textContent = `frame ${player.sourceFrame} of ${data.frames}`;
    $("result-frame").textContent = `frame ${player.frame}` + this.rateText();
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
  get state() { return page().player.state.slice(); },
  /** Matrices are {rows, cols, data}, a column after the other. */
  get model() { return page().player.edit; },
  /** Of "source" or "result". */
  pixels: (name = "result") => pixelsOf(page().player.screens[name].canvas),
}));
