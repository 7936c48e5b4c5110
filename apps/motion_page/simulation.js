// The simulator of motion models, compiled for the page (apps/motion_page/wasm): the code that the program runs.

class Simulation {
  /** data: the page's; bytes: all files that data.files and data.images place. */
  constructor(module, data, bytes) {
    Object.assign(this, {module, data, bytes});
    this.load();
  }
  /** Begins anew with the model as learned: after a call that failed, nothing else may be called. */
  load() {
    const exports = new WebAssembly.Instance(this.module, this.imports()).exports, {data} = this;
    this.exports = exports;
    exports._initialize();
    for (const [name, place] of Object.entries(data.files))
      this.lend([name + "\0", place], (text, file) => exports.add_file(text, file, place[1]));
    const {look} = data;
    exports.set_look(look.channels, look.blur_share, look.contrast_gain);
    if (look.range)
      this.lend([look.range.low, look.range.high],
        (low, high) => exports.set_range(look.range.columns, look.range.rows, look.range.channels, low, high));
    if (look.still)
      this.lend([look.still.levels, look.still.still, look.still.fixed],
        (levels, still, fixed) => exports.set_still(data.width * data.height, levels, still, fixed));
    exports.read_model();
  }
  imports() {
    const fail = (words) => { throw new Error(this.text(words)); };
    const wasi = Object.fromEntries(WebAssembly.Module.imports(this.module)
      .filter(({module}) => module === "wasi_snapshot_preview1").map(({name}) => [name, () => 8]));  // no files here
    return {page: {fail}, wasi_snapshot_preview1: wasi};
  }
  text(at) {
    const memory = new Uint8Array(this.exports.memory.buffer);
    return new TextDecoder().decode(memory.slice(at, memory.indexOf(0, at)));
  }
  /** Calls `use` with the addresses of copies of texts, numbers and places of this.bytes. */
  lend(things, use) {
    const rooms = things.map((thing) => {
      const bytes = typeof thing === "string" ? new TextEncoder().encode(thing) :
        thing instanceof Float64Array ? new Uint8Array(thing.buffer) : this.bytes.subarray(thing[0], thing[0] + thing[1]);
      const room = this.exports.room(Math.max(bytes.length, 1));
      new Uint8Array(this.exports.memory.buffer).set(bytes, room);
      return room;
    });
    use(...rooms);
    for (const room of rooms) this.exports.release(room);
  }
  /** Changes the model as learned, as `emberfold synth` would by the same options and seed. */
  edit(settings, seed) {
    const factors = new Float64Array(
      ["speed", "reverse", "intensity", "flicker", "contrast", "windx", "windy", ...eventNames].map((name) => Number(settings[name])));
    this.lend([factors], (at) => this.exports.edit(at, ...halves(seed)));
  }
  begin(seed) {
    this.exports.begin(...halves(seed));
  }
  /** The next frame: pixels (red, green, blue, how much of it is there), counts of events. */
  next() {
    const {exports, data} = this;
    exports.next();
    const {buffer} = exports.memory;
    return {
      pixels: new Uint8ClampedArray(buffer, exports.pixels(), 4 * data.width * data.height),
      events: [...new Int32Array(buffer, exports.operators(), eventNames.length)],
    };
  }
  /** The frame's strokes: id, x, y, direction of each patch, and pairs of patches. */
  graph() {
    const {exports} = this, {buffer} = exports.memory;
    return {
      patches: new Float64Array(buffer, exports.patches(), 4 * exports.patch_count()),
      edges: new Uint32Array(buffer, exports.edges(), 2 * exports.edge_count()),
    };
  }
}

const eventNames = ["births", "deaths", "splits", "merges", "connects", "disconnects"];
/** A seed of 64 bits as two numbers of 32. */
const halves = (seed) => [Number(seed & 0xffffffffn), Number(seed >> 32n)];
