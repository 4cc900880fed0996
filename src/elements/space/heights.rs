//! Which height each section has, and where the track climbs from one to the next.

use super::climb::{Climb, Misfit, climb};
use super::{Leg, flat};
use crate::base::number::trimmed;
use crate::diagnostic::{Code, Diagnostic};
use crate::elements::Shape;
use crate::model::{Catalog, Layout, Level, Ramp};
use crate::source::Span;

/// A plan's legs in space from its first levelled section on, that section's height, and what could not be climbed.
pub fn raise(layout: &Layout, plan: &[(usize, Shape)]) -> (Vec<Leg>, f64, Vec<Diagnostic>) {
    let (given, mut said) = sections(layout);
    let n = layout.vertices.len();
    // Legs of climbs by the section they begin on, and the sections they take in.
    let mut climbs: Vec<Option<Vec<Leg>>> = vec![None; n];
    let mut inside = vec![false; n];
    for (between, rise, next) in changes(layout, &given) {
        match gap(layout, plan, (&between, rise, next)) {
            Ok((run, legs)) => {
                for section in &run {
                    inside[*section] = true;
                }
                if let Some(first) = run.first() {
                    climbs[*first] = Some(legs);
                }
            }
            Err(diagnostic) => said.push(*diagnostic),
        }
    }
    let ramped = |ramp: &&Ramp| !climbs.iter().enumerate().any(|(i, legs)| legs.is_some() && i == ramp.section);
    if said.is_empty() {
        for ramp in layout.ramps.iter().filter(ramped) {
            said.push(
                Diagnostic::new(
                    Code::E0410,
                    "this ramp leads from a height to the same one",
                    ramp.span,
                    "nothing to climb",
                )
                .help("give the sections before and behind it different levels, or remove the ramp"),
            );
        }
    }
    // No climb takes in a levelled section, so that from one on every climb is whole.
    let anchor = given.iter().position(Option::is_some).unwrap_or(0);
    let turn = plan.iter().position(|(vertex, shape)| *vertex == anchor && matches!(shape, Shape::Straight { .. }));
    let mut legs = Vec::new();
    for (vertex, shape) in plan.iter().cycle().skip(turn.unwrap_or(0)).take(plan.len()) {
        let curve = matches!(shape, Shape::Curve { .. });
        if !curve && let Some(run) = &climbs[*vertex] {
            legs.extend(run.iter().copied());
        } else if !taken(&inside, &climbs, *vertex, curve, n) {
            legs.push(flat(*vertex, *shape));
        }
    }
    (legs, given[anchor].map_or(0.0, |level| level.height), said)
}

/// Whether a climb that begins on an earlier section already has this piece. A curve is its when both sections beside
/// it are.
fn taken(inside: &[bool], climbs: &[Option<Vec<Leg>>], vertex: usize, curve: bool, n: usize) -> bool {
    let before = (vertex + n - 1) % n;
    if curve {
        inside[before] && inside[vertex] && climbs[vertex].is_none()
    } else {
        inside[vertex] && climbs[vertex].is_none()
    }
}

/// The level of each section, if it has one.
pub fn sections(layout: &Layout) -> (Vec<Option<&Level>>, Vec<Diagnostic>) {
    let mut given: Vec<Option<&Level>> = vec![None; layout.vertices.len()];
    let mut said = Vec::new();
    for level in &layout.levels {
        let mut i = level.from;
        // From a vertex to itself is the whole loop.
        loop {
            match given[i] {
                Some(other) if other.height != level.height => {
                    let section = layout.section_name(i);
                    said.push(
                        Diagnostic::new(
                            Code::E0411,
                            format!("{section} has two heights"),
                            level.span,
                            "another height",
                        )
                        .related(other.span, "its first height")
                        .help("let one of the two runs end where the other begins"),
                    );
                    break;
                }
                _ => given[i] = Some(level),
            }
            i = layout.next(i);
            if i == level.to {
                break;
            }
        }
    }
    (given, said)
}

/// How the track gets from one level to the next.
pub struct Way {
    /// Sections that the climb takes in.
    pub run: Vec<usize>,
    /// From the begin of the first straight, m.
    pub from: Option<f64>,
    /// Rise over run, unsigned; `None`: as gently as the run allows.
    pub slope: Option<f64>,
    /// The catalogue's limit.
    pub steepest: Option<f64>,
    /// Of the vertical curves, to be tried in this order, m.
    pub radii: Vec<f64>,
    /// The line to blame.
    pub span: Span,
}

/// Each change of level of a layout: the sections between the two, the rise, m, and the level that is reached.
pub fn changes<'a>(layout: &Layout, given: &[Option<&'a Level>]) -> Vec<(Vec<usize>, f64, &'a Level)> {
    let n = layout.vertices.len();
    let levelled: Vec<(usize, &Level)> = (0..n).filter_map(|i| given[i].map(|level| (i, level))).collect();
    let after = levelled.iter().cycle().skip(1);
    let pairs = levelled.iter().zip(after).filter(|((_, a), (_, b))| a.height != b.height);
    pairs
        .map(|((i, a), (j, b))| {
            let between = (1..=(j + n - i - 1) % n).map(|d| (i + d) % n).collect();
            (between, b.height - a.height, *b)
        })
        .collect()
}

/// The way over the sections between two levels. `straight` is the length of a section's straight, m.
pub fn way(
    layout: &Layout,
    straight: &dyn Fn(usize) -> f64,
    (between, rise, next): (&[usize], f64, &Level),
) -> Result<Way, Box<Diagnostic>> {
    let n = layout.vertices.len();
    let mut ramps = layout.ramps.iter().filter(|ramp| between.contains(&ramp.section));
    let (ramp, second) = (ramps.next(), ramps.next());
    let span = ramp.map_or(next.span, |r| r.span);
    if let Some(second) = second {
        let diagnostic = Diagnostic::new(Code::E0410, "two ramps for one change of height", second.span, "the second")
            .related(span, "the first")
            .help("give the sections between them a level, or remove one");
        return Err(Box::new(diagnostic));
    }
    if between.is_empty() {
        let help =
            "end one of the levels a section earlier: the section left without a level is where the track climbs";
        return refuse(
            span,
            format!("the height changes by {} with no section to climb on", metres(rise)),
            "no room to climb",
            help.into(),
        );
    }
    let run: Vec<usize> = match ramp {
        Some(ramp) => (0..=(ramp.last + n - ramp.section) % n).map(|d| (ramp.section + d) % n).collect(),
        // The longest straight.
        None => between.iter().copied().max_by(|a, b| straight(*a).total_cmp(&straight(*b))).into_iter().collect(),
    };
    if run.iter().any(|section| !between.contains(section)) {
        return refuse(
            span,
            "the ramp reaches into a section that has a level".into(),
            "climbs on a level",
            "end the ramp, or begin the level, at another vertex".into(),
        );
    }
    let (steepest, radii) = limits(&layout.catalog, run.len() > 1);
    let slope = ramp.and_then(|r| r.slope);
    if let (Some(slope), Some(steepest)) = (slope, steepest)
        && slope > steepest + 1e-12
    {
        return refuse(
            span,
            format!("a slope of {slope} is steeper than the catalogue's {steepest}"),
            "too steep",
            format!("write a slope of at most {steepest}"),
        );
    }
    let radii = match ramp.and_then(|r| r.radius) {
        Some(radius) => vec![radius],
        None => radii,
    };
    if radii.is_empty() {
        return refuse(
            span,
            "the catalogue has no vertical curves".into(),
            "cannot climb",
            "add a `vertical` group to the catalogue, or write the ramp's radius and slope".into(),
        );
    }
    // A single straight climbs as steeply as may be; a run of them as gently.
    let slope = if run.len() > 1 { slope } else { slope.or(steepest) };
    Ok(Way { run, from: ramp.and_then(|r| r.from), slope, steepest, radii, span })
}

/// The climb between two levels: the sections it takes in, and its legs.
fn gap(
    layout: &Layout,
    plan: &[(usize, Shape)],
    (between, rise, next): (&[usize], f64, &Level),
) -> Result<(Vec<usize>, Vec<Leg>), Box<Diagnostic>> {
    let straight = |section: usize| {
        plan.iter()
            .find(|(vertex, shape)| *vertex == section && matches!(shape, Shape::Straight { .. }))
            .map_or(0.0, |(_, shape)| shape.length())
    };
    let way = way(layout, &straight, (between, rise, next))?;
    let pieces = pieces(plan, &way.run, layout);
    let mut worst = Misfit::TooLong(0.0);
    for radius in way.radii {
        match climb(&pieces, &Climb { rise, radius, slope: way.slope, from: way.from }) {
            Ok((legs, used)) => match way.steepest.filter(|s| used > s + 1e-9) {
                None => return Ok((way.run, legs)),
                Some(steepest) => worst = Misfit::TooSteep { used, steepest },
            },
            Err(misfit) => worst = misfit,
        }
    }
    let (message, label, help) = match worst {
        Misfit::TooLong(missing) if missing > 0.0 => (
            format!("climbing {} does not fit on its straight: {} are missing", metres(rise), metres(missing)),
            "does not fit",
            "lengthen the straight, or write a steeper slope, a smaller radius or an earlier `from`".to_string(),
        ),
        Misfit::TooLong(_) => (
            format!("climbing {} does not fit between these sections at any slope", metres(rise)),
            "does not fit",
            "take in more sections, or write a smaller radius".to_string(),
        ),
        Misfit::IntoCurve(missing) => (
            format!("a vertical curve would reach {} into a horizontal one", metres(missing)),
            "does not fit",
            "vertical curves lie on straights: change `from`, the slope or the radius".to_string(),
        ),
        Misfit::TooSteep { used, steepest } => (
            format!("climbing {} here takes a slope of {}", metres(rise), trimmed(used, 3)),
            "too steep",
            format!("the catalogue allows {steepest}: lengthen the run"),
        ),
    };
    refuse(way.span, message, label, help)
}

fn refuse<T>(span: Span, message: String, label: &str, help: String) -> Result<T, Box<Diagnostic>> {
    Err(Box::new(Diagnostic::new(Code::E0410, message, span, label.to_owned()).help(help)))
}

fn metres(length: f64) -> String {
    format!("{} m", trimmed(length, 3))
}

/// Steepest slope and the radii of vertical curves, from the largest, as far as the catalogue says.
fn limits(catalog: &Catalog, spiral: bool) -> (Option<f64>, Vec<f64>) {
    let vertical = catalog.vertical.as_ref();
    let steepest = match (spiral, &catalog.spiral) {
        (true, Some(spirals)) => Some(vertical.map_or(spirals.steepest, |v| v.steepest.min(spirals.steepest))),
        _ => vertical.map(|v| v.steepest),
    };
    let mut radii = vertical.map_or_else(Vec::new, |v| v.radii.clone());
    radii.reverse();
    (steepest, radii)
}

/// The plan's pieces from the first section's straight to the last one's.
fn pieces(plan: &[(usize, Shape)], run: &[usize], layout: &Layout) -> Vec<(usize, Shape)> {
    let of = |vertex: usize, curve: bool| {
        plan.iter().find(|(v, shape)| *v == vertex && matches!(shape, Shape::Curve { .. }) == curve).copied()
    };
    let mut pieces = Vec::new();
    for (k, section) in run.iter().enumerate() {
        pieces.extend(of(*section, false));
        if k + 1 < run.len() {
            pieces.extend(of(layout.next(*section), true));
        }
    }
    pieces
}
