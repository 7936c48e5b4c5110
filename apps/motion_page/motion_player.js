// The running model: its settings, its frame, and what has happened of late.

const neutral = {
  speed: 1, reverse: false, intensity: 1, flicker: 1, contrast: 1, windx: 0, windy: 0,
  births: 1, deaths: 1, splits: 1, merges: 1, connects: 1, disconnects: 1,
};
const countedFrames = 100;

class MotionPlayer {
  /** screen: the 2D context that frames are drawn into. */
  constructor(data, simulation, fill, still, screen) {
    Object.assign(this, {data, simulation, fill, still, screen, settings: {...neutral}, seed: 1n, strokes: false});
    this.restart();
  }
  /** Other settings: the clip begins anew. Throws, and stays with those before, where the model cannot take them. */
  set(settings) {
    const before = this.settings;
    this.settings = {...this.settings, ...settings};
    try {
      this.restart();
    } catch (error) {
      this.settings = before;
      this.simulation.load();
      this.restart();
      throw error;
    }
  }
  /** Frame 0 of the seed: what `emberfold synth --fill diffusion` begins with. */
  restart(seed = this.seed) {
    this.seed = seed;
    this.simulation.edit(this.settings, seed);
    this.simulation.begin(seed);
    this.frame = -1;
    this.counts = [];
    this.step();
  }
  step() {
    this.frame += 1;
    const {pixels, events} = this.simulation.next();
    if (this.frame > 0) this.counts.push(events);
    if (this.counts.length > countedFrames) this.counts.shift();
    this.pixels = pixels;
    this.show();
  }
  show() {
    this.fill.draw(this.pixels, this.still, this.screen);
    if (this.strokes) this.drawStrokes();
  }
  drawStrokes() {
    const {patches, edges} = this.simulation.graph(), {screen} = this;
    screen.strokeStyle = "#35d6ff";
    screen.lineWidth = 1;
    screen.beginPath();
    for (let i = 0; i < edges.length; i += 2) {
      screen.moveTo(patches[4 * edges[i] + 1] + 0.5, patches[4 * edges[i] + 2] + 0.5);
      screen.lineTo(patches[4 * edges[i + 1] + 1] + 0.5, patches[4 * edges[i + 1] + 2] + 0.5);
    }
    screen.stroke();
  }
  /** Events of each kind in the last frames, and how many frames that are. */
  recent() {
    const sums = eventNames.map((_, k) => this.counts.reduce((sum, events) => sum + events[k], 0));
    return {frames: this.counts.length, sums};
  }
}

/** The still pixels that show through the strokes' ends, for a fill; null where there are none. */
function stillPixels({look, width, height}, bytes) {
  if (!look.still) return null;
  const part = ([at, size]) => bytes.subarray(at, at + size), {channels} = look;
  const from = part(look.still.levels), shares = part(look.still.share), count = width * height;
  const still = {levels: new Float32Array(3 * count), share: new Float32Array(count), bytes: new Uint8Array(4 * count)};
  for (let p = 0; p < count; ++p) {
    still.share[p] = shares[p] / 255;
    still.bytes[4 * p + 3] = shares[p];
    for (let c = 0; c < 3; ++c)
      still.levels[3 * p + c] = still.bytes[4 * p + c] = from[channels === 3 ? 3 * p + 2 - c : p];
  }
  return still;
}
