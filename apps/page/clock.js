// What makes a page play.

/** Calls tick() as often a second as the clip has frames, as far as the machine keeps up. */
class Clock {
  constructor(fps, tick) {
    Object.assign(this, {interval: 1000 / fps, tick, playing: false, due: 0, times: []});
  }
  play(playing) {
    if (playing === this.playing) return;
    this.playing = playing;
    this.times = [];
    this.due = performance.now();
    if (playing) requestAnimationFrame((now) => this.turn(now));
  }
  turn(now) {
    if (!this.playing) return;
    if (now >= this.due) {
      this.due = Math.max(this.due + this.interval, now - this.interval);  // what is late is not made up for
      this.tick();
      this.times.push(now);
      if (this.times.length > 30) this.times.shift();
    }
    requestAnimationFrame((next) => this.turn(next));
  }
  /** Frames a second of late; null until that can be told. */
  rate() {
    const {times} = this;
    return times.length < 10 ? null : 1000 * (times.length - 1) / (times[times.length - 1] - times[0]);
  }
}
