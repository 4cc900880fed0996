// The track from above: coloured by what was measured, with the common cursor. It zooms and moves like the curves.

/** Where the centre line is at an arc length, and its heading: x, y, z in m, rad. */
class CentreLine {
  constructor(plan) {
    this.plan = plan;
    this.count = plan.x.length;
    this.step = plan.lap_m / this.count;
    this.raised = plan.z.length > 0;
    this.low = [Math.min(...plan.x), Math.min(...plan.y)];
    this.high = [Math.max(...plan.x), Math.max(...plan.y)];
  }

  at(s) {
    const lap = this.plan.lap_m;
    const place = (((s % lap) + lap) % lap) / this.step;
    const k = Math.floor(place) % this.count;
    const [next, share] = [(k + 1) % this.count, place - Math.floor(place)];
    const of = values => values[k] + (values[next] - values[k]) * share;
    const { x, y, z } = this.plan;
    return [of(x), of(y), this.raised ? of(z) : 0];
  }

  part(s) {
    return this.plan.parts.find(part => part.from <= s && s < part.to);
  }
}

/** Which of the values measured on a stretch stands for it. */
const KINDS = {
  peak: { of: cells => cells.flatMap(c => [c.low, c.high]).reduce((a, b) => (Math.abs(b) > Math.abs(a) ? b : a)), says: "largest by absolute value" },
  largest: { of: cells => Math.max(...cells.map(c => c.high)), says: "largest value" },
  least: { of: cells => Math.min(...cells.map(c => c.low)), says: "least value" },
  mean: { of: cells => cells.reduce((sum, c) => sum + c.mean, 0) / cells.length, says: "mean value" },
};

const PIECES = 400;

/** Values of the plan's layer, with the colours that they have. */
class Layer {
  constructor(spec, lap) {
    this.spec = spec;
    this.lap = lap;
    this.amount = Boolean(spec.amounts);
    this.kind = "peak";
    const known = values => values.filter(v => v !== null);
    if (this.amount) {
      this.values = spec.amounts;
      [this.low, this.high] = [0, Math.max(...known(this.values), 1e-12)];
    } else {
      this.plot = data.plots.find(plot => plot.id === spec.plot);
      this.gather();
    }
  }

  /** Of a plot's cells: over half a cart to either side, so that the passing of carts makes no pattern. */
  gather() {
    const [band, line] = this.plot.curves;
    const count = this.plot.x.length;
    const reach = Math.max(1, Math.round(((data.replay ? data.replay.pitch_m : 1) / this.lap) * count / 2));
    const kind = KINDS[this.kind].of;
    this.values = Array.from({ length: PIECES }, (_, k) => {
      const middle = Math.floor(((k + 0.5) / PIECES) * count);
      const cells = [];
      for (let j = middle - reach; j <= middle + reach; j++) {
        const at = (j + count) % count;
        if (line.y[at] !== null) cells.push({ low: band.low[at], high: band.high[at], mean: line.y[at] });
      }
      return cells.length ? kind(cells) : null;
    });
    const known = this.values.filter(v => v !== null);
    [this.low, this.high] = [Math.min(...known), Math.max(...known)];
  }

  value(s) {
    return this.values[Math.min(Math.floor((s / this.lap) * this.values.length), this.values.length - 1)];
  }

  /** From 0 to 1; null where nothing is known. */
  share(value) {
    if (value === null || value === undefined) return null;
    return this.high > this.low ? (value - this.low) / (this.high - this.low) : 0.5;
  }

  /** Red, green, blue and opacity. */
  colour(value) {
    const share = this.share(value);
    if (share === null) return [128, 128, 128, 0.25];
    if (this.amount) return [...gapColour(), Math.sqrt(Math.max(share, 0))];
    return [...viridis(share), 1];
  }
}

/** The colour of what is off, as numbers. */
function gapColour() {
  const text = colour("gap");
  return [1, 3, 5].map(k => parseInt(text.slice(k, k + 2), 16));
}

const css = ([r, g, b, a]) => `rgba(${r}, ${g}, ${b}, ${a})`;

/**
 * What a view of the track does by hand: hovering and clicking move the cursor, dragging and Ctrl with the wheel the view, a
 * double click brings the whole back. A view has `nearest`, `dragged`, `zoom`, `whole` and `draw`.
 */
class HandView {
  constructor(line, link, label) {
    this.line = line;
    this.link = link;
    this.carts = null;
    this.canvas = element("canvas", { class: "plan-canvas", tabindex: "0", role: "img", "aria-label": label });
  }

  byHand() {
    const canvas = this.canvas;
    canvas.style.touchAction = "pan-y";
    let held = null;
    canvas.addEventListener("pointerdown", event => {
      held = { x: event.clientX, y: event.clientY, far: false };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", event => {
      if (!held) {
        const s = this.nearest(event.offsetX, event.offsetY, 18);
        canvas.style.cursor = s === null ? "grab" : "crosshair";
        if (s !== null && !this.playing()) this.link.set(s);
        return;
      }
      const [dx, dy] = [event.clientX - held.x, event.clientY - held.y];
      if (!held.far && Math.hypot(dx, dy) < 4) return;
      held = { x: event.clientX, y: event.clientY, far: true };
      this.dragged(dx, dy, event.shiftKey);
      this.redraw();
    });
    canvas.addEventListener("pointerup", event => {
      if (held && !held.far) {
        const s = this.nearest(event.offsetX, event.offsetY);
        if (s !== null) this.picked(s);
      }
      held = null;
    });
    canvas.addEventListener("dblclick", () => {
      this.whole();
      this.redraw();
    });
    canvas.addEventListener("wheel", event => {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      this.zoom(Math.exp(-0.002 * event.deltaY), event.offsetX, event.offsetY);
    }, { passive: false });
  }

  playing() {
    return false;
  }

  /** A place was clicked. */
  picked(s) {
    this.link.set(s);
  }

  /** Draws anew with the next picture. */
  redraw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.draw();
    });
  }
}

class PlanView extends HandView {
  constructor(line, link) {
    super(line, link, "the track from above");
    this.spec = line.plan;
    this.view = null;
    this.byHand();
  }

  /** Pixels of a place in the hall. */
  at([x, y]) {
    const { scale, left, top } = this.view;
    return [left + x * scale, top - y * scale];
  }

  /** Fits the track into the canvas; a view by hand stays. */
  fit(width, height) {
    const ratio = devicePixelRatio || 1;
    [this.width, this.height, this.ratio] = [width, height, ratio];
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.canvas.style.height = height + "px";
    if (!this.moved) this.whole();
  }

  whole() {
    const { low, high } = this.line;
    const margin = 34;
    const scale = Math.min((this.width - 2 * margin) / Math.max(high[0] - low[0], 1e-3), (this.height - 2 * margin) / Math.max(high[1] - low[1], 1e-3));
    this.moved = false;
    this.view = {
      scale,
      left: this.width / 2 - (scale * (low[0] + high[0])) / 2,
      top: this.height / 2 + (scale * (low[1] + high[1])) / 2,
    };
    this.least = scale;
  }

  /** By a factor about a pixel. */
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const scale = Math.min(Math.max(this.view.scale * factor, this.least), this.least * 60);
    const change = scale / this.view.scale;
    this.view = { scale, left: px - (px - this.view.left) * change, top: py - (py - this.view.top) * change };
    this.moved = true;
    if (scale === this.least) this.whole();
    this.redraw();
  }

  dragged(dx, dy) {
    this.view.left += dx;
    this.view.top += dy;
    this.moved = true;
  }

  /** Brings an arc length to the middle. */
  centre(s) {
    const [x, y] = this.at(this.line.at(s));
    this.view.left += this.width / 2 - x;
    this.view.top += this.height / 2 - y;
    this.moved = true;
  }

  /** The arc length nearest to a pixel; null where the track is far. */
  nearest(px, py, within = 40) {
    let [best, found] = [within * within, null];
    const { x, y } = this.spec;
    for (let k = 0; k < this.line.count; k++) {
      const [u, v] = this.at([x[k], y[k]]);
      const far = (u - px) ** 2 + (v - py) ** 2;
      if (far < best) [best, found] = [far, k * this.line.step];
    }
    return found;
  }

  path(ctx, from, to) {
    const steps = Math.max(1, Math.ceil((to - from) / this.line.step));
    ctx.beginPath();
    for (let k = 0; k <= steps; k++) ctx.lineTo(...this.at(this.line.at(from + ((to - from) * k) / steps)));
  }

  draw() {
    if (!this.view) return;
    const ctx = this.canvas.getContext("2d");
    ctx.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    ctx.clearRect(0, 0, this.width, this.height);
    ctx.lineJoin = "round";
    const lap = this.spec.lap_m;
    const metre = this.view.scale;
    const thick = Math.min(Math.max(7, 0.5 * metre), 40);
    ctx.lineWidth = thick;
    ctx.strokeStyle = colour("band");
    this.path(ctx, 0, lap);
    ctx.stroke();
    this.colours(ctx, thick);
    if (this.link.range) this.stretch(ctx, thick);
    this.motors(ctx, thick);
    this.start(ctx, thick);
    if (this.carts) this.draws(ctx, metre);
    this.spots(ctx, thick);
    if (this.link.value !== null) this.dot(ctx);
    this.ruler(ctx, metre);
  }

  colours(ctx, thick) {
    const { layer } = this;
    if (!layer) return;
    const count = layer.values.length;
    const piece = this.spec.lap_m / count;
    ctx.save();
    ctx.lineWidth = this.carts && this.carts.shown ? Math.max(2, 0.3 * thick) : thick;
    for (let k = 0, next = 0; k < count; k = next) {
      const paint = css(layer.colour(layer.values[k]));
      // Neighbours of one colour are one stroke. A little over the end where it covers, so that no seam shows.
      for (next = k + 1; next < count && css(layer.colour(layer.values[next])) === paint; ) next++;
      ctx.strokeStyle = paint;
      this.path(ctx, k * piece, (next + (layer.amount ? 0 : 0.03)) * piece);
      ctx.stroke();
    }
    ctx.restore();
  }

  /** What the curves show. */
  stretch(ctx, thick) {
    ctx.save();
    const [from, to] = this.link.range;
    ctx.strokeStyle = faded("ink", 0.25);
    ctx.lineWidth = thick + 10;
    this.path(ctx, from, to);
    ctx.stroke();
    ctx.restore();
  }

  /** A line beside the track, on its right. */
  motors(ctx, thick) {
    ctx.save();
    ctx.strokeStyle = colour("motor");
    ctx.lineWidth = 3;
    const away = thick / 2 + 4;
    for (const [from, to] of this.spec.motors) {
      ctx.beginPath();
      for (let k = 0; k <= 8; k++) ctx.lineTo(...this.beside(from + ((to - from) * k) / 8, away));
      ctx.stroke();
    }
    ctx.restore();
  }

  /** A pixel so many pixels to the right of the track, seen in driving direction. */
  beside(s, away) {
    const [a, b] = [this.at(this.line.at(s - 0.1)), this.at(this.line.at(s + 0.1))];
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const length = Math.hypot(dx, dy) || 1;
    return [(a[0] + b[0]) / 2 - (dy / length) * away, (a[1] + b[1]) / 2 + (dx / length) * away];
  }

  /** The way that a number goes beside the track: away from the middle. */
  outward(s, away, inward = false) {
    const { low, high } = this.line;
    const middle = this.at([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2]);
    const sides = [this.beside(s, away), this.beside(s, -away)];
    const far = ([x, y]) => Math.hypot(x - middle[0], y - middle[1]);
    return far(sides[0]) >= far(sides[1]) !== inward ? sides[0] : sides[1];
  }

  start(ctx, thick) {
    const [a, b] = [this.beside(0, thick / 2 + 5), this.beside(0, -thick / 2 - 5)];
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = colour("soft");
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(...a);
    ctx.lineTo(...b);
    ctx.stroke();
    // The way that the chain runs.
    const [tail, tip] = [this.at(this.line.at(0)), this.at(this.line.at(20 / this.view.scale))];
    const side = this.outward(0, thick / 2 + 14);
    const base = this.at(this.line.at(0));
    const shift = [side[0] - base[0], side[1] - base[1]];
    const heading = Math.atan2(tip[1] - tail[1], tip[0] - tail[0]);
    ctx.translate(tail[0] + shift[0], tail[1] + shift[1]);
    ctx.save();
    ctx.rotate(heading);
    ctx.beginPath();
    ctx.moveTo(0, 0);
    ctx.lineTo(18, 0);
    ctx.moveTo(12, -4);
    ctx.lineTo(18, 0);
    ctx.lineTo(12, 4);
    ctx.stroke();
    ctx.restore();
    ctx.restore();
  }

  /** The carts: a box from each front joint to the next behind it. */
  draws(ctx, metre) {
    const { places, pitch, sensor, shown } = this.carts;
    if (!shown) return;
    ctx.save();
    const wide = Math.min(Math.max(0.55 * pitch * metre, 4), 60);
    for (let k = 0; k < places.length; k++) {
      const a = this.at(this.line.at(places[k]));
      const b = this.at(this.line.at(places[k] - pitch));
      const [dx, dy] = [a[0] - b[0], a[1] - b[1]];
      const length = Math.hypot(dx, dy);
      const own = k === sensor;
      ctx.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      ctx.translate((a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
      ctx.rotate(Math.atan2(dy, dx));
      ctx.fillStyle = this.layer ? css(this.layer.colour(this.layer.value(this.wrap(places[k])))) : colour("trace");
      ctx.fillRect(-0.42 * length, -wide / 2, 0.84 * length, wide);
      ctx.lineWidth = own ? 2 : 0.7;
      ctx.strokeStyle = own ? colour("ink") : faded("ink", 0.45);
      const room = own ? 2 : 0;
      ctx.strokeRect(-0.42 * length - room, -wide / 2 - room, 0.84 * length + 2 * room, wide + 2 * room);
    }
    ctx.restore();
  }

  wrap(s) {
    const lap = this.spec.lap_m;
    return ((s % lap) + lap) % lap;
  }

  spots(ctx, thick) {
    ctx.save();
    ctx.textAlign = "center";
    ctx.textBaseline = "middle";
    ctx.font = "bold 11px system-ui, sans-serif";
    const taken = [];
    const inside = ([x, y]) => x > 9 && y > 9 && x < this.width - 9 && y < this.height - 9;
    const free = p => inside(p) && taken.every(q => Math.hypot(p[0] - q[0], p[1] - q[1]) >= 18);
    this.spec.spots.forEach((spot, k) => {
      // Numbers of one place stand beside each other.
      const away = thick / 2 + 14;
      const places = [away, -away, away + 19, -away - 19].flatMap(by => [0, 1, -1, 2, -2, 3, -3].map(n => this.outward(spot.s + (n * 19) / this.view.scale, Math.abs(by), by < 0)));
      const p = places.find(free) || places[0];
      taken.push(p);
      ctx.fillStyle = colour("ink");
      ctx.beginPath();
      ctx.arc(p[0], p[1], 8.5, 0, 2 * Math.PI);
      ctx.fill();
      ctx.fillStyle = colour("paper");
      ctx.fillText(String(k + 1), p[0], p[1] + 0.5);
    });
    ctx.restore();
  }

  dot(ctx) {
    const [x, y] = this.at(this.line.at(this.link.value));
    this.shownAt = [x, y];
    ctx.save();
    ctx.lineWidth = 5;
    ctx.strokeStyle = colour("paper");
    ctx.beginPath();
    ctx.arc(x, y, 8, 0, 2 * Math.PI);
    ctx.stroke();
    ctx.lineWidth = 2.5;
    ctx.strokeStyle = colour("cursor");
    ctx.stroke();
    ctx.restore();
  }

  ruler(ctx, metre) {
    const steps = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];
    const length = steps.find(step => step * metre >= 50) || 1000;
    const [x, y] = [12, this.height - 10];
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = colour("soft");
    ctx.font = FONT;
    ctx.lineWidth = 1;
    ctx.beginPath();
    ctx.moveTo(x, y - 4);
    ctx.lineTo(x, y);
    ctx.lineTo(x + length * metre, y);
    ctx.lineTo(x + length * metre, y - 4);
    ctx.stroke();
    ctx.fillText(`${length} m`, x + length * metre + 6, y);
    ctx.restore();
  }
}
