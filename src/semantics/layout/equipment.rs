//! What stands along the track, levels, ramps and effects.

use super::draft::{Draft, Placed};
use super::vertices::Geometry;
use crate::base::number::shortest;
use crate::diagnostic::{Code, Diagnostic};
use crate::model::effect_definitions::{self, EFFECTS};
use crate::model::{Chutes, DeclaredEffect, Equipment, Induction, Level, Motors, PlaceRow, Ramp, StraightPlace};
use crate::semantics::dimension::Dimension;
use crate::semantics::fields::{Bounds, COORDINATE};
use crate::semantics::scope::{Context, Scope};
use crate::source::Spanned;
use crate::syntax::by_likeness;
use crate::syntax::tree::{self, Expr, Statement};

/// Distances along a straight, m.
const ALONG: Bounds = Bounds::between(0.0, 1e5);

impl<'t> Context<'t> {
    /// Everything along the track, unless something of it has a mistake.
    pub(super) fn equipment(&self, draft: &Draft<'t>, geometry: &Geometry<'t>) -> Option<Equipment> {
        let mut equipment = Equipment {
            start: None,
            photocell: None,
            inductions: Vec::new(),
            chutes: Vec::new(),
            motors: Motors::Evenly { count: 0 },
            supports: None,
            sensor_cart: 1,
            declared: Vec::new(),
        };
        let mut rows = Vec::new();
        let mut sound = true;
        for placed in &draft.statements {
            sound &= self.equip(placed, geometry, &mut equipment, &mut rows).is_some();
        }
        if let Some((_, place)) = rows.first() {
            if let Some(evenly) = draft.once("motors") {
                self.report(
                    Diagnostic::new(Code::E0213, "motors are placed evenly and in rows", evenly.span, "evenly")
                        .related(*place, "in a row")
                        .help("remove one of the two"),
                );
                return None;
            }
            equipment.motors = Motors::Rows(rows.into_iter().map(|(row, _)| row).collect());
        }
        let sections = geometry.vertices.as_ref().map_or(0, Vec::len);
        sound = sound && self.fill_zones(draft, &mut equipment, sections).is_some();
        sound &= !sound || self.check_order(draft, &equipment).is_some();
        sound.then_some(equipment)
    }

    /// Adds what one statement places; `None` is a mistake.
    fn equip(
        &self,
        placed: &Placed<'t>,
        geometry: &Geometry<'t>,
        equipment: &mut Equipment,
        rows: &mut Vec<(PlaceRow, crate::source::Span)>,
    ) -> Option<()> {
        match placed.statement {
            Statement::Start(place) => equipment.start = Some(self.along(placed, geometry, place)?),
            Statement::Photocell(place) => equipment.photocell = Some(self.along(placed, geometry, place)?),
            Statement::Induction { name, place } => {
                let place = self.along(placed, geometry, place)?;
                equipment.inductions.push(Induction { name: name.text.clone(), place });
            }
            Statement::Chutes { name, row } => {
                let row = self.row_of(placed, geometry, row)?;
                equipment.chutes.push(Chutes { name: name.text.clone(), row, more: Vec::new() });
            }
            Statement::Equipped(equipped) => equipment.declared.push(self.equipped(placed, geometry, equipped)?),
            Statement::MotorsEvenly { count } => {
                let count = self.count(&placed.env, count, "the number of motors", 0)?;
                equipment.motors = Motors::Evenly { count };
            }
            Statement::MotorsRow(row) => rows.push((self.row_of(placed, geometry, row)?, placed.span)),
            Statement::Supports { every } => {
                let bounds = Bounds::between(0.01, 1e3);
                let every =
                    self.bounded_constant(&placed.env, every, Dimension::LENGTH, "the distance of supports", bounds)?;
                equipment.supports = Some(Spanned::new(every.value, placed.span));
            }
            Statement::SensorCart { cart } => {
                equipment.sensor_cart = self.count(&placed.env, cart, "the number of the cart", 1)?;
            }
            _ => {}
        }
        Some(())
    }

    pub(super) fn along(
        &self,
        placed: &Placed<'t>,
        geometry: &Geometry<'t>,
        place: &'t tree::PlaceExpr,
    ) -> Option<StraightPlace> {
        let section = self.section(&geometry.named, &place.section);
        let at =
            self.bounded_constant(&placed.env, &place.at, Dimension::LENGTH, "the distance along the straight", ALONG);
        Some(StraightPlace { section: section?, at: at?.value, span: placed.span })
    }

    pub(super) fn row_of(
        &self,
        placed: &Placed<'t>,
        geometry: &Geometry<'t>,
        row: &'t tree::RowExpr,
    ) -> Option<PlaceRow> {
        let section = self.section(&geometry.named, &row.section);
        let length = |expr: &'t Expr, what: &str, bounds| {
            self.bounded_constant(&placed.env, expr, Dimension::LENGTH, what, bounds).map(|v| v.value)
        };
        let at = length(&row.from, "the distance along the straight", ALONG);
        let every = length(&row.every, "the distance between two", Bounds::above(0.0, 1e5));
        let count = self.count(&placed.env, &row.count, "the count", 1);
        let place = StraightPlace { section: section?, at: at?, span: placed.span };
        Some(PlaceRow { place, every: every?, count: count? })
    }

    /// Heights of runs of sections.
    pub(super) fn levels(&self, draft: &Draft<'t>, geometry: &Geometry<'t>) -> Option<Vec<Level>> {
        let mut levels = Vec::new();
        let mut sound = true;
        for placed in &draft.statements {
            let Statement::Level { from, to, height } = placed.statement else { continue };
            let (a, b) = (self.vertex(&geometry.named, from), self.vertex(&geometry.named, to));
            let height = self.bounded_constant(&placed.env, height, Dimension::LENGTH, "the height", COORDINATE);
            match (a, b, height) {
                (Some(from), Some(to), Some(height)) => {
                    levels.push(Level { from, to, height: height.value, span: placed.span });
                }
                _ => sound = false,
            }
        }
        sound.then_some(levels)
    }

    /// Ramps; one with a mistake has been reported and is left out.
    pub(super) fn ramps(&self, draft: &Draft<'t>, geometry: &Geometry<'t>) -> Vec<Ramp> {
        let ramp = |placed: &Placed<'t>| {
            let Statement::Ramp { section, from, slope, radius } = placed.statement else { return None };
            let optional = |expr: &'t Option<Expr>, dimension, what: &str, bounds| match expr {
                None => Some(None),
                Some(expr) => self.bounded_constant(&placed.env, expr, dimension, what, bounds).map(|v| Some(v.value)),
            };
            let (begin, end) = (self.vertex(&geometry.named, &section.from), self.vertex(&geometry.named, &section.to));
            let n = geometry.vertices.as_ref().map_or(1, Vec::len);
            let from = optional(from, Dimension::LENGTH, "the distance along the straight", ALONG);
            let slope = optional(slope, Dimension::NONE, "the slope", Bounds::above(0.0, 1.0));
            let radius = optional(radius, Dimension::LENGTH, "the radius", Bounds::above(0.0, 1e3));
            let (begin, end) = (begin?, end?);
            let last = (end + n - 1) % n;
            Some(Ramp { section: begin, last, from: from?, slope: slope?, radius: radius?, span: placed.span })
        };
        draft.statements.iter().filter_map(ramp).collect()
    }

    /// Effects of the library, with strengths that are constants.
    pub(super) fn effects(&self, draft: &Draft<'t>) -> Vec<DeclaredEffect> {
        let effect = |placed: &Placed<'t>| {
            let Statement::Effect(reference) = placed.statement else { return None };
            let name = &reference.name;
            let Some(known) = effect_definitions::named(&name.text) else {
                let diagnostic = Diagnostic::new(
                    Code::E0206,
                    format!("there is no effect `{}`", name.text),
                    name.span,
                    "not known here",
                );
                let sorted = by_likeness(&name.text, EFFECTS.into_iter().map(|e| e.name));
                let listed = sorted.iter().map(|e| format!("`{e}`")).collect::<Vec<_>>().join(", ");
                let names = EFFECTS.into_iter().map(|e| e.name);
                self.report(self.with_nearest(diagnostic.expected(listed, format!("`{}`", name.text)), name, names));
                return None;
            };
            let args = match &reference.args {
                Some(block) => self.arguments(&placed.env, name, block),
                None => Default::default(),
            };
            let strengths = args.into_iter().filter_map(|(arg, (value, _, span))| {
                let strength = known.strengths.iter().find(|s| s.name == &*arg);
                let Some(unit) = strength.map(|s| s.unit).or_else(|| known.place_unit(arg)) else {
                    let all = known.strengths.iter().map(|s| s.name).chain(known.places.iter().map(|p| p.name));
                    let listed: Vec<String> = all.map(|n| format!("`{n}`")).collect();
                    self.report(
                        Diagnostic::new(
                            Code::E0210,
                            format!("`{}` has no `{arg}`", known.name),
                            span,
                            "not a strength of it",
                        )
                        .expected(listed.join(", "), format!("`{arg}`")),
                    );
                    return None;
                };
                let value = self.expect_constant(&value, span, dimension(unit), &format!("`{arg}`"))?;
                if let Some(s) = strength.filter(|s| !(s.low..=s.high).contains(&value)) {
                    let bounds = format!("{} to {} {}", shortest(s.low), shortest(s.high), s.unit);
                    self.report(
                        Diagnostic::new(Code::E0306, format!("`{arg}` is out of range"), span, shortest(value))
                            .expected(bounds.trim_end(), format!("{} {}", shortest(value), s.unit).trim_end()),
                    );
                    return None;
                }
                Some((arg.to_string(), value))
            });
            Some(DeclaredEffect { name: name.text.clone(), strengths: strengths.collect(), span: placed.span })
        };
        draft.statements.iter().filter_map(effect).collect()
    }

    /// A scope without geometry.
    pub(super) fn plain<'a>(&self, placed: &'a Placed<'t>) -> Scope<'a, 't> {
        Scope { env: &placed.env, geometry: None }
    }
}

/// Dimension of an effect's unit.
fn dimension(unit: &str) -> Dimension {
    let power = |x: Dimension, n: i32| (0..n).fold(Dimension::NONE, |all, _| all.times(x).unwrap_or(all));
    // A unit is a product of symbols, with another behind a stroke.
    let product = |text: &str| {
        text.split(' ').fold(Dimension::NONE, |all, symbol| {
            let (symbol, n) = symbol.strip_suffix('²').map_or((symbol, 1), |s| (s, 2));
            let own = match symbol {
                "m" => Dimension::LENGTH,
                "kg" => Dimension::MASS,
                "s" => Dimension::TIME,
                "N" => Dimension::FORCE,
                "rad" => Dimension::ANGLE,
                _ => Dimension::NONE,
            };
            all.times(power(own, n)).unwrap_or(all)
        })
    };
    let (over, under) = unit.split_once('/').unwrap_or((unit, ""));
    product(over).over(product(under)).unwrap_or(Dimension::NONE)
}
