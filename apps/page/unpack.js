// What the page carries, taken apart again (apps/page/packed_text.hpp tells how it was put together).

async function inflated(text) {
  const binary = atob(text.trim()), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** The matrices of the page by their names. */
async function unpackNumbers(text, places) {
  const all = new Float64Array(await inflated(text));
  return Object.fromEntries(Object.entries(places).map(
    ([name, [at, rows, cols]]) => [name, matrix(rows, cols, all.slice(at, at + rows * cols))]));
}

/** Values of a plane from their differences to what the neighbours predict. */
function undoDifferences(bytes, at, plane, width) {
  const high = at + bytes.length / 2;
  for (let p = 0; p < plane.length; ++p) {
    const left = p % width === 0 ? 0 : plane[p - 1], upper = p < width ? 0 : plane[p - width];
    const corner = p < width || p % width === 0 ? 0 : plane[p - width - 1];
    const gradient = ((left + upper - corner) << 16) >> 16;
    const low = Math.min(left, upper), most = Math.max(left, upper);
    const predicted = gradient < low ? low : gradient > most ? most : gradient;
    const code = bytes[at + p] | (bytes[high + p] << 8);
    plane[p] = predicted + (code & 1 ? -((code + 1) >> 1) : code >> 1);
  }
}

/** An image of whole numbers: Int16Array, of colour red, green, blue for each pixel. */
async function unpackImage(text, width, height, channels) {
  const bytes = new Uint8Array(await inflated(text)), area = width * height;
  const planes = Array.from({length: channels}, (_, c) => {
    const plane = new Int16Array(area);  // 16 bits: sums wrap around as they did
    undoDifferences(bytes, c * area, plane, width);
    return plane;
  });
  if (channels === 1) return planes[0];
  const [lightness, orange, greenness] = planes, values = new Int16Array(3 * area);
  const wrap = (v) => (v << 16) >> 16;
  for (let p = 0; p < area; ++p) {
    const middle = wrap(lightness[p] - (greenness[p] >> 1)), blue = wrap(middle - (orange[p] >> 1));
    values[3 * p] = blue + orange[p];
    values[3 * p + 1] = greenness[p] + middle;
    values[3 * p + 2] = blue;
  }
  return values;
}
