//! The checked layout as text, with every default filled in: `lss build --emit model`.
//!
//! The text is a layout again: checked, it gives the same model (but for the spans).

mod capacity;
mod choice;
mod components;
mod equipment;
mod formula;

use std::collections::BTreeSet;
use std::fmt::Write;

use super::*;
use crate::base::number::trimmed;
use crate::base::trig;
use formula::Dimension;

/// The layout and everything that it is made of, as `.lss`. Lengths in metres, angles in degrees where that loses
/// nothing.
pub fn print(layout: &Layout) -> String {
    let mut out = Printer::default();
    out.catalog(&layout.catalog);
    out.cart(&layout.cart, &layout.cart.name);
    out.drive(layout);
    out.choices(&layout.choice);
    out.kinds(layout);
    out.layout(layout);
    out.text
}

#[derive(Default)]
struct Printer {
    text: String,
    depth: usize,
    /// Declarations that were printed, by kind and name.
    printed: BTreeSet<String>,
}

impl Printer {
    fn line(&mut self, text: impl AsRef<str>) {
        for _ in 0..self.depth {
            self.text.push_str("  ");
        }
        self.text.push_str(text.as_ref());
        self.text.push('\n');
    }

    fn block(&mut self, head: impl AsRef<str>, body: impl FnOnce(&mut Self)) {
        self.line(format!("{} {{", head.as_ref()));
        self.depth += 1;
        body(self);
        self.depth -= 1;
        self.line("}");
    }

    fn field(&mut self, name: &str, value: impl AsRef<str>) {
        self.line(format!("{name} = {}", value.as_ref()));
    }

    fn layout(&mut self, layout: &Layout) {
        let names: Vec<&str> = layout.vertices.iter().map(|v| v.name.as_str()).collect();
        self.block(format!("layout {}", layout.name), |out| {
            out.line(format!("catalog {}", layout.catalog.name));
            out.line(format!("cart {}", layout.cart.name));
            out.line(format!("motor {}", layout.drive.motor.name));
            out.line(format!("controller {}", layout.drive.controller.name));
            out.line(format!("sensor {}", layout.sensor.name));
            if let Some(take_up) = &layout.take_up {
                out.line(format!("take_up {}", take_up.name));
            }
            out.line(format!("speed {}", unit(layout.speed.value, "m/s")));
            out.line(format!("width {}", metres(layout.width.value)));
            out.line(format!("turns {}", range(layout.turns.value, degrees)));
            out.line(format!("radii {}", range(layout.radii.value, metres)));
            out.text.push('\n');
            for vertex in &layout.vertices {
                let radius = metres(vertex.radius.value);
                out.line(format!("vertex {} {} radius {radius}", vertex.name, point(vertex.point)));
            }
            out.text.push('\n');
            out.regions(layout);
            for constraint in &layout.constraints {
                out.line(constraint_text(constraint, layout, &names));
            }
            out.route(layout);
            out.equipment(layout, &names);
            out.drawing(&layout.drawing);
            out.line(objective(&layout.objective));
        });
    }

    fn route(&mut self, layout: &Layout) {
        let Some(route) = &layout.route else { return };
        for section in &route.sections {
            self.line(part_text(section));
        }
        let names: Vec<&str> = route.sections.iter().map(|s| s.name.as_str()).collect();
        let order = if route.any_order { " in any order" } else { "" };
        self.line(format!("route {}{order}", names.join(", ")));
    }

    fn regions(&mut self, layout: &Layout) {
        let polygon = |p: &Polygon| p.points().iter().map(|p| point(*p)).collect::<Vec<_>>().join(", ");
        if let Some(building) = &layout.building {
            let clearance = metres(building.clearance);
            self.line(format!("building [{}] clearance {clearance}", polygon(&building.polygon)));
        }
        for obstacle in &layout.obstacles {
            let clearance = metres(obstacle.clearance);
            self.line(format!("obstacle {} [{}] clearance {clearance}", obstacle.name, polygon(&obstacle.polygon)));
            let side = match obstacle.side {
                Side::Left => "left",
                Side::Right => "right",
                Side::Either => "either",
            };
            self.line(format!("pass {} {side}", obstacle.name));
        }
    }

    fn equipment(&mut self, layout: &Layout, names: &[&str]) {
        let section = |i: usize| section_text(i, names);
        let place = |p: &StraightPlace| format!("on {} at {}", section(p.section), metres(p.at));
        let row = |r: &PlaceRow| {
            let (from, every) = (metres(r.place.at), metres(r.every));
            format!("on {} from {from} every {every} count {}", section(r.place.section), r.count)
        };
        let equipment = &layout.equipment;
        for level in &layout.levels {
            self.line(format!("level {}..{} {}", names[level.from], names[level.to], metres(level.height)));
        }
        for ramp in &layout.ramps {
            let mut text = format!("ramp {}..{}", names[ramp.section], names[layout.next(ramp.last)]);
            let parts = [
                ("from", ramp.from.map(metres)),
                ("slope", ramp.slope.map(number)),
                ("radius", ramp.radius.map(metres)),
            ];
            for (word, value) in parts {
                if let Some(value) = value {
                    let _ = write!(text, " {word} {value}");
                }
            }
            self.line(text);
        }
        if let Some(start) = &equipment.start {
            self.line(format!("start {}", place(start)));
        }
        if let Some(photocell) = &equipment.photocell {
            self.line(format!("photocell {}", place(photocell)));
        }
        let own = |name: &str| equipment.declared.iter().all(|declared| declared.name != name);
        for induction in equipment.inductions.iter().filter(|induction| own(&induction.name)) {
            self.line(format!("induction {} {}", induction.name, place(&induction.place)));
        }
        for chutes in equipment.chutes.iter().filter(|chutes| own(&chutes.name)) {
            self.line(format!("chutes {} {}", chutes.name, row(&chutes.row)));
        }
        self.declared(layout);
        match &equipment.motors {
            Motors::Evenly { count } => self.line(format!("motors {count} evenly")),
            Motors::Rows(rows) => rows.iter().for_each(|r| self.line(format!("motors {}", row(r)))),
        }
        self.capacity(layout);
        self.choice(&layout.choice, &layout.equipment);
        if let Some(supports) = &equipment.supports {
            self.line(format!("supports every {}", metres(supports.value)));
        }
        self.line(format!("sensor_cart at cart {}", equipment.sensor_cart));
        if layout.chain.tension_is_said {
            self.line(format!("chain tension {}", unit(layout.chain.tension, "N")));
        }
        if let Some(closes) = &layout.chain.closes_within {
            self.line(format!("chain closes within {}", metres(closes.value)));
        }
        for effect in &layout.effects {
            let known = effect_definitions::named(&effect.name);
            let strength = |(name, value): &(String, f64)| {
                let unit = effect_definitions::spelled(known.and_then(|e| e.unit(name)).unwrap_or(""));
                format!("{name}: {} {unit}", number(*value)).trim_end().to_owned()
            };
            let strengths: Vec<String> = effect.strengths.iter().map(strength).collect();
            self.line(format!("effect {}({})", effect.name, strengths.join(", ")));
        }
    }
}

impl Printer {
    fn drawing(&mut self, drawing: &DrawingSettings) {
        for axis in &drawing.axes {
            let coordinate = if axis.coordinate == Coordinate::X { "x" } else { "y" };
            self.line(format!("axis {} {coordinate} = {}", quoted(&axis.name), metres(axis.at)));
        }
        if drawing.origin != Point::default() {
            self.line(format!("drawing origin {}", point(drawing.origin)));
        }
        let title = &drawing.title;
        let fields = [
            ("project", &title.project),
            ("number", &title.number),
            ("revision", &title.revision),
            ("date", &title.date),
            ("author", &title.author),
            ("checked", &title.checked),
            ("approved", &title.approved),
        ];
        for (word, text) in fields.into_iter().filter(|(_, text)| !text.is_empty()) {
            self.line(format!("drawing {word} {}", quoted(text)));
        }
    }
}

fn constraint_text(constraint: &Constraint, layout: &Layout, names: &[&str]) -> String {
    match &constraint.kind {
        ConstraintKind::FixSection { target, kinds } => {
            let words: Vec<&str> = kinds
                .iter()
                .map(|k| match k {
                    FixKind::Length => "length",
                    FixKind::Rotation => "rotation",
                    FixKind::Parallel => "parallel",
                    FixKind::Perpendicular => "perpendicular",
                })
                .collect();
            let words = if words.len() == 4 { "all".to_string() } else { words.join(", ") };
            format!("fix {words} {}", target_text(*target, names))
        }
        ConstraintKind::Holds { section, part } => format!("{} on {}", part_text(part), section_text(*section, names)),
        ConstraintKind::FixVertex { vertex } => format!("fix {}", names[*vertex]),
        ConstraintKind::FixRadius { vertex } => format!("fix radius {}", names[*vertex]),
        ConstraintKind::Require { formula, low, high, unit } => {
            let dimension = Dimension::of(*unit, formula);
            let shown = |value: f64| formula::constant(value, dimension);
            let formula = formula::text(formula, dimension, layout, names);
            let row = if low == high {
                format!("{formula} == {}", shown(*low))
            } else if high.is_infinite() {
                format!("{formula} >= {}", shown(*low))
            } else if low.is_infinite() {
                format!("{formula} <= {}", shown(*high))
            } else {
                format!("{} <= {formula} <= {}", shown(*low), shown(*high))
            };
            let reason = constraint.reason.as_ref().map(|r| format!(" {}", quoted(r))).unwrap_or_default();
            format!("require {row}{reason}")
        }
    }
}

/// A `require` as it is read.
pub struct Required {
    /// What it limits: `length(P7..P8)`.
    pub measured: String,
    /// `length(P7..P8) >= 18 m`, or `radius(P4) == radius(P5)` where a difference is limited by nothing.
    pub relation: String,
    /// Whether it is such a difference.
    pub difference: bool,
}

/// A `require` of a layout in the words of the language, without its reason; `None` for other constraints.
pub fn required(constraint: &Constraint, layout: &Layout) -> Option<Required> {
    let ConstraintKind::Require { formula, low, high, unit } = &constraint.kind else { return None };
    let names: Vec<&str> = layout.vertices.iter().map(|vertex| vertex.name.as_str()).collect();
    let dimension = Dimension::of(*unit, formula);
    let text = |formula: &Formula| formula::text(formula, dimension, layout, &names);
    // What was worked out is told without what rounding left.
    let rounded = |value: f64| (value * 1e9).round() / 1e9;
    let limit = |value: f64| match unit {
        Unit::Radian => self::unit(rounded(value.to_degrees()), "deg"),
        _ => formula::constant(rounded(value), dimension),
    };
    let measured = text(formula);
    let sign = if low == high {
        "=="
    } else if low.is_finite() {
        ">="
    } else {
        "<="
    };
    let only = if low.is_finite() { *low } else { *high };
    let two = low != high && low.is_finite() && high.is_finite();
    let sides = match formula {
        Formula::Sum(terms) if only == 0.0 && !two => match terms.as_slice() {
            [a, Formula::Negative(b)] => Some(format!("{} {sign} {}", text(a), text(b))),
            _ => None,
        },
        _ => None,
    };
    let difference = sides.is_some();
    let relation = sides.unwrap_or_else(|| match two {
        true => format!("{} <= {measured} <= {}", limit(*low), limit(*high)),
        false => format!("{measured} {sign} {}", limit(only)),
    });
    Some(Required { measured, relation, difference })
}

/// `section chutes 40 m within (0 m, 30 m)..(80 m, 30 m)`
fn part_text(part: &TrackSection) -> String {
    let point = |p: Point| format!("({}, {})", metres(p.x), metres(p.y));
    let length = part.length.map(|length| format!("{} within ", metres(length))).unwrap_or_default();
    let way = if part.either_way { " either way" } else { "" };
    format!("section {} {length}{}..{}{way}", part.name, point(part.from), point(part.to))
}

/// `optimise cost within length + 0.5 %`
pub fn objective(objective: &Objective) -> String {
    if objective.total_price {
        return "optimise total_price".to_owned();
    }
    let word = |goal: Goal| match goal {
        Goal::Length => "length",
        Goal::Cost => "cost",
        Goal::PolygonAction => "polygon_action",
    };
    let terms: Vec<String> = objective
        .terms
        .iter()
        .map(|(weight, goal)| match *weight == 1.0 {
            true => word(*goal).to_string(),
            false => format!("{} * {}", number(*weight), word(*goal)),
        })
        .collect();
    let terms = if terms.is_empty() { "nothing".to_string() } else { terms.join(" + ") };
    match objective.within {
        Some((goal, ratio)) => format!("optimise {terms} within {} + {}", word(goal), share(ratio)),
        None => format!("optimise {terms}"),
    }
}

/// `0.5 %`, where that is the same number; else `0.0050000001`.
fn share(ratio: f64) -> String {
    let percent = trimmed(100.0 * ratio, 6);
    match percent.parse::<f64>() {
        Ok(read) if read * 0.01 == ratio => format!("{percent} %"),
        _ => number(ratio),
    }
}

fn section_text(from: usize, names: &[&str]) -> String {
    format!("{}..{}", names[from], names[(from + 1) % names.len()])
}

fn target_text(target: Target, names: &[&str]) -> String {
    let section = section_text(target.from, names);
    if target.straight { format!("straight({section})") } else { section }
}

/// The shortest digits that give the same number again; no negative zero.
fn number(value: f64) -> String {
    format!("{}", value + 0.0)
}

fn unit(value: f64, unit: &str) -> String {
    format!("{} {unit}", number(value))
}

fn metres(value: f64) -> String {
    unit(value, "m")
}

/// In degrees when reading them gives the same angle again, else in radians.
fn degrees(value: f64) -> String {
    let short = (value * (180.0 / trig::PI) * 1e9).round() / 1e9;
    match short * (trig::PI / 180.0) == value {
        true => unit(short, "deg"),
        false => unit(value, "rad"),
    }
}

fn range(interval: Interval, show: fn(f64) -> String) -> String {
    format!("{} .. {}", show(interval.low), show(interval.high))
}

fn list(lengths: &[f64]) -> String {
    format!("[{}]", lengths.iter().map(|l| metres(*l)).collect::<Vec<_>>().join(", "))
}

fn point(p: Point) -> String {
    format!("({}, {})", metres(p.x), metres(p.y))
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
