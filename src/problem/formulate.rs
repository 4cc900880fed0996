//! A checked layout to its optimisation problem.

use super::formula::Places;
use super::measures::{radius, to_variables, x, y};
use super::{ConstraintRow, Function, Keepout, Problem, Scope};
use crate::elements::{self, Length};
use crate::geometry::clearance::Region;
use crate::geometry::{Point, Track};
use crate::model::{
    self, Constraint, ConstraintKind, FixKind, Formula, Goal, Heights, Interval, Layout, Motors, Side, StraightPlace,
    Target, TrackSection, Unit,
};
use crate::placement::{self, Need};
use crate::source::Span;

impl Problem {
    /// States the problem of one stage. Fixed values are the written ones.
    pub fn new(layout: &Layout, scope: Scope) -> Self {
        let corners = layout.corners();
        let track = Track::new(&corners);
        let n = corners.len();
        let start = to_variables(&corners);
        let free = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };
        let bounds = (0..n).flat_map(|_| [free, free, layout.radii.value]).collect();
        let mut problem = Problem {
            layout: layout.name.clone(),
            aim: super::Aim::Length,
            minimises: minimises(layout),
            vertices: layout.vertices.iter().map(|v| v.name.clone()).collect(),
            signs: track.fillets.iter().map(|f| if f.turn < 0.0 { -1.0 } else { 1.0 }).collect(),
            start,
            bounds,
            rows: Vec::new(),
            rotations: Vec::new(),
            keepouts: keepouts(layout, &track, scope),
            elastic: None,
            lifted: false,
            half_width: layout.width.value / 2.0,
            heights: Heights::new(n, &layout.levels),
            headroom: layout.catalog.headroom,
            places: Places {
                obstacles: layout.obstacles.iter().map(|o| o.polygon.clone()).collect(),
                building: layout.building.as_ref().map(|b| b.polygon.clone()),
            },
        };
        for (i, vertex) in layout.vertices.iter().enumerate() {
            let turns = layout.turns.value;
            problem.row(
                Function::Turn(i),
                turns.low,
                turns.high,
                Unit::Radian,
                format!("turn at {}", vertex.name),
                vertex.span,
            );
        }
        for (i, vertex) in layout.vertices.iter().enumerate() {
            let label = format!("straight {}", problem.section_name(i));
            let shortest = layout.catalog.straight.shortest;
            problem.row(Function::Straight(i), shortest, f64::INFINITY, Unit::Metre, label, vertex.span);
        }
        problem.make_room(layout);
        if !layout.objective.terms.is_empty() {
            problem.equip(layout, &track);
        }
        // A layout that is compiled as written climbs or does not; building says which.
        if !layout.objective.terms.is_empty() {
            problem.climb(layout, &track);
        }
        for constraint in &layout.constraints {
            problem.constrain(constraint, &track);
        }
        problem
    }

    /// `P4..P5`
    pub fn section_name(&self, i: usize) -> String {
        format!("{}..{}", self.vertices[i], self.vertices[(i + 1) % self.vertices.len()])
    }

    /// Equipment needs the straight that it is placed on.
    fn make_room(&mut self, layout: &Layout) {
        let equipment = &layout.equipment;
        let one = |name: String, place: &StraightPlace| (name, *place, 0.0);
        let along = |name: String, row: &model::PlaceRow, length: f64| {
            (name, row.place, row.every * row.count.saturating_sub(1) as f64 + length)
        };
        let mut wanted = Vec::new();
        wanted.extend(equipment.start.iter().map(|p| one("start".into(), p)));
        wanted.extend(equipment.photocell.iter().map(|p| one("photocell".into(), p)));
        // What is of a declared kind is told of below, and free to move.
        let own = |name: &str| equipment.declared.iter().all(|declared| declared.name != name);
        let inductions = equipment.inductions.iter().filter(|i| own(&i.name));
        wanted.extend(inductions.map(|i| one(format!("induction {}", i.name), &i.place)));
        for chutes in equipment.chutes.iter().filter(|c| own(&c.name)) {
            wanted.extend(chutes.rows().map(|row| along(format!("chutes {}", chutes.name), row, 0.0)));
        }
        for declared in &equipment.declared {
            let room = 0.5 * declared.of.stretch + declared.of.from_curve;
            let name = format!("{} {}", declared.of.kind.word(), declared.name);
            wanted.extend(declared.given().last().map(|place| (name, *place, room)));
        }
        if let Motors::Rows(rows) = &equipment.motors {
            wanted.extend(rows.iter().map(|row| along("motors".into(), row, layout.drive.motor.length)));
        }
        for (name, place, length) in wanted {
            let label = format!("room for {name} on the straight {}", self.section_name(place.section));
            let function = Function::Straight(place.section);
            self.row(function, place.at + length, f64::INFINITY, Unit::Metre, label, place.span);
        }
    }

    /// What is placed freely needs straights that are long enough in all.
    fn equip(&mut self, layout: &Layout, track: &Track) {
        for Need { sections, low, label, span } in placement::needs(layout, track) {
            let function = match sections[..] {
                [section] => Function::Straight(section),
                _ => {
                    let straight = |&from: &usize| Formula::Length(Target { from, straight: true });
                    Function::Formula(Formula::Sum(sections.iter().map(straight).collect()))
                }
            };
            self.row(function, low, f64::INFINITY, Unit::Metre, label, span);
        }
    }

    /// Climbs need theirs.
    fn climb(&mut self, layout: &Layout, track: &Track) {
        for room in elements::rooms(layout, track) {
            let function = match room.what {
                Length::Straight(section) => Function::Straight(section),
                Length::Run(formula) => Function::Formula(formula),
            };
            self.row(function, room.low, room.high, Unit::Metre, room.label, room.span);
        }
    }

    fn row(&mut self, function: Function, low: f64, high: f64, unit: Unit, label: String, span: Span) {
        self.rows.push(ConstraintRow { function, low, high, unit, weight: None, label, span, reason: None });
    }

    fn fix(&mut self, variable: usize) {
        let value = self.start[variable];
        self.bounds[variable] = Interval { low: value, high: value };
    }

    fn constrain(&mut self, constraint: &Constraint, track: &Track) {
        let span = constraint.span;
        let first = self.rows.len();
        match &constraint.kind {
            ConstraintKind::FixVertex { vertex } => {
                self.fix(x(*vertex));
                self.fix(y(*vertex));
            }
            ConstraintKind::FixRadius { vertex } => self.fix(radius(*vertex)),
            ConstraintKind::FixSection { target, kinds } => self.fix_section(*target, kinds, track, span),
            ConstraintKind::Holds { section, part } => self.hold(*section, part, span),
            ConstraintKind::Require { formula, low, high, unit } => {
                self.row(Function::Formula(formula.clone()), *low, *high, *unit, "require".into(), span);
            }
        }
        for row in &mut self.rows[first..] {
            row.reason = constraint.reason.clone();
        }
    }

    /// A section's straight lies on the part's line and reaches over it, or over its length within its limits.
    fn hold(&mut self, i: usize, part: &TrackSection, span: Span) {
        let j = (i + 1) % self.vertices.len();
        // Along an axis of the hall these count as its coordinates do.
        let (along, across) = (onwards(part.direction()), onwards(part.direction().left()));
        let backwards = along.dot(part.direction()) < 0.0;
        // Where several parts lie on one straight, the first holds its line.
        let held = self.rotations.contains(&i);
        let mut row = |function, low, high, what: &str| {
            self.row(function, low, high, Unit::Metre, format!("{what} of section {}", part.name), span);
        };
        let offset = across.dot(part.from);
        if !held {
            row(Function::advance(i, j, across), 0.0, 0.0, "one end off the line");
            let begin = vec![(x(i), across.x), (y(i), across.y)];
            row(Function::Linear(begin), offset, offset, "line");
        }
        let (low, high) = (along.dot(part.from), along.dot(part.to));
        let end = |end| Function::StraightEnd { section: i, end, direction: along };
        let (before, behind) = (f64::NEG_INFINITY, f64::INFINITY);
        match backwards {
            false => {
                row(end(false), before, high - part.length(), "begin");
                row(end(true), low + part.length(), behind, "end");
            }
            true => {
                row(end(false), high + part.length(), behind, "begin");
                row(end(true), before, low - part.length(), "end");
            }
        }
        if part.length.is_some() {
            row(Function::Straight(i), part.length(), f64::INFINITY, "length");
        }
        if !held {
            self.rotations.push(i);
        }
    }

    /// The thesis' five kinds: what is fixed keeps its written value.
    fn fix_section(&mut self, target: Target, kinds: &[FixKind], track: &Track, span: Span) {
        let i = target.from;
        let j = (i + 1) % self.vertices.len();
        let (a, b) = (track.corners[i].point, track.corners[j].point);
        let along = (b - a) * (1.0 / a.distance(b));
        let has = |kind| kinds.contains(&kind);
        let name = if target.straight { format!("straight({})", self.section_name(i)) } else { self.section_name(i) };
        if has(FixKind::Rotation) {
            self.rotations.push(i);
        }
        if !target.straight && kinds.len() == 4 {
            [x(i), y(i), x(j), y(j)].into_iter().for_each(|k| self.fix(k));
            return;
        }
        let across = along.left();
        let mut equal = |function, value, kind: &str| {
            self.row(function, value, value, Unit::Metre, format!("fix {kind} {name}"), span);
        };
        if has(FixKind::Length) {
            if target.straight {
                equal(Function::Straight(i), track.straight(i).length, "length");
            } else if has(FixKind::Rotation) {
                equal(Function::advance(i, j, along), a.distance(b), "length");
            } else {
                equal(Function::Section(i), a.distance(b), "length");
            }
        }
        if has(FixKind::Rotation) {
            equal(Function::advance(i, j, across), 0.0, "rotation");
        }
        for (kind, direction, word) in
            [(FixKind::Parallel, along, "parallel"), (FixKind::Perpendicular, across, "perpendicular")]
        {
            if !has(kind) {
                continue;
            }
            if target.straight {
                let straight = track.straight(i);
                let middle = straight.begin.lerp(straight.end, 0.5);
                equal(Function::StraightMiddle { section: i, direction }, direction.dot(middle), word);
            } else {
                let half = direction * 0.5;
                let terms = vec![(x(i), half.x), (y(i), half.y), (x(j), half.x), (y(j), half.y)];
                equal(Function::Linear(terms), direction.dot(a.lerp(b, 0.5)), word);
            }
        }
    }
}

/// The objective in words.
fn minimises(layout: &Layout) -> &'static str {
    let wants = |goal: Goal| layout.objective.terms.iter().any(|(_, g)| *g == goal);
    if layout.objective.total_price {
        return "price of all that is ordered, EUR, in stage 3; track length, m, in the stages before it";
    }
    if wants(Goal::Cost) && !wants(Goal::PolygonAction) {
        return "price of the pieces, EUR, in stage 3; track length, m, in the stages before it";
    }
    match (wants(Goal::PolygonAction), wants(Goal::Length), layout.objective.within) {
        (true, ..) if wants(Goal::Cost) => {
            "a sum of polygon action, mm², price of the pieces, EUR, and track length, m"
        }
        (true, false, Some((Goal::Cost, _))) => "polygon action, mm², within a budget of cost",
        (true, true, _) => "a sum of track length, m, and polygon action, mm²",
        (true, false, Some(_)) => "polygon action, mm², within a budget of track length",
        (true, false, None) => "polygon action, mm²",
        (false, ..) => "track length, m",
    }
}

fn keepouts(layout: &Layout, track: &Track, scope: Scope) -> Vec<Keepout> {
    let half = layout.width.value / 2.0;
    // A simple loop has its outside to the right of travel when it runs counter-clockwise.
    let turned: f64 = track.fillets.iter().map(|f| f.turn).sum();
    let outside = if turned < 0.0 { 1.0 } else { -1.0 };
    let building = layout.building.iter().map(|b| Keepout {
        name: "building".into(),
        region: Region { polygon: b.polygon.clone(), outside: true, lies: outside },
        distance: half + b.clearance,
        span: b.span,
    });
    let obstacles = layout.obstacles.iter().filter(|_| scope == Scope::Obstacles).map(|o| Keepout {
        name: o.name.clone(),
        region: Region {
            polygon: o.polygon.clone(),
            outside: false,
            lies: if o.side == Side::Right { -1.0 } else { 1.0 },
        },
        distance: half + o.clearance,
        span: o.span,
    });
    building.chain(obstacles).collect()
}

/// A direction or its opposite: the one whose larger part goes the way that coordinates grow.
fn onwards(direction: Point) -> Point {
    let larger = if direction.x.abs() >= direction.y.abs() { direction.x } else { direction.y };
    if larger < 0.0 { direction * -1.0 } else { direction }
}
