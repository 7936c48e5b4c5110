// Levels between the strokes: heat diffusion from what is held. What is there in part (a stroke that fades) holds its
// pixel in part: (held + number of neighbours) level = held · shown level + sum of the neighbours' levels. Solved by
// multigrid: a first guess from coarse grids to fine ones, then cycles that correct it by what its residual asks of the
// coarser grids (Brandt 1977), smoothed by damped Jacobi steps. A cell of a coarser grid is the sum of four.

const firstSteps = 4, cycles = 3, smoothingSteps = 2, jacobiDamping = 0.8;
const heldWhole = 1e4, heldHalf = 0.05;  // conductance to what a pixel shows, where all, or half of it is there

/** Sizes of the grids, the finest first. */
function gridSizes(width, height) {
  const sizes = [[width, height]];
  while (width > 1 || height > 1) {
    width = Math.ceil(width / 2);
    height = Math.ceil(height / 2);
    sizes.push([width, height]);
  }
  return sizes;
}

/**
 * Solves on all grids, whatever they are made of. `steps` has of a grid: guess() from the coarser one, correct() by it,
 * smooth(times), residual() into the coarser one's right side, and of the last grid solve().
 */
function multigrid(steps, count) {
  const last = count - 1;
  steps.solve("shown");
  for (let k = last - 1; k >= 0; --k) {
    steps.guess(k);
    steps.smooth(k, "shown", firstSteps);
  }
  for (let cycle = 0; cycle < cycles; ++cycle) {
    for (let k = 0; k < last; ++k) {
      if (k > 0) steps.clear(k);
      steps.smooth(k, k === 0 ? "shown" : "residual", smoothingSteps);
      steps.residual(k, k === 0 ? "shown" : "residual");
    }
    steps.solve("residual");
    for (let k = last - 1; k >= 0; --k) {
      steps.correct(k);
      steps.smooth(k, k === 0 ? "shown" : "residual", smoothingSteps);
    }
  }
}

/** The fill on the processor. Right sides are four numbers a cell: three channels, and how firmly it is held. */
class PlainFill {
  constructor({width, height, empty}) {
    Object.assign(this, {name: "processor", empty});
    this.grids = gridSizes(width, height).map(([w, h]) => ({
      width: w, height: h, shown: new Float32Array(4 * w * h), residual: new Float32Array(4 * w * h),
      levels: new Float32Array(3 * w * h), next: new Float32Array(3 * w * h),
    }));
    this.picture = new ImageData(width, height);
  }
  /** Fills between `pixels` (red, green, blue, how much is there), and draws that; `still`: as from stillPixels, or null. */
  draw(pixels, still, to) {
    const {shown} = this.grids[0];
    for (let i = 0; i < shown.length; i += 4) {
      const there = pixels[i + 3], held = there === 255 ? heldWhole : heldHalf * there / (255 - there);
      for (let c = 0; c < 3; ++c) shown[i + c] = held * pixels[i + c];
      shown[i + 3] = held;
    }
    for (let k = 1; k < this.grids.length; ++k) this.coarsen(k);
    multigrid(this, this.grids.length);
    this.show(still, to);
  }
  show(still, to) {
    const {levels} = this.grids[0], {data} = this.picture;
    for (let p = 0; p < data.length / 4; ++p) {
      for (let c = 0; c < 3; ++c) {
        const level = levels[3 * p + c];
        data[4 * p + c] = still ? level + still.share[p] * (still.levels[3 * p + c] - level) : level;
      }
      data[4 * p + 3] = 255;
    }
    to.putImageData(this.picture, 0, 0);
  }
  coarsen(k) {
    const fine = this.grids[k - 1], {width, shown} = this.grids[k];
    shown.fill(0);
    for (let y = 0, from = 0; y < fine.height; ++y)
      for (let x = 0; x < fine.width; ++x) {
        const to = 4 * ((y >> 1) * width + (x >> 1));
        for (let c = 0; c < 4; ++c) shown[to + c] += fine.shown[from++];
      }
  }
  solve(right) {
    const last = this.grids[this.grids.length - 1], held = last[right][3];
    for (let c = 0; c < 3; ++c)
      last.levels[c] = held > 0 ? last[right][c] / held : right === "shown" ? this.empty : 0;
  }
  clear(k) {
    this.grids[k].levels.fill(0);
  }
  guess(k) {
    this.grids[k].levels.fill(0);
    this.correct(k);
  }
  /** Adds the coarser grid's levels, linear between the middles of its cells. */
  correct(k) {
    const coarse = this.grids[k + 1], fine = this.grids[k];
    for (let y = 0; y < fine.height; ++y) {
      const row = y >> 1, other = Math.min(Math.max(row + (y & 1 ? 1 : -1), 0), coarse.height - 1);
      for (let x = 0; x < fine.width; ++x) {
        const column = x >> 1, beside = Math.min(Math.max(column + (x & 1 ? 1 : -1), 0), coarse.width - 1);
        const a = row * coarse.width, b = other * coarse.width, p = y * fine.width + x;
        for (let c = 0; c < 3; ++c)
          fine.levels[3 * p + c] +=
            0.5625 * coarse.levels[3 * (a + column) + c] + 0.1875 * coarse.levels[3 * (a + beside) + c] +
            0.1875 * coarse.levels[3 * (b + column) + c] + 0.0625 * coarse.levels[3 * (b + beside) + c];
      }
    }
  }
  smooth(k, right, times) {
    const grid = this.grids[k], {width, height} = grid, asked = grid[right], row = 3 * width;
    for (; times > 0; --times) {
      const {levels, next} = grid;
      for (let y = 0, p = 0; y < height; ++y)
        for (let x = 0; x < width; ++x, ++p) {
          const west = x > 0, east = x < width - 1, north = y > 0, south = y < height - 1;
          const share = jacobiDamping / (west + east + north + south + asked[4 * p + 3]);
          for (let c = 0, i = 3 * p; c < 3; ++c, ++i)
            next[i] = (1 - jacobiDamping) * levels[i] + share * (asked[4 * p + c] +
              (west ? levels[i - 3] : 0) + (east ? levels[i + 3] : 0) + (north ? levels[i - row] : 0) + (south ? levels[i + row] : 0));
        }
      [grid.levels, grid.next] = [next, levels];
    }
  }
  residual(k, right) {
    const {width, height, levels, [right]: asked} = this.grids[k], row = 3 * width, coarse = this.grids[k + 1];
    const {residual, shown} = coarse;
    for (let i = 0; i < residual.length; ++i) residual[i] = (i & 3) === 3 ? shown[i] : 0;
    for (let y = 0, p = 0; y < height; ++y)
      for (let x = 0; x < width; ++x, ++p) {
        const west = x > 0, east = x < width - 1, north = y > 0, south = y < height - 1;
        const sum = west + east + north + south + asked[4 * p + 3], to = 4 * ((y >> 1) * coarse.width + (x >> 1));
        for (let c = 0, i = 3 * p; c < 3; ++c, ++i)
          residual[to + c] += asked[4 * p + c] - sum * levels[i] +
            (west ? levels[i - 3] : 0) + (east ? levels[i + 3] : 0) + (north ? levels[i - row] : 0) + (south ? levels[i + row] : 0);
      }
  }
  lost() {}
}
