// The fill of fill.js on the graphics processor: each grid is a texture, each step a draw.

const fragmentHead = `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D first, second;
uniform ivec2 size, other;  // of the grid that is drawn, of the other one
out vec4 result;
ivec2 at() { return ivec2(gl_FragCoord.xy); }
`;
const neighbours = `
vec3 sum = vec3(0.0);
float count = 0.0;
void visit(ivec2 p, ivec2 grid) {
  sum = vec3(0.0);
  count = 0.0;
  if (p.x > 0) { sum += texelFetch(first, p - ivec2(1, 0), 0).rgb; count += 1.0; }
  if (p.x < grid.x - 1) { sum += texelFetch(first, p + ivec2(1, 0), 0).rgb; count += 1.0; }
  if (p.y > 0) { sum += texelFetch(first, p - ivec2(0, 1), 0).rgb; count += 1.0; }
  if (p.y < grid.y - 1) { sum += texelFetch(first, p + ivec2(0, 1), 0).rgb; count += 1.0; }
}
`;
const shaders = {
  hold: `void main() {
    vec4 pixel = round(255.0 * texelFetch(first, at(), 0));
    float held = pixel.a > 254.5 ? ${heldWhole.toFixed(1)} : ${heldHalf} * pixel.a / (255.0 - pixel.a);
    result = vec4(held * pixel.rgb, held);
  }`,
  coarsen: `void main() {
    result = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
      ivec2 from = 2 * at() + ivec2(i & 1, i >> 1);
      if (from.x < other.x && from.y < other.y) result += texelFetch(first, from, 0);
    }
  }`,
  solve: `uniform float empty;
  void main() {
    vec4 asked = texelFetch(first, at(), 0);
    result = vec4(asked.a > 0.0 ? asked.rgb / asked.a : vec3(empty), 1.0);
  }`,
  // the levels of `second`, if any, and what the coarser grid adds
  correct: `uniform float kept;
  void main() {
    ivec2 near = at() / 2, far = clamp(near + 2 * (at() & 1) - 1, ivec2(0), other - 1);
    result = kept * texelFetch(second, at(), 0) +
      0.5625 * texelFetch(first, near, 0) + 0.1875 * texelFetch(first, ivec2(far.x, near.y), 0) +
      0.1875 * texelFetch(first, ivec2(near.x, far.y), 0) + 0.0625 * texelFetch(first, far, 0);
  }`,
  smooth: `${neighbours}void main() {
    vec4 asked = texelFetch(second, at(), 0);
    visit(at(), size);
    result = vec4(mix(texelFetch(first, at(), 0).rgb, (asked.rgb + sum) / (count + asked.a), ${jacobiDamping}), 1.0);
  }`,
  residual: `${neighbours}void main() {
    result = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
      ivec2 from = 2 * at() + ivec2(i & 1, i >> 1);
      if (from.x >= other.x || from.y >= other.y) continue;
      vec4 asked = texelFetch(second, from, 0);
      visit(from, other);
      result += vec4(asked.rgb + sum - (count + asked.a) * texelFetch(first, from, 0).rgb, asked.a);
    }
  }`,
  show: `void main() {
    ivec2 p = ivec2(at().x, size.y - 1 - at().y);
    vec4 still = texelFetch(second, p, 0);
    vec3 level = mix(texelFetch(first, p, 0).rgb, 255.0 * still.rgb, still.a);
    result = vec4(floor(clamp(level, 0.0, 255.0) + 0.5) / 255.0, 1.0);
  }`,
};

/** The program of a step and the places of its numbers; null where it cannot be compiled. */
function stepProgram(gl, source) {
  const program = linkedProgram(gl, fragmentHead + source);
  if (!program) return null;
  const names = ["first", "second", "size", "other", "empty", "kept"];
  return {program, places: Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(program, name)]))};
}

/** null where WebGL 2 with textures of floats is missing, or smaller than the frame. */
function makeGraphicsFill({width, height, empty}) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const gl = canvas.getContext("webgl2", {alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true});
  if (!gl || !gl.getExtension("EXT_color_buffer_float") || Math.max(width, height) > gl.getParameter(gl.MAX_TEXTURE_SIZE)) return null;
  const programs = Object.fromEntries(Object.entries(shaders).map(([name, source]) => [name, stepProgram(gl, source)]));
  if (Object.values(programs).includes(null)) return null;
  const texture = (format, w, h) => {
    const made = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, w, h);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    return made;
  };
  const target = (w, h) => {
    const image = texture(gl.RGBA32F, w, h), frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, image, 0);
    return {image, frame};
  };
  const grids = gridSizes(width, height).map(([w, h]) => ({
    size: [w, h], shown: target(w, h), residual: target(w, h), levels: target(w, h), next: target(w, h),
  }));
  if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE || gl.getError() !== gl.NO_ERROR) return null;
  const input = texture(gl.RGBA8, width, height), behind = texture(gl.RGBA8, width, height);
  gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
  const put = (image, bytes) => {
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, image);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  };
  /** Draws one step into `to` (null: the canvas) from one or two images; numbers: of the step. */
  const run = (name, to, size, first, second = first, other = size, numbers = {}) => {
    const {program, places} = programs[name];
    gl.useProgram(program);
    gl.bindFramebuffer(gl.FRAMEBUFFER, to ? to.frame : null);
    gl.viewport(0, 0, ...size);
    [first, second].forEach((image, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, image);
    });
    gl.uniform1i(places.first, 0);
    gl.uniform1i(places.second, 1);
    gl.uniform2i(places.size, ...size);
    gl.uniform2i(places.other, ...other);
    for (const [number, value] of Object.entries(numbers)) gl.uniform1f(places[number], value);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  };
  const turn = (grid) => { [grid.levels, grid.next] = [grid.next, grid.levels]; };
  /** Puts into grid k its levels times `kept` and what the coarser grid adds. */
  const add = (k, kept) => {
    run("correct", grids[k].next, grids[k].size, grids[k + 1].levels.image, grids[k].levels.image, grids[k + 1].size, {kept});
    turn(grids[k]);
  };
  const steps = {
    solve(right) {
      const last = grids[grids.length - 1];
      run("solve", last.levels, last.size, last[right].image, undefined, undefined, {empty: right === "shown" ? empty : 0});
    },
    clear(k) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, grids[k].levels.frame);
      gl.clear(gl.COLOR_BUFFER_BIT);
    },
    guess: (k) => add(k, 0),
    correct: (k) => add(k, 1),
    smooth(k, right, times) {
      for (; times > 0; --times) {
        run("smooth", grids[k].next, grids[k].size, grids[k].levels.image, grids[k][right].image);
        turn(grids[k]);
      }
    },
    residual(k, right) {
      run("residual", grids[k + 1].residual, grids[k + 1].size, grids[k].levels.image, grids[k][right].image, grids[k].size);
    },
  };
  let shown = null;  // the still pixels that `behind` holds
  return {
    name: "webgl2",
    draw(pixels, still, to) {
      put(input, new Uint8Array(pixels.buffer, pixels.byteOffset, pixels.length));
      if (still && still !== shown) put(behind, still.bytes);
      shown = still;
      run("hold", grids[0].shown, grids[0].size, input);
      for (let k = 1; k < grids.length; ++k)
        run("coarsen", grids[k].shown, grids[k].size, grids[k - 1].shown.image, undefined, grids[k - 1].size);
      multigrid(steps, grids.length);
      run("show", null, grids[0].size, grids[0].levels.image, behind);
      to.drawImage(canvas, 0, 0);
    },
    lost: (then) => canvas.addEventListener("webglcontextlost", then),
  };
}
