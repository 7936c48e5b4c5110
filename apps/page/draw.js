// Frames from states: mean + sum of components, on the graphics processor, or else here.

/** A texel holds four planes' bytes of one channel; the channels of four planes are layers behind each other. */
const fragmentSource = (fours, height, channels) => `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
uniform sampler2DArray layers;
uniform vec4 factors[${fours}];
uniform float offset;
out vec4 colour;
float part(ivec2 at, int i, int channel) {
  return dot(factors[i], texelFetch(layers, ivec3(at, ${channels} * i + channel), 0));
}
void main() {
  ivec2 at = ivec2(int(gl_FragCoord.x), ${height - 1} - int(gl_FragCoord.y));
  vec3 level = vec3(-offset);
  for (int i = 0; i < ${fours}; ++i)
    level += ${channels === 1 ? "vec3(part(at, i, 0))" : "vec3(part(at, i, 0), part(at, i, 1), part(at, i, 2))"};
  level = floor(clamp(level, 0.0, 255.0) + 0.5);
  colour = vec4(level / 255.0, 1.0);
}`;

/**
 * Images live in planes of 8 bits: one where a byte holds all values (plus 128), else two, the high one (plus 128) and
 * the low one. null where WebGL 2 is missing or too small for that.
 */
function makeGraphicsDrawer({width, height, channels, wide}) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const gl = canvas.getContext("webgl2", {alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true});
  if (!gl) return null;
  const count = wide.reduce((sum, two) => sum + (two ? 2 : 1), 0), fours = Math.ceil(count / 4);
  if (Math.max(width, height) > gl.getParameter(gl.MAX_TEXTURE_SIZE) || channels * fours > gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS) ||
      fours + 2 > gl.getParameter(gl.MAX_FRAGMENT_UNIFORM_VECTORS)) return null;
  const linked = linkedProgram(gl, fragmentSource(fours, height, channels));
  if (!linked) return null;
  gl.useProgram(linked);
  gl.bindTexture(gl.TEXTURE_2D_ARRAY, gl.createTexture());
  gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA8, width, height, channels * fours);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D_ARRAY, name, gl.NEAREST);
  const placeOf = (name) => gl.getUniformLocation(linked, name);
  gl.viewport(0, 0, width, height);
  if (gl.getError() !== gl.NO_ERROR) return null;

  const planes = [], texels = new Uint8Array(4 * width * height * channels), area = width * height;
  const upload = () => {
    gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, channels * Math.floor((planes.length - 1) / 4), width, height, channels,
      gl.RGBA, gl.UNSIGNED_BYTE, texels);
    texels.fill(0);
  };
  /** factor: what a step of its byte is worth in steps of the image; zero: the byte that is 0. */
  const put = (image, values, factor, zero, byteOf) => {
    const place = planes.length % 4;
    for (let c = 0; c < channels; ++c)
      for (let p = 0; p < area; ++p) texels[4 * (c * area + p) + place] = byteOf(values[p * channels + c]);
    planes.push({image, factor, zero});
    if (place === 3) upload();
  };
  const factorPlace = placeOf("factors"), offsetPlace = placeOf("offset");
  const factors = new Float32Array(4 * fours);
  const paint = (worth) => {
    let offset = 0;
    planes.forEach(({image, factor, zero}, i) => {
      factors[i] = 255 * factor * worth[image];  // a texel is its byte over 255
      offset += zero * factor * worth[image];
    });
    gl.uniform4fv(factorPlace, factors);
    gl.uniform1f(offsetPlace, offset);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  };
  return {
    name: "webgl2",
    addImage(image, values) {
      if (wide[image]) {
        put(image, values, 256, 128, (v) => (v >> 8) + 128);
        put(image, values, 1, 0, (v) => v & 255);
      } else {
        put(image, values, 1, 128, (v) => v + 128);
      }
      if (image === wide.length - 1 && planes.length % 4 !== 0) upload();
    },
    /** `worth`: levels of a step of each image. */
    draw(worth, to) {
      paint(worth);
      to.drawImage(canvas, 0, 0);
    },
    lost: (then) => canvas.addEventListener("webglcontextlost", then),
  };
}

function makePlainDrawer({width, height, channels}) {
  const images = [], levels = new Float32Array(width * height * channels), picture = new ImageData(width, height);
  picture.data.fill(255);
  const paint = (worth) => {
    levels.fill(0);
    images.forEach((values, i) => {
      const factor = worth[i];
      if (factor !== 0) for (let p = 0; p < levels.length; ++p) levels[p] += factor * values[p];
    });
    const step = channels === 1 ? 0 : 1;
    for (let p = 0, from = 0; p < picture.data.length; p += 4, from += channels) {
      picture.data[p] = levels[from];  // rounds and stays within 0 ... 255
      picture.data[p + 1] = levels[from + step];
      picture.data[p + 2] = levels[from + 2 * step];
    }
  };
  return {
    name: "processor",
    addImage(image, values) {
      images[image] = values;
    },
    draw(worth, to) {
      paint(worth);
      to.putImageData(picture, 0, 0);
    },
    lost() {},
  };
}
