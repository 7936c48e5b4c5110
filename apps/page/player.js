// The running texture: its settings, its state, its frame.

/** A texture's states, frame after frame or around a loop. */
class Course {
  constructor(edit, state = null, circle = null) {
    Object.assign(this, {edit, state, circle});
  }
  /** At frame 0 of the seed. loop: frames after which it repeats, 0 where it does not. */
  static begin(edit, seed, loop) {
    if (loop === 0) return new Course(edit, firstState(edit, seed));
    const circle = loopStates(edit, seed, loop);
    return new Course(edit, circle[0], circle);
  }
  /** With another edit and loop from here on: the state stays, but in a loop. */
  changed(edit, seed, loop) {
    return new Course(edit, this.state, loop > 0 ? loopStates(edit, seed, loop) : null);
  }
  step(seed, frame) {
    this.state = this.circle ? this.circle[frame] : nextState(this.edit, this.state, seed, frame);
  }
}

class Player {
  /** screens: the 2D contexts of source and result. */
  constructor(data, model, drawer, screens) {
    Object.assign(this, {data, model, drawer, screens});
    this.ones = new Float64Array(data.components).fill(1);
    this.settings = {...neutral};
    this.seed = 1n;
    this.sourceFrame = 0;
    this.result = new Course(edited(model, neutral));
    this.restart();
  }
  /** Other settings, from the next frame on. */
  set(settings) {
    const wanted = {...this.settings, ...settings}, {loop} = wanted;
    Object.assign(this, {settings: wanted, result: this.result.changed(edited(this.model, wanted), this.seed, loop)});
    if (loop > 0) this.turnTo(this.frame % loop);
    this.show();
  }
  /** Takes a frame of the loop. */
  turnTo(frame) {
    this.frame = frame;
    this.result.state = this.result.circle[frame];
  }
  /** Frame 0 of the seed: what `emberfold dytex synth` begins with. */
  restart(seed = this.seed) {
    const {settings: {loop}} = this;
    this.seed = seed;
    this.frame = 0;
    this.sourceFrame = 0;
    this.result = Course.begin(this.result.edit, seed, loop);
    this.show();
  }
  step() {
    const {settings: {loop}} = this;
    this.sourceFrame = (this.sourceFrame + 1) % this.data.frames;
    this.frame = loop > 0 ? (this.frame + 1) % loop : this.frame + 1;
    this.result.step(this.seed, this.frame);
    this.show();
  }
  show() {
    const n = this.data.components, at = this.sourceFrame * n;
    this.drawer.draw(this.worth(this.model.states.data.subarray(at, at + n), this.ones), this.screens.source);
    this.drawer.draw(this.worth(this.result.state, this.result.edit.weights), this.screens.result);
  }
  /** Levels that a step of each image is worth: of the mean, then of the components. */
  worth(state, weights) {
    return [this.data.mean_step, ...this.data.steps.map((step, i) => step * weights[i] * state[i])];
  }
}
