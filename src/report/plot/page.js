// The page's data, its colours, and what its pictures have in common: a cursor and a stretch for each axis.

const data = JSON.parse(document.getElementById("page-data").textContent);

// ---------------------------------------------------------------------------------------------------------------------
// Elements, numbers, colours

/** An element with attributes and children; text is always text. */
function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children);
  return made;
}

/** A number as the page's data have it, with a true minus. */
function written(value, unit) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size > 0 && (size < 1e-4 || size >= 1e7) ? value.toExponential(3) : String(value);
  return text.replace("-", "−") + (unit ? " " + unit : "");
}

const colours = new Map();

/** A variable of the style sheet in the reader's light or dark mode. */
function colour(name) {
  if (!colours.has(name)) {
    colours.set(name, getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim() || "#888888");
  }
  return colours.get(name);
}

/** A colour with an opacity. */
function faded(name, opacity) {
  return `color-mix(in srgb, ${colour(name)} ${Math.round(100 * opacity)}%, transparent)`;
}

const repaints = [];
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  colours.clear();
  repaints.forEach(repaint => repaint());
});

// Viridis (van der Walt and Smith 2015) at nine places: even to the eye, and readable with any colour vision.
const VIRIDIS = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99],
  [170, 220, 50], [253, 231, 37],
];

/** Red, green and blue from 0 to 255 at a share from 0 to 1. */
function viridis(share) {
  const at = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1);
  const k = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return VIRIDIS[k].map((from, c) => Math.round(from + (VIRIDIS[k + 1][c] - from) * (at - k)));
}

// ---------------------------------------------------------------------------------------------------------------------
// What pictures of one axis share

/** A cursor and a visible stretch that several pictures follow. */
class Link {
  constructor(lap) {
    this.lap = lap;
    this.value = null;
    this.range = null;
    this.members = [];
  }

  /** Moves the cursor in all pictures. */
  set(value) {
    if (value === null || !Number.isFinite(value)) return;
    this.value = this.lap ? ((value % this.lap) + this.lap) % this.lap : value;
    this.members.forEach(member => member.cursor(this.value));
  }

  /** Shows one stretch in all pictures; null shows all. */
  show(range) {
    this.range = range;
    this.members.forEach(member => member.stretch(range));
  }
}

const links = new Map();

/** The link of an axis. Plots with an axis of their own share nothing. */
function linkOf(axis) {
  if (axis === "own") return new Link(null);
  if (!links.has(axis)) links.set(axis, new Link(axis === "track" && data.plan ? data.plan.lap_m : null));
  return links.get(axis);
}
