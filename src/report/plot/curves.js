// Curves over an axis, drawn by uPlot: zoom, move, values at the cursor, curves on and off.

const FONT = "11px system-ui, sans-serif";
const WIDE = 8; // px at the right of every plot, so that those of one axis stand over each other
const LEFT = 58;

/** Round numbers between two, on a logarithmic axis whose numbers are logarithms. */
function decades(low, high, most) {
  const found = [];
  const inner = high - low < 1.6 ? [1, 2, 5] : [1];
  for (let k = Math.floor(low); k <= Math.ceil(high); k++) {
    for (const m of inner) {
      const at = k + Math.log10(m);
      if (at >= low && at <= high) found.push(at);
    }
  }
  const step = Math.ceil(found.length / most);
  return found.filter((_, k) => k % step === 0);
}

function short(value) {
  return String(Number(value.toPrecision(6))).replace("-", "−");
}

class Curves {
  constructor(spec, host) {
    this.spec = spec;
    this.host = host;
    this.link = linkOf(spec.axis);
    this.logX = spec.axis === "frequency";
    this.x = spec.x.map(x => (this.logX ? Math.log10(x) : x));
    this.whole = [this.x[0], this.x[this.x.length - 1]];
    if (spec.axis === "track" && data.plan) this.whole = [0, data.plan.lap_m];
    this.plot = null;
    this.legend = element("div", { class: "curve-legend" });
    this.canvas = element("div", { class: "curve-canvas", tabindex: "0", role: "img", "aria-label": "curves: " + spec.curves.map(c => c.name).join(", ") });
    host.replaceChildren(this.canvas, this.legend);
    this.entries = [];
    this.place = element("span", { class: "curve-at" });
    this.legend.append(this.place);
    this.others = [];
    spec.curves.forEach((curve, k) => this.entry(curve, k));
    this.link.members.push(this);
    repaints.push(() => this.repaint());
    new ResizeObserver(() => this.fit()).observe(this.canvas);
    // What is scrolled away has its cursor moved once it is back: a replay moves it at every frame.
    this.seen = true;
    new IntersectionObserver(([entry]) => {
      this.seen = entry.isIntersecting;
      if (this.seen) this.cursor(this.link.value);
    }).observe(host);
    this.canvas.addEventListener("keydown", event => this.key(event));
    this.fit();
  }

  entry(curve, k) {
    const swatch = element("i", { class: curve.dashed ? "dashed" : "dots" in curve ? "dots" : "low" in curve ? "area" : "", style: `--swatch: var(--${curve.colour})` });
    const value = element("span", { class: "curve-value" });
    const button = element("button", { type: "button", "aria-pressed": "true", "data-curve": curve.name }, swatch, curve.name + " ", value);
    button.addEventListener("click", () => this.toggle(k));
    this.legend.append(button);
    this.entries[k] = { button, value, shown: true };
    if (curve.hidden) this.toggle(k);
  }

  /** Series of a curve in uPlot, of which the first is x. */
  series(k) {
    const all = this.curves();
    let at = 1;
    for (let j = 0; j < k; j++) at += "low" in all[j] ? 2 : 1;
    return "low" in all[k] ? [at, at + 1] : [at];
  }

  /** The plot's own curves, and those of another page that are laid over them. */
  curves() {
    return this.spec.curves.concat(this.others);
  }

  toggle(k) {
    const entry = this.entries[k];
    entry.shown = !entry.shown;
    entry.button.setAttribute("aria-pressed", String(entry.shown));
    if (this.plot) this.series(k).forEach(at => this.plot.setSeries(at, { show: entry.shown }));
  }

  /** Lays curves of another page over these. */
  lay(curves) {
    this.entries.splice(this.spec.curves.length).forEach(entry => entry.button.remove());
    this.others = curves;
    curves.forEach((curve, k) => this.entry(curve, this.spec.curves.length + k));
    if (this.plot) {
      this.plot.destroy();
      this.plot = null;
    }
    this.fit();
  }

  fit() {
    const width = Math.floor(this.canvas.clientWidth);
    if (width < 50) return;
    if (!this.plot) this.draw(width);
    else if (this.plot.width !== width) this.plot.setSize({ width, height: this.spec.height });
  }

  repaint() {
    if (this.plot) this.plot.redraw(true, true);
  }

  draw(width) {
    const spec = this.spec;
    const mapped = y => (spec.logarithmic ? y.map(v => (v > 0 ? Math.log10(v) : null)) : y);
    const columns = [this.x];
    const series = [{}];
    const bands = [];
    this.curves().forEach((curve, k) => {
      const show = this.entries[k].shown;
      const one = { show, scale: "y", spanGaps: false, points: { show: false } };
      if ("low" in curve) {
        const at = columns.length;
        columns.push(mapped(curve.high), mapped(curve.low));
        const edge = { ...one, stroke: () => faded(curve.colour, 0.9), width: 0.5 };
        series.push(edge, { ...edge });
        bands.push({ series: [at, at + 1], fill: () => faded(curve.colour, 0.55) });
      } else if ("dots" in curve) {
        columns.push(mapped(curve.dots));
        series.push({ ...one, stroke: () => colour(curve.colour), width: 0, paths: () => null, points: { show: true, size: 7, fill: () => colour(curve.colour) } });
      } else {
        columns.push(mapped(curve.y));
        // A value between lost ones is no line, and is drawn as a point.
        series.push({ ...one, stroke: () => colour(curve.colour), width: 1.4, dash: curve.dashed ? [6, 4] : undefined });
      }
    });
    const label = (values, log) => values.map(v => (v === null ? "" : short(log ? 10 ** v : v)));
    // What would end beyond the paper is left out.
    const pad = Math.max(WIDE, spec.axis === "track" ? 0 : 3.2 * ((spec.x_unit ?? "").length + 4));
    const inside = (u, texts, values) => {
      const [{ min, max }, room] = [u.scales.x, u.width - LEFT - pad];
      return texts.map((text, k) => (((values[k] - min) / (max - min)) * room + 3 * text.length > room + pad ? "" : text));
    };
    const common = { stroke: () => colour("soft"), font: FONT, grid: { stroke: () => colour("line"), width: 1 }, ticks: { show: false } };
    const frame = {
      width,
      height: spec.height,
      legend: { show: false },
      // The last number on the axis is half beyond its place, and with a long unit farther than that.
      padding: [8, pad, 0, 0],
      scales: {
        x: { time: false },
        y: { range: (u, low, high) => this.room(low, high) },
      },
      axes: [
        {
          ...common,
          size: 26,
          gap: 4,
          splits: this.logX ? (u, i, low, high) => decades(low, high, width / 60) : undefined,
          values: (u, values) => inside(u, label(values, this.logX).map(t => (t && spec.x_unit ? t + " " + spec.x_unit : t)), values),
          grid: { show: false },
          space: Math.max(64, 6.4 * ((spec.x_unit ?? "").length + 6)),
        },
        {
          ...common,
          size: LEFT,
          gap: 6,
          splits: spec.logarithmic ? (u, i, low, high) => decades(low, high, 6) : undefined,
          values: (u, values) => label(values, spec.logarithmic),
          space: 26,
        },
      ],
      series,
      bands,
      cursor: {
        y: false,
        drag: { x: true, y: false, dist: 4 },
        points: { size: 6 },
        focus: { prox: -1 },
        bind: {
          mousedown: (u, target, handler) => event => (event.shiftKey ? this.move(event) : handler(event)),
          mouseleave: () => () => null,
          dblclick: () => () => { this.link.show(null); return null; },
        },
      },
      hooks: {
        drawClear: [u => this.behind(u)],
        draw: [u => this.marks(u)],
        setCursor: [u => { if (this.hovered && u.cursor.left >= 0) this.link.set(u.posToVal(u.cursor.left, "x")); }],
        setScale: [(u, key) => this.scaled(u, key)],
      },
    };
    this.plot = new uPlot(frame, columns, this.canvas);
    const over = this.plot.over;
    over.addEventListener("mouseenter", () => { this.hovered = true; });
    over.addEventListener("mouseleave", () => { this.hovered = false; });
    over.addEventListener("wheel", event => this.wheel(event), { passive: false });
    this.touches(over);
    this.stretch(this.link.range);
  }

  /** A margin above and below, and some height where all values are the same. */
  room(low, high) {
    if (low === null || high === null) return [0, 1];
    const room = high > low ? Math.max(0.05 * (high - low), 1e-6 * Math.abs(high)) : Math.max(0.02 * Math.abs(high), 1e-6);
    return [low - room, high + room];
  }

  behind(u) {
    const { ctx, bbox } = u;
    const rect = (from, to, style, top, height) => {
      const [a, b] = [u.valToPos(from, "x", true), u.valToPos(to, "x", true)].map(v => Math.min(Math.max(v, bbox.left), bbox.left + bbox.width));
      if (b > a) {
        ctx.fillStyle = style;
        ctx.fillRect(a, top, b - a, height);
      }
    };
    ctx.save();
    if (this.spec.axis === "track" && data.plan) {
      for (const part of data.plan.parts) if (part.kind) rect(part.from, part.to, colour(part.kind), bbox.top, bbox.height);
      const thick = 3 * devicePixelRatio;
      for (const [from, to] of data.plan.motors) rect(from, to, colour("motor"), bbox.top + bbox.height - thick, thick);
    }
    for (const shade of this.spec.shades || []) rect(shade.from, shade.to, faded(shade.colour, 0.3), bbox.top, bbox.height);
    ctx.restore();
  }

  marks(u) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.strokeStyle = ctx.fillStyle = colour("soft");
    const names = [];
    for (const mark of this.spec.marks || []) {
      const x = u.valToPos(this.logX ? Math.log10(mark.x) : mark.x, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      ctx.setLineDash((mark.dotted ? [1, 3] : [5, 3]).map(v => v * devicePixelRatio));
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      // To either side, as two marks may lie near each other.
      const side = mark.dotted ? 1 : -1;
      const [from, width] = [x + 3 * side * devicePixelRatio, ctx.measureText(mark.name).width];
      const [left, right] = [Math.min(from, from + side * width), Math.max(from, from + side * width)];
      let line = 0;
      while (names.some(own => own.line === line && own.left < right && left < own.right)) line += 1;
      names.push({ name: mark.name, line, left, right });
    }
    // Names stand over curves and the lines of the grid, on paper.
    ctx.textAlign = "left";
    for (const { name, line, left, right } of names) {
      const top = bbox.top + 13 * line * devicePixelRatio;
      ctx.fillStyle = colour("paper");
      ctx.fillRect(left - devicePixelRatio, top, right - left + 2 * devicePixelRatio, 13 * devicePixelRatio);
      ctx.fillStyle = colour("soft");
      ctx.fillText(name, left, top + 10 * devicePixelRatio);
    }
    ctx.restore();
  }

  /** A stretch was dragged over. */
  scaled(u, key) {
    if (key !== "x" || this.silent) return;
    const { min, max } = u.scales.x;
    const whole = min <= this.whole[0] && max >= this.whole[1];
    if (!whole) this.link.show([min, max]);
  }

  stretch(range) {
    if (!this.plot) return;
    const [min, max] = range || this.whole;
    this.silent = true;
    this.plot.batch(() => this.plot.setScale("x", { min, max }));
    this.silent = false;
    this.cursor(this.link.value);
  }

  cursor(value) {
    if (value === null || !this.seen) return;
    const at = this.nearest(value);
    this.curves().forEach((curve, k) => {
      const text = this.at(curve, at, this.spec.unit);
      this.entries[k].value.textContent = text;
    });
    // Where the values are, which between far points is not where the cursor is.
    const x = this.logX ? 10 ** this.x[at] : this.x[at];
    this.place.textContent = `${short(Number(x.toPrecision(5)))} ${this.spec.x_unit}`.trim();
    if (this.plot && !this.hovered) {
      const left = this.plot.valToPos(value, "x");
      const inside = left >= 0 && left <= this.plot.over.clientWidth;
      this.plot.setCursor({ left: inside ? left : -10, top: inside ? 1 : -10 }, false);
    }
  }

  at(curve, k, unit) {
    if ("low" in curve) return `${written(curve.low[k])} … ${written(curve.high[k], unit)}`;
    const value = (curve.y || curve.dots)[k];
    const name = value === null || !curve.named ? "" : `, ${curve.named[k]}`;
    return written(value, unit) + name;
  }

  nearest(value) {
    const x = this.x;
    let [low, high] = [0, x.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (x[middle] > value) high = middle;
      else low = middle;
    }
    return Math.abs(x[high] - value) < Math.abs(x[low] - value) ? high : low;
  }

  // -- by hand

  visible() {
    return this.link.range || this.whole;
  }

  /** About a value, by a factor. */
  zoom(about, factor) {
    const [from, to] = this.visible();
    const width = Math.max((to - from) * factor, 1e-4 * (this.whole[1] - this.whole[0]));
    if (width >= this.whole[1] - this.whole[0]) return this.link.show(null);
    this.within(about - ((about - from) * width) / (to - from), width);
  }

  within(from, width) {
    const start = Math.min(Math.max(from, this.whole[0]), this.whole[1] - width);
    this.link.show([start, start + width]);
  }

  wheel(event) {
    const [from, to] = this.visible();
    if (event.ctrlKey || event.metaKey) {
      event.preventDefault();
      this.zoom(this.plot.posToVal(event.offsetX, "x"), Math.exp(0.002 * event.deltaY));
    } else if (this.link.range && Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      event.preventDefault();
      this.within(from + (event.deltaX / this.plot.over.clientWidth) * (to - from), to - from);
    }
  }

  /** With shift: the stretch follows the hand. */
  move(event) {
    event.preventDefault();
    const [from, to] = this.visible();
    const [start, width] = [event.clientX, this.plot.over.clientWidth];
    const moved = e => this.within(from - ((e.clientX - start) / width) * (to - from), to - from);
    const done = () => {
      removeEventListener("mousemove", moved);
      removeEventListener("mouseup", done);
    };
    if (this.link.range) {
      addEventListener("mousemove", moved);
      addEventListener("mouseup", done);
    }
    return null;
  }

  /** A finger moves the cursor, two zoom; the page still scrolls up and down. */
  touches(over) {
    over.style.touchAction = "pan-y";
    const fingers = new Map();
    let spread = 0;
    const value = event => this.plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
    const apart = () => {
      const [a, b] = [...fingers.values()];
      return Math.max(Math.abs(a.clientX - b.clientX), 10);
    };
    over.addEventListener("pointerdown", event => {
      if (event.pointerType !== "touch") return;
      fingers.set(event.pointerId, event);
      this.link.set(value(event));
      if (fingers.size === 2) spread = apart();
    });
    over.addEventListener("pointermove", event => {
      if (!fingers.has(event.pointerId)) return;
      fingers.set(event.pointerId, event);
      if (fingers.size === 1) this.link.set(value(event));
      else if (fingers.size === 2) {
        const now = apart();
        this.zoom(value(event), spread / now);
        spread = now;
      }
    });
    for (const end of ["pointerup", "pointercancel"]) over.addEventListener(end, event => fingers.delete(event.pointerId));
  }

  key(event) {
    const [from, to] = this.visible();
    const here = this.link.value === null ? (from + to) / 2 : this.link.value;
    const step = (to - from) / 200;
    const actions = {
      ArrowLeft: () => this.link.set(here - step),
      ArrowRight: () => this.link.set(here + step),
      "+": () => this.zoom(here, 0.5),
      "-": () => this.zoom(here, 2),
      0: () => this.link.show(null),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    this.hovered = false;
    action();
  }
}
