// A raised track in space, drawn by WebGL: the track as a band, its supports, the carts as boxes.

const VERTEX = `
attribute vec3 place;
attribute vec4 colour;
uniform mat4 view;
varying vec4 shade;
void main() {
  gl_Position = view * vec4(place, 1.0);
  shade = colour;
}`;

const FRAGMENT = `
precision mediump float;
varying vec4 shade;
void main() { gl_FragColor = vec4(shade.rgb * shade.a, shade.a); }`;

/** How long the lens is: half the width of the picture at distance 1 is one over it. */
const LENS = 3.5;

/** Product of matrices by columns. */
function times(a, b) {
  const out = new Float32Array(16);
  for (let c = 0; c < 4; c++) for (let r = 0; r < 4; r++) for (let k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
  return out;
}

/** A colour of the style sheet from 0 to 1. */
function parts(name, opacity = 1) {
  const text = colour(name);
  return [...[1, 3, 5].map(k => parseInt(text.slice(k, k + 2), 16) / 255), opacity];
}

class SpaceView extends HandView {
  constructor(line, link) {
    super(line, link, "the track in space");
    this.gl = this.canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
    this.turn = -0.9;
    this.lift = 0.6;
    this.near = 1;
    this.shift = [0, 0];
    this.exaggerated = 1;
    if (this.gl) {
      this.build();
      this.byHand();
    }
  }

  build() {
    const gl = this.gl;
    const shader = (kind, text) => {
      const made = gl.createShader(kind);
      gl.shaderSource(made, text);
      gl.compileShader(made);
      return made;
    };
    this.program = gl.createProgram();
    gl.attachShader(this.program, shader(gl.VERTEX_SHADER, VERTEX));
    gl.attachShader(this.program, shader(gl.FRAGMENT_SHADER, FRAGMENT));
    gl.linkProgram(this.program);
    this.buffer = gl.createBuffer();
    this.places = ["place", "colour"].map(name => gl.getAttribLocation(this.program, name));
    this.matrix = gl.getUniformLocation(this.program, "view");
  }

  fit(width, height) {
    const ratio = devicePixelRatio || 1;
    [this.width, this.height] = [width, height];
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.canvas.style.height = height + "px";
    if (!this.far) this.whole();
  }

  /** From the hall to the screen. */
  camera() {
    const { low, high } = this.line;
    const size = Math.hypot(high[0] - low[0], high[1] - low[1]);
    const [ct, st, cl, sl] = [Math.cos(this.turn), Math.sin(this.turn), Math.cos(this.lift), Math.sin(this.lift)];
    // Columns: what the hall's x, y and z are to the right, upwards and towards the reader.
    const turned = [ct, st * sl, -st * cl, 0, -st, ct * sl, -ct * cl, 0, 0, cl, sl, 0, 0, 0, 0, 1];
    const aspect = this.width / this.height;
    const [across, up] = aspect > 1 ? [LENS / aspect, LENS] : [LENS, LENS * aspect];
    const far = this.far / this.near;
    const middle = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, 0, 1];
    const away = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, this.shift[0], this.shift[1], -far, 1];
    const [front, back] = [0.02 * far, far + 2 * size];
    const lens = [across, 0, 0, 0, 0, up, 0, 0, 0, 0, (back + front) / (front - back), -1, 0, 0, (2 * back * front) / (front - back), 0];
    return times(lens, times(away, times(turned, middle)));
  }

  place(s) {
    const [x, y, z] = this.line.at(s);
    return [x, y, z * this.exaggerated];
  }

  /** Pixels of a place in the hall. */
  pixel(view, [x, y, z]) {
    const of = r => view[r] * x + view[4 + r] * y + view[8 + r] * z + view[12 + r];
    const w = of(3);
    return [(0.5 + (0.5 * of(0)) / w) * this.width, (0.5 - (0.5 * of(1)) / w) * this.height];
  }

  nearest(px, py, within = 40) {
    const view = this.camera();
    let [best, found] = [within * within, null];
    for (let k = 0; k < this.line.count; k++) {
      const [u, v] = this.pixel(view, this.place(k * this.line.step));
      const far = (u - px) ** 2 + (v - py) ** 2;
      if (far < best) [best, found] = [far, k * this.line.step];
    }
    return found;
  }

  /** As near as the whole track is seen, in the middle. */
  whole() {
    const { low, high } = this.line;
    [this.near, this.shift] = [1, [0, 0]];
    this.far = 3 * Math.hypot(high[0] - low[0], high[1] - low[1]);
    for (let round = 0; round < 12; round++) {
      const view = this.camera();
      let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
      for (let k = 0; k < this.line.count; k += 4) {
        const [x, y] = this.pixel(view, this.place(k * this.line.step));
        [left, top, right, bottom] = [Math.min(left, x), Math.min(top, y), Math.max(right, x), Math.max(bottom, y)];
      }
      const pixel = (2 * this.far) / LENS / Math.min(this.width, this.height);
      this.shift = [this.shift[0] + ((this.width - left - right) / 2) * pixel, this.shift[1] - ((this.height - top - bottom) / 2) * pixel];
      this.far *= Math.max((right - left) / (this.width - 70), (bottom - top) / (this.height - 70));
    }
  }

  zoom(factor) {
    this.near = Math.min(Math.max(this.near * factor, 0.5), 40);
    this.redraw();
  }

  centre() {}

  dragged(dx, dy, shift) {
    if (shift) {
      const { low, high } = this.line;
      const metre = (0.7 * Math.hypot(high[0] - low[0], high[1] - low[1])) / this.near / this.height;
      this.shift = [this.shift[0] + dx * metre, this.shift[1] - dy * metre];
    } else {
      this.turn += 0.008 * dx;
      this.lift = Math.min(Math.max(this.lift + 0.008 * dy, 0.03), 1.57);
    }
  }

  draw() {
    const gl = this.gl;
    if (!gl || !this.width) return;
    const floor = [];
    const solid = [];
    this.floor(floor);
    this.band(solid);
    if (this.carts && this.carts.shown) this.boxes(solid);
    if (this.link.value !== null) this.pin(solid);
    const values = new Float32Array(floor.concat(solid));
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.program);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
    [[3, 0], [4, 12]].forEach(([size, from], k) => {
      gl.enableVertexAttribArray(this.places[k]);
      gl.vertexAttribPointer(this.places[k], size, gl.FLOAT, false, 28, from);
    });
    gl.uniformMatrix4fv(this.matrix, false, this.camera());
    gl.disable(gl.DEPTH_TEST);
    gl.drawArrays(gl.TRIANGLES, 0, floor.length / 7);
    gl.enable(gl.DEPTH_TEST);
    gl.drawArrays(gl.TRIANGLES, floor.length / 7, solid.length / 7);
    this.vertices = values.length / 7;
  }

  /** Two triangles of four corners that go around. */
  quad(out, a, b, c, d, shade) {
    for (const p of [a, b, c, a, c, d]) out.push(...p, ...shade);
  }

  /** To the left of the track, level: x and y of length 1. */
  left(s) {
    const [a, b] = [this.line.at(s - 0.1), this.line.at(s + 0.1)];
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    return [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
  }

  /** The shade of the track on the floor, and lines every 10 m. */
  floor(out) {
    const { low, high } = this.line;
    const line = parts("line", 0.8);
    const thin = 0.03;
    for (let x = Math.floor(low[0] / 10) * 10; x <= high[0] + 10; x += 10) this.quad(out, [x - thin, low[1] - 5, 0], [x + thin, low[1] - 5, 0], [x + thin, high[1] + 5, 0], [x - thin, high[1] + 5, 0], line);
    for (let y = Math.floor(low[1] / 10) * 10; y <= high[1] + 10; y += 10) this.quad(out, [low[0] - 5, y - thin, 0], [low[0] - 5, y + thin, 0], [high[0] + 5, y + thin, 0], [high[0] + 5, y - thin, 0], line);
    this.ribbon(out, () => parts("soft", 0.25), s => [...this.line.at(s).slice(0, 2), 0], 0.3);
  }

  ribbon(out, shade, place, half) {
    const lap = this.line.plan.lap_m;
    const count = Math.min(this.line.count, 1200);
    const edge = s => {
      const [x, y, z] = place(s);
      const [u, v] = this.left(s);
      return [[x + half * u, y + half * v, z], [x - half * u, y - half * v, z]];
    };
    let before = edge(0);
    for (let k = 1; k <= count; k++) {
      const after = edge((lap * k) / count);
      this.quad(out, before[0], before[1], after[1], after[0], shade((lap * (k - 0.5)) / count));
      before = after;
    }
  }

  band(out) {
    const { layer } = this;
    const bare = parts("soft", 1);
    const of = s => {
      if (!layer) return bare;
      const [r, g, b, a] = layer.colour(layer.value(s));
      return [r / 255, g / 255, b / 255, Math.max(a, 0.3)];
    };
    this.ribbon(out, of, s => this.place(s), 0.35);
    // Legs down to the floor.
    const lap = this.line.plan.lap_m;
    const leg = parts("soft", 0.6);
    for (let s = 0; s < lap; s += 5) {
      const [x, y, z] = this.place(s);
      if (z < 0.3) continue;
      const [u, v] = this.left(s);
      this.quad(out, [x + 0.04 * u, y + 0.04 * v, 0], [x - 0.04 * u, y - 0.04 * v, 0], [x - 0.04 * u, y - 0.04 * v, z], [x + 0.04 * u, y + 0.04 * v, z], leg);
      this.quad(out, [x + 0.04 * v, y - 0.04 * u, 0], [x - 0.04 * v, y + 0.04 * u, 0], [x - 0.04 * v, y + 0.04 * u, z], [x + 0.04 * v, y - 0.04 * u, z], leg);
    }
  }

  /** A box on the track from a joint to the one behind it. */
  box(out, a, b, half, tall, shade) {
    const along = [a[0] - b[0], a[1] - b[1]];
    const length = Math.hypot(...along) || 1;
    const [u, v] = [(-along[1] / length) * half, (along[0] / length) * half];
    const corner = (p, side, up) => [p[0] + side * u, p[1] + side * v, p[2] + up];
    const [lift, top] = [0.08, 0.08 + tall];
    const face = (points, light) => this.quad(out, ...points, [...shade.slice(0, 3).map(x => x * light), shade[3]]);
    face([corner(a, 1, top), corner(a, -1, top), corner(b, -1, top), corner(b, 1, top)], 1);
    face([corner(a, 1, lift), corner(a, 1, top), corner(b, 1, top), corner(b, 1, lift)], 0.72);
    face([corner(a, -1, lift), corner(a, -1, top), corner(b, -1, top), corner(b, -1, lift)], 0.72);
    face([corner(a, 1, lift), corner(a, 1, top), corner(a, -1, top), corner(a, -1, lift)], 0.55);
    face([corner(b, 1, lift), corner(b, 1, top), corner(b, -1, top), corner(b, -1, lift)], 0.55);
  }

  boxes(out) {
    const { places, pitch, sensor } = this.carts;
    const lap = this.line.plan.lap_m;
    const own = parts("cursor", 1);
    places.forEach((s, k) => {
      const [a, b] = [this.place(s - 0.06 * pitch), this.place(s - 0.94 * pitch)];
      const [r, g, b1, o] = this.layer ? this.layer.colour(this.layer.value(((s % lap) + lap) % lap)) : [128, 128, 128, 1];
      this.box(out, a, b, 0.32 * pitch, 0.25, [r / 255, g / 255, b1 / 255, Math.max(o, 0.4)]);
      if (k === sensor) this.box(out, this.place(s - 0.4 * pitch), this.place(s - 0.6 * pitch), 0.1 * pitch, 0.9, own);
    });
  }

  /** A pin at the cursor. */
  pin(out) {
    const [x, y, z] = this.place(this.link.value);
    const size = 0.012 * Math.hypot(this.line.high[0] - this.line.low[0], this.line.high[1] - this.line.low[1]);
    const shade = parts("cursor", 1);
    this.box(out, [x + 0.15 * size, y, z], [x - 0.15 * size, y, z], 0.15 * size, 3 * size, shade);
    this.box(out, [x + size / 2, y, z + 3 * size], [x - size / 2, y, z + 3 * size], size / 2, size, shade);
  }
}
