// The running texture: its settings, its state, its frame.

class Player {
  /** screens: the 2D contexts of source and result. */
  constructor(data, model, drawer, screens) {
    Object.assign(this, {data, model, drawer, screens});
    this.ones = new Float64Array(data.components).fill(1);
    this.settings = {...neutral};
    this.seed = 1n;
    this.sourceFrame = 0;
    this.edit = edited(model, this.settings);
    this.restart();
  }
  /** Other settings, from the next frame on: the state stays. */
  set(settings) {
    const wanted = {...this.settings, ...settings};
    this.edit = edited(this.model, wanted);
    this.settings = wanted;
    this.show();
  }
  /** Frame 0 of the seed: what `emberfold dytex synth` begins with. */
  restart(seed = this.seed) {
    this.seed = seed;
    this.frame = 0;
    this.sourceFrame = 0;
    this.state = firstState(this.edit, seed);
    this.show();
  }
  step() {
    this.frame += 1;
    this.sourceFrame = (this.sourceFrame + 1) % this.data.frames;
    this.state = nextState(this.edit, this.state, this.seed, this.frame);
    this.show();
  }
  show() {
    const n = this.data.components, at = this.sourceFrame * n;
    this.drawer.draw(this.worth(this.model.states.data.subarray(at, at + n), this.ones), this.screens.source);
    this.drawer.draw(this.worth(this.state, this.edit.weights), this.screens.result);
  }
  /** Levels that a step of each image is worth: of the mean, then of the components. */
  worth(state, weights) {
    return [this.data.mean_step, ...this.data.steps.map((step, i) => step * weights[i] * state[i])];
  }
}
