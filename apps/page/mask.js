// Masks: where the edits show, as dytex::layer_opacity tells it (dytex/model/layers.hpp).

/** Squared distances to the nearest pixel that is 0, in px (Felzenszwalb & Huttenlocher 2012). At least one must be. */
function squaredDistances(levels, width, height) {
  const far = width + height, across = new Float64Array(width * height);
  for (let x = 0; x < width; ++x) {
    let down = far, up = far;
    for (let at = x; at < levels.length; at += width) across[at] = down = levels[at] === 0 ? 0 : Math.min(down + 1, far);
    for (let at = x + (height - 1) * width; at >= 0; at -= width) across[at] = up = Math.min(across[at], up + 1);
  }
  for (let at = 0; at < levels.length; at += width) lowerParabolas(across.subarray(at, at + width));
  return across;
}
/** Replaces d(x) by the least of d(k)^2 + (x - k)^2. */
function lowerParabolas(distances) {
  const heights = distances.map((d) => d * d), lowest = [0], begins = [-Infinity];
  const crossing = (k, x) => (heights[x] + x * x - heights[k] - k * k) / (2 * (x - k));
  for (let x = 1; x < heights.length; ++x) {
    while (crossing(lowest.at(-1), x) <= begins.at(-1)) {
      lowest.pop();
      begins.pop();
    }
    begins.push(crossing(lowest.at(-1), x));
    lowest.push(x);
  }
  for (let x = 0, i = 0; x < heights.length; ++x) {
    while (i + 1 < begins.length && begins[i + 1] <= x) ++i;
    distances[x] = heights[lowest[i]] + (x - lowest[i]) ** 2;
  }
}

/** A mask of the clip's size, 0 ... 255. */
class Mask {
  constructor(levels) {
    this.sides = [levels, levels.map((level) => 255 - level)];  // as it is, swapped
    this.distances = [null, null];
    this.last = {};
  }
  /** How much of the edits shows, 0 ... 1, at the settings; the same array as long as these are the same. */
  opacity({swap, feather}) {
    if (this.last.swap !== swap || this.last.feather !== feather)
      this.last = {swap, feather, opacity: this.feathered(swap, feather)};
    return this.last.opacity;
  }
  feathered(swap, feather) {
    const levels = this.sides[swap], opacity = Float32Array.from(levels, (level) => level / 255);
    if (feather === 0 || !levels.includes(0)) return opacity;
    const distances = this.distances[swap] ??= squaredDistances(levels, data.width, data.height);
    return opacity.map((whole, p) => {
      const s = Math.min(Math.sqrt(distances[p]) / (feather + 1), 1);
      return whole * s * s * (3 - 2 * s);
    });
  }
}

/** The mask that an image file holds, and the size that it had; what is transparent is black. */
async function openMask(file) {
  const reader = new FileReader(), image = new Image(), {width, height} = data;
  await new Promise((done) => {
    reader.onloadend = done;
    reader.readAsDataURL(file);
  });
  image.src = reader.result;
  await image.decode();
  const screen = new OffscreenCanvas(width, height).getContext("2d", {alpha: false, willReadFrequently: true});
  screen.imageSmoothingQuality = "high";
  screen.drawImage(image, 0, 0, width, height);
  const pixels = screen.getImageData(0, 0, width, height).data;
  // Luma in the whole numbers that the program's has.
  const levels = Uint8Array.from({length: width * height}, (_, p) =>
    (9798 * pixels[4 * p] + 19235 * pixels[4 * p + 1] + 3735 * pixels[4 * p + 2] + 16384) >> 15);
  return {mask: new Mask(levels), size: [image.naturalWidth, image.naturalHeight]};
}

/** Levels 0 ... white as a grey picture of the clip's size. */
function greyPicture(levels, white) {
  const picture = new ImageData(data.width, data.height), {data: bytes} = picture;
  for (let p = 0; p < levels.length; ++p) {
    bytes[4 * p] = bytes[4 * p + 1] = bytes[4 * p + 2] = 255 * levels[p] / white;
    bytes[4 * p + 3] = 255;
  }
  return picture;
}
