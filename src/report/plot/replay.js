// The plan with its buttons, and the chain running on it: time, speed, what colours the carts.

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];

class Stage {
  constructor(host) {
    this.host = host;
    this.plan = data.plan;
    this.line = new CentreLine(this.plan);
    this.link = linkOf("track");
    this.layers = this.plan.layers.map(spec => new Layer(spec, this.plan.lap_m));
    this.view = new PlanView(this.line, this.link);
    this.flat = this.view;
    this.screen = element("div", { class: "plan-screen" }, this.view.canvas);
    this.tools = element("div", { class: "tools" });
    this.below = element("div", { class: "tools" });
    this.note = element("p", { class: "note plan-note" });
    host.replaceChildren(this.tools, this.screen, this.below, this.note);
    this.buttons();
    this.key = element("div", { class: "key" });
    this.where = element("div", { class: "where", "aria-live": "off" });
    this.below.append(this.key, this.where);
    if (data.replay) this.replay();
    this.choose(this.plan.shown);
    this.link.members.push(this);
    repaints.push(() => {
      this.choose(this.chosen);
      this.view.redraw();
    });
    new ResizeObserver(() => this.fit()).observe(this.screen);
    this.fit();
  }

  // -- layers

  buttons() {
    this.choices = this.layers.map((layer, k) => {
      const button = element("button", { type: "button", "aria-pressed": "false", title: layer.spec.label, "data-layer": layer.spec.name }, layer.spec.name);
      button.addEventListener("click", () => this.choose(k));
      return button;
    });
    this.kinds = element("select", { "aria-label": "which value", title: "which value of a place" }, ...Object.keys(KINDS).map(kind => element("option", { value: kind }, kind)));
    this.kinds.addEventListener("change", () => {
      for (const layer of this.layers.filter(layer => !layer.amount)) {
        layer.kind = this.kinds.value;
        layer.gather();
      }
      this.choose(this.chosen);
    });
    if (this.choices.length > 1) this.tools.append(element("span", { class: "choices", role: "group", "aria-label": "coloured by" }, ...this.choices));
    if (this.layers.some(layer => !layer.amount)) this.tools.append(this.kinds);
    const right = element("span", { class: "views-of-plan" });
    const button = (text, title, act) => {
      const made = element("button", { type: "button", title, "aria-label": title }, text);
      made.addEventListener("click", act);
      right.append(made);
      return made;
    };
    if (this.line.raised) this.space = button("3D", "in space", () => this.turn());
    button("+", "larger", () => this.view.zoom(1.6));
    button("−", "smaller", () => this.view.zoom(1 / 1.6));
    button("whole", "the whole track", () => {
      this.view.whole();
      this.view.redraw();
    });
    this.tools.append(right);
  }

  choose(k) {
    this.chosen = k;
    const layer = this.layers[k];
    this.choices.forEach((choice, j) => choice.setAttribute("aria-pressed", String(j === k)));
    this.flat.layer = layer;
    if (this.spatial) this.spatial.layer = layer;
    this.explain(layer);
    this.cursor(this.link.value);
    this.view.redraw();
  }

  explain(layer) {
    if (!layer) return;
    const ends = [layer.low, layer.high].map(v => short(Number(v.toPrecision(3 + (layer.amount ? 0 : 1)))));
    const steps = Array.from({ length: 11 }, (_, k) => layer.low + ((layer.high - layer.low) * k) / 10);
    const ramp = element("i", { class: "ramp", style: `background: linear-gradient(to right, ${steps.map(v => css(layer.colour(v))).join(", ")})` });
    this.key.replaceChildren(element("b", {}, layer.spec.name), ` ${ends[0]} `, ramp, ` ${ends[1]} ${layer.spec.unit}`);
    if (layer.amount) {
      this.note.textContent = layer.spec.label + ".";
      return;
    }
    const chain = "Every cart has the colour of the place where it is: what it felt itself was not recorded. The framed one carries the sensors.";
    this.note.textContent = `${layer.spec.label}: the ${KINDS[layer.kind].says} that the sensors measured within half a cart of a place. ${data.replay ? chain : ""}`;
  }

  // -- the common cursor

  cursor(s) {
    if (s === null) return;
    const part = this.line.part(s);
    const layer = this.layers[this.chosen];
    const value = layer ? `${layer.spec.name} ${written(layer.value(s) === null ? null : Number(layer.value(s).toPrecision(5)), layer.spec.unit)}` : "";
    const height = this.line.raised ? `, ${this.line.at(s)[2].toFixed(2)} m high` : "";
    this.where.replaceChildren(element("b", {}, `s = ${s.toFixed(2)} m`), `${part ? ", " + part.name : ""}${height}${value ? ": " + value : ""}`);
    this.view.redraw();
  }

  stretch() {
    this.view.redraw();
  }

  fit() {
    const width = Math.floor(this.screen.clientWidth);
    if (width < 50) return;
    const { low, high } = this.line;
    const shape = (high[1] - low[1]) / Math.max(high[0] - low[0], 1);
    const height = Math.round(Math.min(Math.max(width * Math.max(shape, this.view === this.flat ? 0 : 0.5), 200), width > 700 ? 400 : 320));
    this.view.fit(width, height);
    this.view.draw();
  }

  // -- in space

  turn() {
    if (!this.spatial) {
      const view = new SpaceView(this.line, this.link);
      if (!view.gl) {
        this.space.disabled = true;
        this.note.textContent = "This browser has no WebGL, so that the track cannot be shown in space.";
        return;
      }
      Object.assign(view, { layer: this.layers[this.chosen], carts: this.flat.carts, playing: this.flat.playing, picked: this.flat.picked });
      this.spatial = view;
    }
    const space = this.view === this.flat;
    this.view = space ? this.spatial : this.flat;
    this.space.setAttribute("aria-pressed", String(space));
    this.screen.replaceChildren(this.view.canvas);
    this.tall.hidden = !space;
    this.fit();
  }

  // -- replay

  replay() {
    const { replay } = data;
    this.end = replay.time[replay.time.length - 1];
    this.time = replay.time[0];
    this.speed = 1;
    this.carts = { shown: true, places: [], pitch: replay.pitch_m, sensor: replay.sensor_cart - 1 };
    this.flat.carts = this.carts;
    this.flat.playing = () => Boolean(this.running);
    this.flat.picked = s => this.seek(s);
    this.play = element("button", { type: "button", class: "play", "aria-label": "play" }, "▶");
    this.play.addEventListener("click", () => this.toggle());
    this.slider = element("input", { type: "range", min: replay.time[0], max: this.end, step: "any", value: replay.time[0], "aria-label": "time, s", class: "time" });
    this.slider.addEventListener("input", () => this.go(Number(this.slider.value), true));
    this.clock = element("span", { class: "clock" });
    const speeds = element("select", { "aria-label": "speed", class: "speed" }, ...SPEEDS.map(v => element("option", { value: v, selected: v === 1 }, `${v}×`)));
    speeds.addEventListener("change", () => { this.speed = Number(speeds.value); });
    const check = (text, on, act) => {
      const box = element("input", { type: "checkbox", checked: on });
      box.addEventListener("change", () => act(box.checked));
      return element("label", {}, box, " " + text);
    };
    const shown = check("carts", true, on => {
      this.carts.shown = on;
      this.view.redraw();
    });
    const follow = check("follow", false, on => this.follow(on));
    this.tall = element("select", { "aria-label": "heights", hidden: true, class: "heights" }, ...[1, 2, 5].map(v => element("option", { value: v }, v === 1 ? "heights as built" : `heights ${v}×`)));
    this.tall.addEventListener("change", () => {
      this.spatial.exaggerated = Number(this.tall.value);
      this.view.redraw();
    });
    const bar = element("div", { class: "tools replay" }, this.play, this.slider, this.clock, speeds, shown, follow, this.tall);
    this.screen.after(bar);
    this.go(this.time, false);
  }

  /** Where the cart with the sensors is at a time, m travelled. */
  travelled(t) {
    const { time, s } = data.replay;
    let [low, high] = [0, time.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (time[middle] > t) high = middle;
      else low = middle;
    }
    const share = time[high] > time[low] ? (t - time[low]) / (time[high] - time[low]) : 0;
    return s[low] + (s[high] - s[low]) * share;
  }

  /** Shows the chain at a time; the cursor goes with it where it is told to. */
  go(t, cursor) {
    this.time = t;
    const { carts, pitch_m, sensor_cart } = data.replay;
    const first = this.travelled(t);
    // Cart 1 leads: those behind it have higher numbers.
    this.carts.places = Array.from({ length: carts }, (_, k) => first - (k + 1 - sensor_cart) * pitch_m);
    this.slider.value = t;
    this.clock.textContent = `${t.toFixed(this.speed < 1 ? 2 : 1)} s`;
    if (this.following && this.view === this.flat) this.flat.centre(first);
    if (cursor) this.link.set(first);
    this.view.redraw();
  }

  toggle() {
    this.running = !this.running;
    this.play.textContent = this.running ? "❚❚" : "▶";
    this.play.setAttribute("aria-label", this.running ? "pause" : "play");
    if (!this.running) return;
    if (this.time >= this.end) this.time = data.replay.time[0];
    let last = null;
    const frame = now => {
      if (!this.running) return;
      if (last !== null) {
        const next = this.time + (this.speed * Math.min(now - last, 500)) / 1000;
        this.go(Math.min(next, this.end), true);
        if (next >= this.end) return this.toggle();
      }
      last = now;
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  follow(on) {
    this.following = on;
    if (on && this.flat.view.scale < 6 * this.flat.least) this.flat.zoom((6 * this.flat.least) / this.flat.view.scale);
    if (!on) this.flat.whole();
    this.go(this.time, false);
  }

  /** To the time nearest to now at which the cart with the sensors is at a place. */
  seek(s) {
    const { time, s: travelled } = data.replay;
    const lap = this.plan.lap_m;
    const [from, to] = [travelled[0], travelled[travelled.length - 1]];
    const now = this.travelled(this.time);
    const laps = Math.round((now - s) / lap);
    const found = [laps - 1, laps, laps + 1].map(n => s + n * lap).filter(at => at >= from && at <= to);
    found.sort((a, b) => Math.abs(a - now) - Math.abs(b - now));
    if (found.length) {
      const at = found[0];
      let k = travelled.findIndex(v => v >= at);
      if (k < 1) k = 1;
      const share = (at - travelled[k - 1]) / (travelled[k] - travelled[k - 1] || 1);
      this.go(time[k - 1] + share * (time[k] - time[k - 1]), false);
    }
    this.link.set(s);
  }
}
