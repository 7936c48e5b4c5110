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
  /** Other settings, from the next frame on: the state stays, but in a loop. */
  set(settings) {
    const wanted = {...this.settings, ...settings}, edit = edited(this.model, wanted);
    this.circle = wanted.loop > 0 ? loopStates(edit, this.seed, wanted.loop) : null;
    this.edit = edit;
    this.settings = wanted;
    if (this.circle) this.turnTo(this.frame);
    this.show();
  }
  /** Takes a frame of the loop. */
  turnTo(frame) {
    this.frame = frame % this.circle.length;
    this.state = this.circle[this.frame];
  }
  /** Frame 0 of the seed: what `emberfold dytex synth` begins with. */
  restart(seed = this.seed) {
    this.seed = seed;
    this.frame = 0;
    this.sourceFrame = 0;
    if (this.settings.loop > 0) {
      this.circle = loopStates(this.edit, seed, this.settings.loop);
      this.turnTo(0);
    } else {
      this.circle = null;
      this.state = firstState(this.edit, seed);
    }
    this.show();
  }
  step() {
    this.sourceFrame = (this.sourceFrame + 1) % this.data.frames;
    if (this.circle) {
      this.turnTo(this.frame + 1);
    } else {
      this.frame += 1;
      this.state = nextState(this.edit, this.state, this.seed, this.frame);
    }
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
