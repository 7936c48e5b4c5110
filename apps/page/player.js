// The running texture: its settings, its state, its frame.

/** A texture's states, frame after frame or around a loop. */
class Course {
  constructor(edit, state = null, circle = null) {
    Object.assign(this, {edit, state, circle});
  }
  /** At a frame of the seed. loop: frames after which it repeats, 0 where it does not. */
  static at(edit, seed, loop, frame) {
    if (loop > 0) {
      const circle = loopStates(edit, seed, loop);
      return new Course(edit, circle[frame], circle);
    }
    const course = new Course(edit, firstState(edit, seed));
    for (let t = 1; t <= frame; ++t) course.step(seed, t);
    return course;
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
    this.learned = edited(model, neutral);
    this.result = new Course(this.learned);
    this.mask = null;
    this.ground = null;  // what moves as learned where the mask hides the edits
    this.restart();
  }
  /** Other settings, from the next frame on. */
  set(settings) {
    const wanted = {...this.settings, ...settings}, {loop} = wanted;
    const result = this.result.changed(edited(this.model, wanted), this.seed, loop);
    const ground = this.ground && loop !== this.settings.loop ? this.ground.changed(this.learned, this.seed, loop) : this.ground;
    Object.assign(this, {settings: wanted, result, ground});
    if (loop > 0) this.turnTo(this.frame % loop);
    this.show();
  }
  /** Shows the edits where the mask is white; null: everywhere. */
  setMask(mask) {
    const {seed, frame, settings: {loop}} = this;
    this.ground = mask && (this.ground ?? Course.at(this.learned, seed, loop, frame));
    this.mask = mask;
    this.show();
  }
  /** Takes a frame of the loop. */
  turnTo(frame) {
    this.frame = frame;
    for (const course of this.courses()) course.state = course.circle[frame];
  }
  courses() {
    return this.ground ? [this.result, this.ground] : [this.result];
  }
  /** Frame 0 of the seed: what `emberfold dytex synth` begins with. */
  restart(seed = this.seed) {
    const {settings: {loop}} = this;
    this.seed = seed;
    this.frame = 0;
    this.sourceFrame = 0;
    this.result = Course.at(this.result.edit, seed, loop, 0);
    if (this.ground) this.ground = Course.at(this.learned, seed, loop, 0);
    this.show();
  }
  step() {
    const {settings: {loop}} = this;
    this.sourceFrame = (this.sourceFrame + 1) % this.data.frames;
    this.frame = loop > 0 ? (this.frame + 1) % loop : this.frame + 1;
    for (const course of this.courses()) course.step(this.seed, this.frame);
    this.show();
  }
  show() {
    const n = this.data.components, at = this.sourceFrame * n;
    this.drawer.draw(this.worth(this.model.states.data.subarray(at, at + n), this.ones), this.screens.source);
    this.draw(this.parts(), ({state}) => state, this.screens.result);
  }
  /** What the result is made of: stays as it is when settings change. */
  parts() {
    return {result: this.result, ground: this.ground, opacity: this.mask?.opacity(this.settings)};
  }
  /** stateOf: tells the state of a course. */
  draw({result, ground, opacity}, stateOf, to) {
    const worth = (course) => this.worth(stateOf(course), course.edit.weights);
    this.drawer.draw(worth(result), to, ground && {worth: worth(ground), opacity});
  }
  /** Levels that a step of each image is worth: of the mean, then of the components. */
  worth(state, weights) {
    return [this.data.mean_step, ...this.data.steps.map((step, i) => step * weights[i] * state[i])];
  }
}
