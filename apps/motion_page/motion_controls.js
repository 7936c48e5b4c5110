// The page of a motion model: its sliders, its picture, and the events that the model draws.

const factors = ["speed", "intensity", "flicker", "contrast", ...eventNames];
const sliders = [...factors, "windx", "windy"];
const addressed = {};
const windText = (value) => (value < 0 ? "\u2212" : "") + Math.abs(value).toFixed(2) + "\u00a0px";

/** The command that writes the clip of these settings. */
function commandFor(model, settings, seed) {
  const words = ["emberfold synth", shellWord(model), "-o new.mp4 --fill diffusion"];
  for (const name of factors)
    if (settings[name] !== 1) words.push(eventNames.includes(name) ? `--set synth.${name}=${settings[name]}` : `--${name} ${settings[name]}`);
  if (settings.reverse) words.push("--reverse");
  if (settings.windx !== 0 || settings.windy !== 0) words.push(`--wind=${settings.windx},${settings.windy}`);
  if (seed !== 1n) words.push("--seed " + seed);
  return words.join(" ");
}

class MotionPage extends ModelPage {
  listen() {
    super.listen();
    $("strokes").addEventListener("change", () => this.showStrokes($("strokes").checked));
  }
  listenTo(name) {
    $(name).addEventListener("input", () => this.showValue(name, Number($(name).value)));
    $(name).addEventListener("change", () => this.want({[name]: Number($(name).value)}));
  }
  /** Edited models settle by simulation, which takes a moment: the page says so first. */
  want(settings) {
    this.tell("The model settles into its new balance\u2026");
    requestAnimationFrame(() => setTimeout(() => this.apply(settings)));
  }
  /** One edit makes the clip of settings and seed. */
  begin({settings, seed, playing}) {
    this.player.seed = seed;
    this.apply(settings);
    this.play(playing);
  }
  showStrokes(strokes) {
    this.player.strokes = strokes;
    this.player.show();
  }

  command() {
    return commandFor(data.model, this.player.settings, this.player.seed);
  }

  showSettings(settings) {
    for (const name of sliders) this.showValue(name, settings[name]);
    $("reverse").checked = settings.reverse;
    $("strokes").checked = this.player.strokes;
    $("all-reset").disabled = isNeutral(settings);
  }
  showValue(name, value) {
    this.showSlider(name, value, (name.startsWith("wind") ? windText : factorText)(value));
  }
  showFrame() {
    const {frames, sums} = this.player.recent();
    $("frame").textContent = `frame ${this.player.frame}` + this.rateText();
    $("events-frames").textContent = frames === 0 ? "so far" : `in the last ${frames} frames`;
    eventNames.forEach((name, k) => { $(name + "-count").textContent = sums[k]; });
  }
}

function describe() {
  $("about").textContent = `${data.width} \u00d7 ${data.height}, ${+data.fps.toFixed(2)} frames a second; strokes learned from ${data.frames} frames.`;
  $("foot").textContent = `Made by emberfold ${data.version} of the motion model ${data.model}.`;
  document.documentElement.style.setProperty("--aspect", data.width / data.height);
  Object.assign($("result"), {width: data.width, height: data.height});
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
  return new MotionPage(new MotionPlayer(data, simulation, fill, stillPixels(data, bytes), $("result").getContext("2d", {alpha: false})));
}

window.emberfold = publish(start, (page) => ({
  get renderer() { return page().player.fill.name; },
  get events() { return page().player.recent(); },
  strokes: (shown) => page().showStrokes(shown),
  /** Plain numbers of the frame's graph: patches of id, x, y, direction; edges of two patches' numbers. */
  graph: () => {
    const {patches, edges} = page().player.simulation.graph();
    return {patches: [...patches], edges: [...edges]};
  },
  pixels: () => pixelsOf(page().player.screen.canvas),
}));
