//! What changed between two solved layouts: in what they mean, not in how their text stands.

mod beside;
mod equipment;
mod forces;
mod lines;
mod words;

pub use beside::BesideChange;
pub use equipment::{EquipmentChange, Standing};
pub use forces::{ChannelChange, Forces, Moments};

use crate::base::number::tidy;
use crate::compiled::{Compiled, order};
use crate::elements::{self, BillLine, OrderedPiece};
use crate::geometry::Point;
use crate::solve::Status;
use schemars::JsonSchema;
use serde::Serialize;

/// Two solved layouts beside each other: `lss diff --format json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(title = "lss change")]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    pub before: Version,
    pub after: Version,
    /// What is measured of both, in the order of the text; all of it, also where nothing changed.
    pub quantities: Vec<Quantity>,
    /// Statements of the checked layouts, with every default filled in and without regard to order or form, that only one
    /// of them has.
    pub lines: Vec<Line>,
    /// Vertices that moved, have another radius, came or went, as they are built.
    pub vertices: Vec<VertexChange>,
    /// Straights and curves whose length, heading or turn changed, as they are built.
    pub sections: Vec<SectionChange>,
    /// Articles of the track of which there are more or fewer, or which have another price.
    pub bill: Vec<ArticleChange>,
    /// The same of what is ordered beside the track: carts, joints, motors, sensors, supports, equipment, conveyors.
    pub beside: Vec<BesideChange>,
    /// Equipment that stands elsewhere, is of another kind, came or went.
    pub equipment: Vec<EquipmentChange>,
    /// Runs of both, where they are given.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub forces: Option<Forces>,
}

/// One of the two.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Version {
    /// Where it comes from, as the reader named it.
    pub source: String,
    pub layout: String,
    pub status: Status,
}

/// A figure of both layouts.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Quantity {
    pub name: &'static str,
    pub unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub before: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub after: Option<f64>,
    /// Differences from here on are told.
    #[serde(skip)]
    told: f64,
    /// Decimals that are shown.
    #[serde(skip)]
    decimals: usize,
}

/// A statement that came or went.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Line {
    pub change: Change,
    /// The blocks that it stands in, `catalog standard / straight`; empty within the layout itself.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub within: String,
    pub text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    Removed,
    Added,
}

/// Where a vertex is built, or `None` where a layout lacks it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexChange {
    pub name: String,
    /// [x, y, radius], m.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub before_m: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub after_m: Option<[f64; 3]>,
}

impl VertexChange {
    /// Whether it stands elsewhere, is new or is gone; else only its radius is another.
    pub fn is_moved(&self) -> bool {
        let (Some(before), Some(after)) = (self.before_m, self.after_m) else { return true };
        (0..2).any(|axis| (after[axis] - before[axis]).abs() >= TOLD)
    }
}

/// The straight of a section, as it is built.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionChange {
    /// `P4..P5`
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub before: Option<Straight>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub after: Option<Straight>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Straight {
    pub length_m: f64,
    pub heading_deg: f64,
}

/// An article on both bills.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArticleChange {
    pub article: String,
    pub description: String,
    pub before: usize,
    pub after: usize,
    /// What all of them cost, EUR.
    pub before_eur: f64,
    pub after_eur: f64,
}

/// What is ordered costs in all, and where some of it has no price.
const IN_ALL: &str = "price in all";
const PRICED: &str = "price of all that has one";
/// What is not built.
const CLEARANCE: &str = "least clearance";
const GAP: &str = "gap of the proof";

/// What is told of lengths, m: solvers end this near to their rows.
const TOLD: f64 = 2e-6;
/// Of headings, deg.
const TOLD_DEGREES: f64 = 1e-4;

impl Comparison {
    /// Compares two layouts, which are named as the reader named them. Vertices and sections are those of the same name.
    pub fn new((before_source, before): (&str, &Compiled), (after_source, after): (&str, &Compiled)) -> Self {
        Comparison {
            before: Version::new(before_source, before),
            after: Version::new(after_source, after),
            quantities: quantities(before, after),
            lines: lines::changed(&before.layout, &after.layout),
            vertices: vertices(before, after),
            sections: sections(before, after),
            bill: bill(before, after),
            beside: beside::changed(before, after),
            equipment: equipment::changed(before, after),
            forces: None,
        }
    }

    /// The same with runs of both, which change nothing of what the layouts are.
    #[must_use]
    pub fn with_forces(self, forces: Option<Forces>) -> Self {
        Comparison { forces, ..self }
    }

    /// Whether both mean the same and come out the same.
    pub fn is_same(&self) -> bool {
        let is_measured_alike = !self.quantities.iter().any(Quantity::is_changed);
        self.lines.is_empty() && is_measured_alike && self.is_built_alike() && self.before.status == self.after.status
    }

    /// Whether what is built is the same, whatever is written.
    pub fn is_built_alike(&self) -> bool {
        let moved = self.quantities.iter().any(|quantity| quantity.is_built() && quantity.is_changed());
        let is_placed_alike = self.vertices.is_empty() && self.sections.is_empty() && self.equipment.is_empty();
        !moved && is_placed_alike && self.is_billed_alike()
    }

    /// Whether the same is ordered, of the track and beside it.
    pub fn is_billed_alike(&self) -> bool {
        self.bill.is_empty() && self.beside.is_empty()
    }
}

impl Version {
    fn new(source: &str, compiled: &Compiled) -> Self {
        let status = compiled.stages.last().map_or(Status::AsWritten, |stage| stage.status);
        Version { source: source.to_owned(), layout: compiled.layout.name.clone(), status }
    }
}

impl Quantity {
    /// Whether it is of what is built, and not of what is known or demanded of it.
    fn is_built(&self) -> bool {
        ![CLEARANCE, GAP].contains(&self.name)
    }

    pub fn is_changed(&self) -> bool {
        match (self.before, self.after) {
            (Some(before), Some(after)) => (after - before).abs() >= self.told,
            (None, None) => false,
            _ => true,
        }
    }
}

fn quantities(before: &Compiled, after: &Compiled) -> Vec<Quantity> {
    let of = |name, unit, (told, decimals): (f64, usize), value: &dyn Fn(&Compiled) -> Option<f64>| {
        let [before, after] = [before, after].map(|compiled| value(compiled).map(tidy));
        Quantity { name, unit, before, after, told, decimals }
    };
    let count = (0.5, 0);
    let equipped = |c: &Compiled| !c.layout.equipment.declared.is_empty();
    let conveyors = |c: &Compiled| c.placement.placed.iter().filter_map(|p| p.conveyor).sum();
    let mut equipment = vec![
        of("capacity in closed form", "items/h", (0.5, 0), &|c| c.takes().map(|takes| takes.most)),
        of("pieces of equipment", "", count, &|c| equipped(c).then_some(c.placement.placed.len() as f64)),
        of("equipment and conveyors", "EUR", (0.005, 2), &|c| equipped(c).then(|| c.placement.price())),
        of("conveyors", "m", (TOLD, 3), &|c| equipped(c).then(|| conveyors(c))),
    ];
    equipment.retain(|quantity| quantity.before.is_some() || quantity.after.is_some());
    let unpriced = [before, after].iter().any(|c| !order::total(c).unpriced.is_empty());
    let in_all = if unpriced { PRICED } else { IN_ALL };
    // Of other goals there are other gaps.
    let goal = |c: &Compiled| {
        let certificate = c.stages.last().and_then(|stage| stage.certificate.as_ref());
        certificate.map(|certificate| (certificate.counted, certificate.in_all))
    };
    let one_goal = goal(before).zip(goal(after)).is_none_or(|(a, b)| a == b);
    let mut all = vec![
        of("length", "m", (TOLD, 3), &|c| Some(c.length())),
        of("footprint", "m²", (0.005, 2), &|c| Some(c.footprint)),
        of("elements", "", count, &|c| Some(c.bill.count as f64)),
        of("price of the track", "EUR", (0.005, 2), &|c| Some(c.bill.price)),
        of(in_all, "EUR", (0.005, 2), &|c| Some(order::total(c).all)),
        of("mass", "kg", (0.0005, 1), &|c| Some(c.bill.mass)),
        of("carts", "", count, &|c| c.chain.map(|fit| fit.carts as f64)),
        of("left over by the chain", "mm", (0.05, 1), &|c| c.chain.map(|fit| 1e3 * fit.left_over)),
        of(CLEARANCE, "m", (TOLD, 3), &|c| {
            c.contacts.iter().map(|contact| contact.clearance - contact.required).min_by(f64::total_cmp)
        }),
        of(GAP, "%", (0.005, 2), &|c| {
            let certificate = c.stages.last().and_then(|stage| stage.certificate.as_ref());
            certificate.filter(|_| one_goal).map(|certificate| 100.0 * certificate.gap)
        }),
    ];
    all.extend(equipment);
    all
}

/// Pairs what both have by name, in the order of the second; what only the first has comes last.
fn paired<T: Clone>(before: &[(String, T)], after: &[(String, T)]) -> Vec<(String, Option<T>, Option<T>)> {
    let find = |list: &[(String, T)], name: &str| list.iter().find(|own| own.0 == name).map(|own| own.1.clone());
    let kept = after.iter().map(|(name, own)| (name.clone(), find(before, name), Some(own.clone())));
    let gone = before.iter().filter(|own| find(after, &own.0).is_none());
    kept.chain(gone.map(|(name, own)| (name.clone(), Some(own.clone()), None))).collect()
}

fn corners(compiled: &Compiled) -> Vec<(String, [f64; 3])> {
    let corners = compiled.track.corners.iter().map(|c| [c.point.x, c.point.y, c.radius].map(tidy));
    compiled.layout.vertices.iter().map(|vertex| vertex.name.clone()).zip(corners).collect()
}

fn is_moved(a: [f64; 3], b: [f64; 3]) -> bool {
    Point::new(a[0], a[1]).distance(Point::new(b[0], b[1])) >= TOLD || (a[2] - b[2]).abs() >= TOLD
}

/// The vertices of the first as the second calls them: one that only has another name is built as it was.
fn names(before: &Compiled, after: &Compiled) -> Vec<String> {
    let (old, new) = (corners(before), corners(after));
    let in_both = |name: &str| old.iter().any(|own| own.0 == name) && new.iter().any(|own| own.0 == name);
    let renamed = |(name, at): &(String, [f64; 3])| {
        let now = new.iter().find(|(other, there)| !in_both(other) && !is_moved(*at, *there));
        now.filter(|_| !in_both(name)).map_or_else(|| name.clone(), |(other, _)| other.clone())
    };
    old.iter().map(renamed).collect()
}

fn vertices(before: &Compiled, after: &Compiled) -> Vec<VertexChange> {
    let was: Vec<_> = names(before, after).into_iter().zip(corners(before).into_iter().map(|(_, at)| at)).collect();
    paired(&was, &corners(after))
        .into_iter()
        .filter(|(_, a, b)| a.zip(*b).is_none_or(|(a, b)| is_moved(a, b)))
        .map(|(name, before_m, after_m)| VertexChange { name, before_m, after_m })
        .collect()
}

fn sections(before: &Compiled, after: &Compiled) -> Vec<SectionChange> {
    let of = |compiled: &Compiled, names: &[String]| -> Vec<(String, Straight)> {
        (0..names.len())
            .map(|i| {
                let straight = compiled.track.straight(i);
                let heading_deg = tidy(straight.heading.to_degrees());
                // Rounding puts what goes along −x on either side of it.
                let heading_deg = if heading_deg <= -180.0 + TOLD_DEGREES { heading_deg + 360.0 } else { heading_deg };
                let name = format!("{}..{}", names[i], names[(i + 1) % names.len()]);
                (name, Straight { length_m: tidy(straight.length), heading_deg: tidy(heading_deg) })
            })
            .collect()
    };
    let now: Vec<String> = after.layout.vertices.iter().map(|vertex| vertex.name.clone()).collect();
    let is_other = |a: Straight, b: Straight| {
        let turned = (a.heading_deg - b.heading_deg).rem_euclid(360.0);
        (a.length_m - b.length_m).abs() >= TOLD || turned.min(360.0 - turned) >= TOLD_DEGREES
    };
    paired(&of(before, &names(before, after)), &of(after, &now))
        .into_iter()
        .filter(|(_, a, b)| a.zip(*b).is_none_or(|(a, b)| is_other(a, b)))
        .map(|(name, before, after)| SectionChange { name, before, after })
        .collect()
}

fn bill(before: &Compiled, after: &Compiled) -> Vec<ArticleChange> {
    // A piece that is cut to a stock length has the article of the stock, and a line of its own.
    let find = |compiled: &Compiled, own: &BillLine| {
        let mut lines = compiled.bill.lines.iter();
        let found = lines.find(|line| line.article == own.article && line.description == own.description);
        found.map_or((0, 0.0), |line| (line.count, line.price))
    };
    // A bill of both has all lines in the order of bills.
    let pieces: Vec<OrderedPiece> = before.pieces.iter().chain(&after.pieces).cloned().collect();
    let order = elements::bill(&pieces, &after.layout).lines;
    let missing = before
        .bill
        .lines
        .iter()
        .filter(|line| !order.iter().any(|own| own.article == line.article && own.description == line.description));
    let change = |line: &BillLine| {
        let ((was, was_eur), (is, is_eur)) = (find(before, line), find(after, line));
        let (article, description) = (line.article.clone(), line.description.clone());
        ArticleChange { article, description, before: was, after: is, before_eur: was_eur, after_eur: is_eur }
    };
    order
        .iter()
        .chain(missing)
        .map(change)
        .filter(|c| c.before != c.after || (c.before_eur - c.after_eur).abs() >= 0.005)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::{compile, on};
    use crate::model::fixture::rectangle;
    use crate::model::{Chutes, Motors, PlaceRow};

    #[test]
    fn the_same_layout_is_the_same() {
        let own = compile(rectangle(20.0, 12.0, 4.0));
        let found = Comparison::new(("a", &own), ("b", &own));
        assert!(found.is_same() && found.text().contains("nothing changed"), "{found:?}");
    }

    /// Differences of articles add up to that of the whole bills, which are counted apart.
    #[test]
    fn a_moved_vertex_is_billed() {
        let before = compile(rectangle(20.0, 12.0, 4.0));
        let mut layout = rectangle(20.0, 12.0, 4.0);
        layout.vertices[2].point.x += 0.7;
        let after = compile(layout);
        let found = Comparison::new(("a", &before), ("b", &after));
        let own: f64 = found.bill.iter().map(|a| a.after_eur - a.before_eur).sum();
        assert!((own - (after.bill.price - before.bill.price)).abs() < 0.005 && own != 0.0, "{own}");
        let moved: Vec<&str> = found.vertices.iter().map(|v| v.name.as_str()).collect();
        assert_eq!(moved, [after.layout.vertices[2].name.as_str()]);
        let written: Vec<Change> = found.lines.iter().map(|l| l.change).collect();
        assert_eq!(written, [Change::Removed, Change::Added], "{:?}", found.lines);
        // Both sections at the vertex turn or grow, and the turn at the next one shortens what comes after it.
        let straights: Vec<&str> = found.sections.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(straights, ["P1..P2", "P2..P3", "P3..P4"]);
        let longer = found.quantities[0].after.unwrap() - found.quantities[0].before.unwrap();
        assert!((longer - (after.length() - before.length())).abs() < 1e-9);
    }

    /// Another name is a change of the text.
    #[test]
    fn a_renamed_vertex_is_built_as_before() {
        let before = compile(rectangle(20.0, 12.0, 4.0));
        let mut layout = rectangle(20.0, 12.0, 4.0);
        layout.vertices[2].name = "corner".to_owned();
        let renamed = compile(layout.clone());
        let found = Comparison::new(("a", &before), ("b", &renamed));
        assert!(found.is_built_alike() && !found.is_same(), "{found:?}");
        assert!(found.text().contains("what is built is the same"), "{}", found.text());
        // One that moved as well is another vertex.
        layout.vertices[2].point.x += 0.5;
        let found = Comparison::new(("a", &before), ("b", &compile(layout)));
        let names: Vec<&str> = found.vertices.iter().map(|v| v.name.as_str()).collect();
        assert_eq!(names, ["corner", "P3"]);
    }

    #[test]
    fn without_its_building_a_layout_is_built_as_before() {
        let mut layout = rectangle(20.0, 12.0, 4.0);
        let without = compile(layout.clone());
        layout.building = crate::emit::samples::equipped().layout.building;
        let found = Comparison::new(("a", &compile(layout)), ("b", &without));
        assert!(found.is_built_alike() && !found.is_same(), "{found:?}");
        let told = found.text();
        assert!(told.contains("what is built is the same; least clearance changed"), "{told}");
    }

    /// What stands beside the track is on the bill, too.
    #[test]
    fn motors_and_a_longer_row_are_billed() {
        let before = compile(rectangle(20.0, 12.0, 4.0));
        let mut layout = rectangle(20.0, 12.0, 4.0);
        layout.equipment.motors = Motors::Evenly { count: 6 };
        let place = |at: f64| on(0, at);
        layout.equipment.chutes.push(Chutes {
            name: "row_a".to_owned(),
            row: PlaceRow { place: place(2.0), every: 1.5, count: 3 },
            more: Vec::new(),
        });
        let after = compile(layout.clone());
        let found = Comparison::new(("a", &before), ("b", &after));
        let told: Vec<(&str, usize, usize)> = found.beside.iter().map(|c| (c.group, c.before, c.after)).collect();
        assert_eq!(told, [("drive", 4, 6), ("stations", 0, 3)]);
        assert!(found.bill.is_empty() && !found.is_billed_alike() && !found.is_built_alike());
        let came = &found.equipment[0];
        assert_eq!((came.name.as_str(), &came.before, came.moved_m), ("row_a", &None, None));
        assert_eq!(came.after.as_ref().map(|row| row.places_m.len()), Some(3));
        // What only moves is built otherwise, and ordered alike.
        layout.equipment.chutes[0].row.place = place(2.5);
        let found = Comparison::new(("b", &after), ("c", &compile(layout)));
        assert!(found.is_billed_alike() && !found.is_built_alike());
        assert_eq!(found.equipment.iter().map(|e| e.moved_m).collect::<Vec<_>>(), [Some(0.5)]);
        assert!(found.text().contains("3 chutes, from"), "{}", found.text());
    }

    #[test]
    fn markdown_shows_text_as_it_is() {
        let mut layout = rectangle(20.0, 12.0, 4.0);
        layout.name = "a_b*".to_owned();
        let own = compile(layout);
        let text = Comparison::new(("<b>|x", &own), ("@team", &own)).markdown();
        assert!(text.starts_with("### a\\_b\\*: \\<b>\\|x → \\@team\n"), "{text}");
    }
}
