// Puts the pictures into their places, and links words and tables with them.

const page = { data, links, curves: new Map(), stage: null, number: written };

/** Curves in a part of the page that is closed have no width: they are drawn once it is open. */
for (const spec of data.plots) {
  const host = document.getElementById(spec.id);
  if (host) page.curves.set(spec.id, new Curves(spec, host));
}

const planHost = document.getElementById("plan");
if (data.plan && planHost) page.stage = new Stage(planHost);

// A place in the text moves the cursor there: <a data-s="27.4">.
for (const place of document.querySelectorAll("[data-s]")) {
  place.setAttribute("href", "#plan");
  place.addEventListener("click", event => {
    event.preventDefault();
    const s = Number(place.dataset.s);
    if (page.stage && data.replay) page.stage.seek(s);
    else linkOf("track").set(s);
    if (planHost) planHost.scrollIntoView({ block: "nearest", behavior: "smooth" });
  });
}

// Rows over an axis have its cursor.
for (const rows of document.querySelectorAll("[data-along]")) {
  const link = linkOf(rows.dataset.along);
  const extent = Number(rows.dataset.extent);
  const scales = [...rows.querySelectorAll(".row-scale:not(.row-ticks)")];
  const lines = scales.map(scale => {
    const line = element("i", { class: "cursor-line", hidden: true });
    scale.append(line);
    return line;
  });
  link.members.push({
    cursor: s => lines.forEach(line => {
      line.hidden = !(s >= 0 && s <= extent);
      line.style.left = `${(100 * s) / extent}%`;
    }),
    stretch: () => null,
  });
  for (const scale of scales) {
    scale.addEventListener("mousemove", event => {
      const box = scale.getBoundingClientRect();
      link.set((extent * (event.clientX - box.left)) / box.width);
    });
  }
}

// Buttons that turn a picture on and off: <button data-shows="id">.
for (const button of document.querySelectorAll("[data-shows]")) {
  const figure = document.getElementById(button.dataset.shows);
  button.addEventListener("click", () => {
    const shown = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(shown));
    figure.toggleAttribute("hidden", !shown);
  });
}

// Another page of the same kind is laid over this one: the curves of its plots of the same names.
const other = document.getElementById("other-page");
if (other) {
  const said = document.getElementById("other-said");
  other.addEventListener("change", async () => {
    const [file] = other.files;
    if (!file) return;
    for (const own of page.curves.values()) if (own.others.length) own.lay([]);
    let read = null;
    try {
      const text = await file.text();
      read = JSON.parse(new DOMParser().parseFromString(text, "text/html").getElementById("page-data").textContent);
    } catch {
      said.textContent = `${file.name} is no such page.`;
      return;
    }
    let laid = 0;
    for (const spec of read.plots || []) {
      const own = page.curves.get(spec.id);
      if (!own || own.spec.unit !== spec.unit) continue;
      own.lay(overlaid(own, spec));
      laid += 1;
    }
    said.textContent = laid ? `B is ${file.name}: ${laid} pictures have its curves.` : `${file.name} has no curves that this page has, too.`;
    const laps = [data.plan?.lap_m, read.plan?.lap_m];
    const differ = laid > 0 && laps.every(lap => lap > 0) && Math.abs(laps[0] - laps[1]) > 1e-3 * laps[0];
    if (differ) {
      const [a, b] = laps.map(lap => lap.toFixed(3));
      const warning = element("b", { class: "warned" });
      warning.textContent = ` The runs are of different tracks: a lap is ${a} m here and ${b} m in B, so one place is not the same of both.`;
      said.append(warning);
    }
  });
}

/** The lines of another page's plot at the places of this one. */
function overlaid(own, spec) {
  const lines = spec.curves.filter(curve => "y" in curve).slice(0, 1);
  return lines.map(curve => ({ name: "B: " + curve.name, colour: "other", y: own.spec.x.map(x => between(spec.x, curve.y, x)) }));
}

/** Straight between neighbours; null beyond the ends and beside lost values. */
function between(xs, ys, x) {
  let [low, high] = [0, xs.length - 1];
  if (!(x >= xs[low] && x <= xs[high])) return null;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (xs[middle] > x) high = middle;
    else low = middle;
  }
  if (ys[low] === null || ys[high] === null) return null;
  const y = ys[low] + ((ys[high] - ys[low]) * (x - xs[low])) / (xs[high] - xs[low] || 1);
  // A page's own values have no more digits.
  return Number(y.toPrecision(6));
}

// For tests, and for who looks closer in the browser's console.
window.page = page;
