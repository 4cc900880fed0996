// The page of `lss preview`. The server says what there is to show, part by part, and waits with its answer until
// something is new. All that this script does on its own is to move vertices, to zoom, and to point at lines.
"use strict";

const SVG = "http://www.w3.org/2000/svg";
const by = (id) => document.getElementById(id);
const [sheet, drawing, handles, tip, note] = ["sheet", "drawing", "handles", "tip", "note"].map(by);

// What the server showed last, by the names of its parts.
const parts = { plan: null, moving: null, status: null, source: null };
// What part of the paper is seen: x, y, width and height in its units.
let view = null;
// The vertex that is dragged: its number, where it is now (m), and whether it moved.
let drag = null;
// Where a vertex was let go, until the file says so.
let placed = null;

// ---- What the server says ----

async function follow() {
  let after = 0;
  for (;;) {
    while (document.hidden) {
      await new Promise((seen) => document.addEventListener("visibilitychange", seen, { once: true }));
    }
    // A hidden page waits for nothing: browsers open few connections to one address.
    const waiting = new AbortController();
    const hide = () => document.hidden && waiting.abort();
    document.addEventListener("visibilitychange", hide);
    try {
      const answer = await fetch(`state?after=${after}`, { signal: waiting.signal });
      if (!answer.ok) throw new Error(answer.statusText);
      const news = await answer.json();
      if (news.closed) throw new Error("closed");
      by("lost").hidden = true;
      after = news.version;
      show(news.parts);
    } catch (why) {
      if (why.name !== "AbortError") {
        by("lost").hidden = false;
        after = 0;
        await new Promise((later) => setTimeout(later, 1000));
      }
    } finally {
      document.removeEventListener("visibilitychange", hide);
    }
  }
}

function show(news) {
  Object.assign(parts, news);
  if ("plan" in news || ("moving" in news && news.moving === null)) placed = null;
  if ("plan" in news || "moving" in news) showPlan();
  if ("status" in news || "moving" in news || "plan" in news) showStatus();
  if ("errors" in news) by("messages").innerHTML = news.errors;
  if ("facts" in news) by("facts").innerHTML = news.facts;
  if ("source" in news) showSource(news.source);
  if ("history" in news) {
    by("undo").disabled = !news.history.undo;
    by("redo").disabled = !news.history.redo;
  }
}

function showStatus() {
  const { plan, moving, status } = parts;
  const picture = moving?.svg ? moving : plan;
  const near = moving?.svg || plan?.near;
  by("length").textContent = picture ? (near ? `≈ ${picture.length}` : picture.length) : "";
  by("length").className = near ? "near" : "";
  if (plan) by("name").textContent = plan.name;
  if (plan) document.title = `${plan.name}: ${plan.length}`;
  const line = by("status");
  const dragged = moving?.svg ? "before it is put on the catalogue's grid" : "the drawing is of the layout before";
  line.textContent = moving?.moved ? `while dragging: ${dragged}` : (status?.words ?? "");
  line.classList.toggle("busy", Boolean(status?.busy));
  line.classList.toggle("stale", Boolean(status?.stale));
  sheet.classList.toggle("stale", Boolean(status?.stale) && !moving?.svg);
  // What is told of a layout is of the one before until the new one is solved.
  by("facts").classList.toggle("before", Boolean(status?.stale || near));
  stand();
}

// A sentence over the plan; `null` takes it away.
function tell(words, quiet = false) {
  note.textContent = words ?? "";
  note.hidden = !words;
  note.classList.toggle("quiet", quiet);
}

// What the server says of what is shown: what is wrong with a movement, else what a drag came to.
function stand() {
  const { plan, moving } = parts;
  const problem = moving?.problem ?? null;
  tell(problem ?? (moving?.svg ? null : (plan?.remark ?? null)), !problem);
}

// The same, for what one page has done and the server says nothing of.
function remark(words) {
  tell(words);
  setTimeout(() => note.textContent === words && stand(), 6000);
}

let later = 0;
function showPlan() {
  const { plan, moving } = parts;
  clearTimeout(later);
  // What comes between two states of the file is shown only if the second one takes long.
  if (moving?.svg) {
    put(moving);
  } else if (plan?.near && shown) {
    later = setTimeout(() => put(plan), 250);
  } else if (plan) {
    put(plan);
  }
  drawHandles();
}

let shown = null;
function put(picture) {
  if (shown === picture) return;
  shown = picture;
  drawing.innerHTML = picture.svg;
  const { width, height } = picture.paper;
  const former = sheet.dataset.paper;
  sheet.dataset.paper = `${width} ${height}`;
  if (!view || former !== sheet.dataset.paper) view = [0, 0, width, height];
  sheet.style.aspectRatio = `${width} / ${height}`;
  look();
}

function showSource(source) {
  by("file").textContent = source.file;
  const list = document.querySelector("#source ol");
  const at = list.scrollTop;
  const chosen = [...list.querySelectorAll(".chosen")].map((line) => Number(line.dataset.line));
  list.innerHTML = source.html;
  list.scrollTop = at;
  choose(chosen, false);
}

// ---- Lines of the source ----

function choose(lines, scroll = true) {
  const list = document.querySelector("#source ol");
  list.querySelectorAll(".chosen").forEach((line) => line.classList.remove("chosen"));
  const found = lines.map((line) => list.querySelector(`li[data-line="${line}"]`)).filter(Boolean);
  found.forEach((line) => line.classList.add("chosen"));
  if (scroll && found.length) {
    const first = found[0];
    list.scrollTop = first.offsetTop - list.clientHeight / 3;
    const box = list.getBoundingClientRect();
    if (box.top > innerHeight - 60 || box.bottom < 60) list.scrollIntoView({ block: "nearest" });
  }
}

document.addEventListener("click", (event) => {
  const line = event.target.closest("button.line");
  if (!line) return;
  if (line.dataset.file && line.dataset.file !== parts.source?.file) return;
  choose([Number(line.dataset.line)]);
});

// ---- Sections under the pointer ----

const keyOf = (area) => ("section" in area.dataset ? `s${area.dataset.section}` : `c${area.dataset.curve}`);

drawing.addEventListener("click", (event) => {
  const area = event.target.closest(".area");
  if (!area || !parts.plan) return;
  drawing.querySelectorAll(".area.chosen").forEach((other) => other.classList.remove("chosen"));
  area.classList.add("chosen");
  choose(parts.plan.lines[keyOf(area)] ?? []);
});

sheet.addEventListener("pointermove", (event) => {
  const area = drag ? null : event.target.closest(".area");
  const words = area && parts.plan?.tips[keyOf(area)];
  tip.hidden = !words;
  if (!words) return;
  if (tip.dataset.of !== keyOf(area) + parts.plan.text) tip.innerHTML = words;
  tip.dataset.of = keyOf(area) + parts.plan.text;
  const box = sheet.getBoundingClientRect();
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  tip.style.left = `${Math.max(4, Math.min(x + 14, box.width - tip.offsetWidth - 8))}px`;
  tip.style.top = `${y + 18 + tip.offsetHeight > box.height ? Math.max(4, y - tip.offsetHeight - 12) : y + 18}px`;
});
sheet.addEventListener("pointerleave", () => (tip.hidden = true));

// ---- Zoom ----

function look() {
  const box = view.join(" ");
  drawing.querySelector("svg")?.setAttribute("viewBox", box);
  handles.setAttribute("viewBox", box);
  drawHandles();
}

// Units of the paper a pixel.
const pixel = () => Math.max(view[2] / sheet.clientWidth, view[3] / sheet.clientHeight);

function paperAt(event) {
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(handles.getScreenCTM().inverse());
  return [at.x, at.y];
}

function zoom(factor, [x, y]) {
  if (!view || !shown) return;
  const { width, height } = shown.paper;
  const by = Math.min(Math.max(factor, width / 40 / view[2]), width / view[2]);
  view = [x - (x - view[0]) * by, y - (y - view[1]) * by, view[2] * by, view[3] * by];
  view[0] = Math.min(Math.max(view[0], 0), width - view[2]);
  view[1] = Math.min(Math.max(view[1], 0), height - view[3]);
  look();
}

const middle = () => [view[0] + view[2] / 2, view[1] + view[3] / 2];
by("closer").addEventListener("click", () => view && zoom(1 / 1.4, middle()));
by("wider").addEventListener("click", () => view && zoom(1.4, middle()));
by("fit").addEventListener("click", () => view && zoom(Infinity, middle()));
sheet.addEventListener("wheel", (event) => {
  if (!event.ctrlKey || !view) return;
  event.preventDefault();
  zoom(Math.exp(event.deltaY / 300), paperAt(event));
}, { passive: false });
sheet.addEventListener("pointerdown", (event) => {
  if (event.button !== 0 || !view || event.target.closest(".handle, .area") || view[2] >= shown.paper.width) return;
  const [x, y] = paperAt(event);
  const pan = (move) => {
    const [nx, ny] = paperAt(move);
    view[0] = Math.min(Math.max(view[0] + x - nx, 0), shown.paper.width - view[2]);
    view[1] = Math.min(Math.max(view[1] + y - ny, 0), shown.paper.height - view[3]);
    look();
  };
  sheet.addEventListener("pointermove", pan);
  addEventListener("pointerup", () => sheet.removeEventListener("pointermove", pan), { once: true });
});
new ResizeObserver(() => {
  tip.hidden = true;
  if (view) drawHandles();
}).observe(sheet);
by("stages").addEventListener("change", (event) => sheet.classList.toggle("stages", event.target.checked));

// ---- Vertices ----

// Where a vertex is shown, m.
function placeOf(k) {
  const own = [drag, placed, parts.moving?.moved].find((moved) => moved && moved.vertex === k);
  return own ?? parts.plan.vertices[k];
}

function drawHandles() {
  const plan = parts.plan;
  if (!plan || !view) return handles.replaceChildren();
  const { x, y, scale } = shown.paper;
  const at = (p) => [x + p.x * scale, y - p.y * scale];
  const size = pixel();
  const places = plan.vertices.map((_, k) => at(placeOf(k)));
  let line = handles.querySelector(".written");
  if (!line || handles.childElementCount !== places.length + 1) {
    line = document.createElementNS(SVG, "path");
    line.setAttribute("class", "written");
    handles.replaceChildren(line, ...plan.vertices.map(handle));
  }
  line.setAttribute("d", places.length ? `M${places.map((p) => p.join(" ")).join("L")}Z` : "");
  places.forEach(([px, py], k) => {
    const vertex = plan.vertices[k];
    const group = handles.children[k + 1];
    group.setAttribute("transform", `translate(${px} ${py})`);
    group.classList.toggle("held", drag?.vertex === k);
    group.classList.toggle("locked", !vertex.moves.x && !vertex.moves.y);
    group.querySelector(".dot").setAttribute("r", 5.5 * size);
    group.querySelector(".reach").setAttribute("r", 14 * size);
    const place = placeOf(k);
    const words = `${vertex.name} (${tidy(place.x)} m, ${tidy(place.y)} m)${vertex.why ? `: ${vertex.why}` : ""}`;
    group.setAttribute("aria-label", words);
    group.querySelector("title").textContent = words;
  });
}

const tidy = (metres) => String(Number(metres.toFixed(3)));

function handle(_, k) {
  const group = document.createElementNS(SVG, "g");
  group.setAttribute("class", "handle");
  group.setAttribute("tabindex", "0");
  group.setAttribute("role", "button");
  group.dataset.vertex = k;
  for (const name of ["title", "reach", "dot"]) {
    const part = document.createElementNS(SVG, name === "title" ? "title" : "circle");
    if (name !== "title") part.setAttribute("class", name);
    group.append(part);
  }
  return group;
}

// The places that a pointer can choose lie as far apart as pixels do, and never closer than a centimetre.
function step(event) {
  if (event.shiftKey) return 0.01;
  const metres = pixel() / shown.paper.scale;
  return [0.01, 0.02, 0.05, 0.1, 0.2, 0.25, 0.5, 1, 2, 5].find((s) => s >= metres) ?? 10;
}

function aim(event) {
  const { x, y, scale } = shown.paper;
  const [px, py] = paperAt(event);
  const [vertex, grid] = [parts.plan.vertices[drag.vertex], step(event)];
  const snap = (metres) => Number((Math.round(metres / grid) * grid).toFixed(3));
  const to = { x: snap((px - drag.dx - x) / scale), y: snap((y - py + drag.dy) / scale) };
  return { x: vertex.moves.x ? to.x : vertex.x, y: vertex.moves.y ? to.y : vertex.y };
}

handles.addEventListener("pointerdown", (event) => {
  const group = event.target.closest(".handle");
  if (!group || event.button !== 0) return;
  const vertex = Number(group.dataset.vertex);
  const own = parts.plan.vertices[vertex];
  if (own.line) choose([own.line], false);
  if (parts.status?.stale) return remark("the text has mistakes: put them right before a vertex is moved");
  if (!own.moves.x && !own.moves.y) return remark(`${own.name} cannot be dragged: ${own.why}`);
  event.preventDefault();
  group.focus({ preventScroll: true });
  group.setPointerCapture(event.pointerId);
  const { x, y, scale } = shown.paper;
  const [px, py] = paperAt(event);
  drag = { vertex, x: own.x, y: own.y, dx: px - (x + own.x * scale), dy: py - (y - own.y * scale), moved: false };
  drag.text = parts.plan.text;
  drawHandles();
});

handles.addEventListener("pointermove", (event) => {
  if (!drag) return;
  const to = aim(event);
  if (to.x === drag.x && to.y === drag.y) return;
  Object.assign(drag, to, { moved: true });
  drawHandles();
  move();
});

handles.addEventListener("pointerup", () => drag && letGo());
handles.addEventListener("pointercancel", () => giveUp());
handles.addEventListener("lostpointercapture", () => drag && letGo());

const request = (vertex) => ({ vertex: vertex.vertex, x: vertex.x, y: vertex.y, text: vertex.text });

// One movement is on its way at a time; the next one is the latest.
let underway = false;
async function move() {
  if (underway) return;
  underway = true;
  while (drag && drag.sent !== `${drag.x} ${drag.y}`) {
    drag.sent = `${drag.x} ${drag.y}`;
    await ask("move", request(drag));
  }
  underway = false;
}

async function letGo() {
  const done = drag;
  drag = null;
  if (!done.moved) return drawHandles();
  placed = done;
  const own = parts.plan.vertices[done.vertex];
  drawHandles();
  if (own.line) choose([own.line]);
  await ask("put", request(done));
}

function giveUp() {
  if (!drag) return;
  drag = null;
  drawHandles();
  ask("still", {});
}

async function ask(what, body) {
  try {
    const answer = await fetch(what, { method: "POST", body: JSON.stringify(body) });
    const { problem } = await answer.json();
    if (problem) {
      placed = null;
      drawHandles();
      // What the server shows next would take the words away at once.
      setTimeout(() => remark(problem), 300);
    }
  } catch {
    by("lost").hidden = false;
  }
}

// Arrow keys move the vertex that has the focus; it is written when they rest.
let rest = 0;
handles.addEventListener("keydown", (event) => {
  const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
  const group = event.target.closest(".handle");
  if (!way || !group || parts.status?.stale) return;
  event.preventDefault();
  const vertex = Number(group.dataset.vertex);
  const own = parts.plan.vertices[vertex];
  if (drag && drag.vertex !== vertex) return;
  drag ??= { vertex, x: own.x, y: own.y, text: parts.plan.text };
  const by = step(event);
  if (own.moves.x) drag.x = Number((drag.x + way[0] * by).toFixed(3));
  if (own.moves.y) drag.y = Number((drag.y + way[1] * by).toFixed(3));
  drag.moved = true;
  drawHandles();
  move();
  clearTimeout(rest);
  rest = setTimeout(() => drag && letGo(), 600);
});

document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") return giveUp();
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  const key = event.key.toLowerCase();
  if (key === "z" || key === "y") {
    event.preventDefault();
    ask(key === "y" || event.shiftKey ? "redo" : "undo", {});
  }
});
by("undo").addEventListener("click", () => ask("undo", {}));
by("redo").addEventListener("click", () => ask("redo", {}));

follow();
