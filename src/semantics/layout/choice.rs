//! What of the components is free, what the drive has to do, and what energy costs.

use super::draft::{Draft, Placed};
use super::{offered, offered_text};
use crate::base::number::{shortest, trimmed};
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{
    Cart, Catalog, Choice, CountPlace, DriveDuty, EnergyUse, Equipment, Free, FreeCount, Freed, Interval, Stands,
};
use crate::semantics::component::{Component, FieldValue};
use crate::semantics::components;
use crate::semantics::dimension::Dimension;
use crate::semantics::fields::{Bounds, FieldSpec, Presence, Shape};
use crate::semantics::program::{Space, mentions};
use crate::semantics::scope::Context;
use crate::semantics::value::{Value, metres};
use crate::source::{Span, Spanned};
use crate::syntax::tree::{DeclarationKind, EquippedPlace, Expr, Item, Name, Reference, Statement};

/// s
const TIME: Bounds = Bounds::above(0.0, 1e5);
const YEAR: f64 = 366.0 * 24.0 * 3600.0;
/// Candidates of one kind, at most.
const MOST: usize = 200;

const SPEEDS: FieldSpec = FieldSpec {
    path: "speed",
    shape: Shape::Numbers("m/s", Bounds::above(0.0, 100.0)),
    presence: Presence::Optional,
    doc: "speeds of the chain",
};
const COUNTS: FieldSpec = FieldSpec {
    path: "count",
    shape: Shape::Numbers("", Bounds::between(1.0, 400.0)),
    presence: Presence::Optional,
    doc: "numbers of equipment",
};
const RADII: FieldSpec = FieldSpec {
    path: "radii",
    shape: Shape::Numbers("m", Bounds::above(0.0, 1e3)),
    presence: Presence::Optional,
    doc: "least radii of the track's curves",
};

impl<'t> Context<'t> {
    /// What is free, unless something of it has a mistake.
    pub(super) fn choice(
        &self,
        draft: &Draft<'t>,
        catalog: Option<&Catalog>,
        equipment: Option<&Equipment>,
    ) -> Option<Choice> {
        let mut choice = Choice::default();
        let mut sound = true;
        for placed in &draft.statements {
            sound &= self.leave_free(placed, catalog, &mut choice).is_some();
            if let Statement::ChooseCount { equipment: names, counts } = placed.statement {
                choice.statements.free.push((Freed::Count, placed.span));
                match self.free_count(draft, placed, names, counts, equipment) {
                    Some(count) if self.is_said_once(names, &count, &choice) => choice.counts.push(count),
                    _ => sound = false,
                }
            }
        }
        sound.then_some(choice)
    }

    /// Adds what one statement says; `None` is a mistake.
    fn leave_free(&self, placed: &Placed<'t>, catalog: Option<&Catalog>, choice: &mut Choice) -> Option<()> {
        let at = &mut choice.statements;
        let number = |expr: &'t Expr, what: &str, dimension, bounds| {
            self.bounded_constant(&placed.env, expr, dimension, what, bounds)
        };
        let optional = |expr: &'t Option<Expr>, what: &str| match expr {
            None => Some(None),
            Some(expr) => number(expr, what, Dimension::TIME, TIME).map(|t| Some(Spanned::new(t.value, placed.span))),
        };
        match placed.statement {
            Statement::Component { kind: DeclarationKind::Cart, .. } => at.cart = Some(placed.span),
            Statement::Component { kind: DeclarationKind::Motor, .. } => at.motor = Some(placed.span),
            Statement::Component { kind: DeclarationKind::TakeUp, .. } => at.take_up = Some(placed.span),
            Statement::Component { kind: DeclarationKind::Sensor, .. } => at.sensor = Some(placed.span),
            Statement::Speed(_) => at.speed = Some(placed.span),
            Statement::MotorsEvenly { .. } | Statement::MotorsRow(_) => at.places.push(placed.span),
            Statement::Radii { .. } => at.radii = Some(placed.span),
            Statement::ChooseCart { carts, lengths } => {
                at.free.push((Freed::Cart, placed.span));
                choice.carts = self.free_carts(placed, carts, lengths.as_ref())?;
            }
            Statement::ChooseMotor { motors, on_straights } => {
                at.free.push((Freed::Motor, placed.span));
                choice.motors = self.free(placed, DeclarationKind::Motor, motors, components::motor)?;
                choice.on_straights = *on_straights;
            }
            Statement::ChooseComponent { kind: DeclarationKind::TakeUp, components: named } => {
                at.free.push((Freed::TakeUp, placed.span));
                choice.take_ups = self.free(placed, DeclarationKind::TakeUp, named, components::take_up)?;
            }
            Statement::ChooseComponent { components: named, .. } => {
                at.free.push((Freed::Sensor, placed.span));
                choice.sensors = self.free(placed, DeclarationKind::Sensor, named, components::sensor)?;
            }
            Statement::ChooseSpeed(values) => {
                at.free.push((Freed::Speed, placed.span));
                choice.speeds = self.free_numbers(placed, &SPEEDS, values)?;
            }
            Statement::ChooseRadii(values) => {
                at.free.push((Freed::Radii, placed.span));
                choice.radii = self.free_numbers(placed, &RADII, values)?;
                let stock = &catalog?.curve.radii;
                let absent = |radius: &&f64| !stock.iter().any(|r| (r - **radius).abs() < 1e-9);
                if let Some(radius) = choice.radii.iter().find(absent) {
                    let message = format!("the catalogue has no radius of {}", metres(*radius));
                    self.report(
                        Diagnostic::new(Code::E0306, message, values.span, "not in the catalogue")
                            .expected(format!("some of {}", offered_text(stock)), metres(*radius)),
                    );
                    return None;
                }
            }
            Statement::Drive { load, starts, stops, spare } => {
                let load = match load {
                    None => Some(0.0),
                    Some(load) => {
                        number(load, "the load", Dimension::MASS, Bounds::between(0.0, 1e5)).map(|load| load.value)
                    }
                };
                let starts = optional(starts, "the time to start");
                let stops = optional(stops, "the time to stop");
                let spare = match spare {
                    None => Some(0),
                    Some(spare) => self.count(&placed.env, spare, "the number of spare motors", 0),
                };
                choice.drive = DriveDuty { load: load?, starts: starts?, stops: stops?, spare: spare? };
            }
            Statement::Energy { price, hours, years } => {
                let price = number(price, "the price of energy", Dimension::ENERGY_PRICE, Bounds::between(0.0, 1.0));
                let running = number(hours, "the time of running in a year", Dimension::TIME, Bounds::above(0.0, YEAR));
                let years = number(years, "the number of years", Dimension::NONE, Bounds::above(0.0, 100.0));
                let (price, running, years) = (price?.value, running?.value, years?.value);
                choice.energy = Some(EnergyUse { price, running, years });
            }
            _ => {}
        }
        Some(())
    }

    fn free_numbers(&self, placed: &Placed<'t>, spec: &FieldSpec, values: &'t Expr) -> Option<Vec<f64>> {
        let Some(FieldValue::Numbers(numbers)) = self.field(&placed.env, spec, values) else { return None };
        if numbers.is_empty() || numbers.len() > MOST {
            let found = format!("{} values", numbers.len());
            self.report(
                Diagnostic::new(
                    Code::E0306,
                    format!("`{}` leaves too few or too many to choose from", spec.path),
                    values.span,
                    &found,
                )
                .expected(format!("1 to {MOST} values"), found.clone()),
            );
            return None;
        }
        Some(numbers)
    }

    /// Numbers of equipment that stands freely.
    fn free_count(
        &self,
        draft: &Draft<'t>,
        placed: &Placed<'t>,
        names: &'t [Name],
        counts: &'t Expr,
        equipment: Option<&Equipment>,
    ) -> Option<FreeCount> {
        let numbers = self.free_numbers(placed, &COUNTS, counts)?;
        if let Some(broken) = numbers.iter().find(|number| number.fract() != 0.0) {
            let found = shortest(*broken);
            self.report(
                Diagnostic::new(Code::E0306, "a number of equipment is not a whole one", counts.span, &found)
                    .expected("whole numbers", found.clone()),
            );
            return None;
        }
        let all = &equipment?.declared;
        let mut free = FreeCount {
            declared: Vec::new(),
            counts: numbers.iter().map(|number| *number as usize).collect(),
            places: Vec::new(),
        };
        for name in names {
            let index = all.iter().position(|declared| declared.name == name.text);
            let stands = index.map(|index| &all[index].stands);
            if !matches!(stands, Some(Stands::Free { .. })) {
                if draft.base_known && !mentions(&draft.bad, &name.text) {
                    let message = format!("the number of `{}` cannot be chosen", name.text);
                    let label = if index.is_some() { "its place is given" } else { "nothing that stands freely" };
                    let diagnostic = Diagnostic::new(Code::E0218, message, name.span, label)
                        .help("let it stand freely: `chutes row of chute at least 20 anywhere`");
                    let known = all.iter().filter(|d| matches!(d.stands, Stands::Free { .. }));
                    self.report(self.with_nearest(diagnostic, name, known.map(|declared| declared.name.as_str())));
                }
                return None;
            }
            free.declared.extend(index);
            free.places.extend(draft.statements.iter().find_map(|placed| self.place_of_count(placed, &name.text)));
        }
        Some(free)
    }

    /// Where the statement of equipment of a name says how many.
    fn place_of_count(&self, placed: &Placed<'t>, name: &str) -> Option<CountPlace> {
        let Statement::Equipped(equipped) = placed.statement else { return None };
        let EquippedPlace::Free { least, .. } = &equipped.place else { return None };
        if equipped.name.text != name {
            return None;
        }
        let (whole, of) = (placed.span, equipped.of.span);
        let behind = of.start + self.sources.text(of).trim_end().len() as u32;
        let (span, word) = match least {
            Some(number) => (number.span, ""),
            None => (Span { start: behind, end: behind, ..whole }, " at least "),
        };
        let text = |start, end| self.sources.text(Span { start, end, ..whole }).to_owned();
        let line = (text(whole.start, span.start), text(span.end, whole.end).trim_end().to_owned());
        Some(CountPlace { span, line, word })
    }

    /// Whether no number is left free twice.
    fn is_said_once(&self, names: &[Name], free: &FreeCount, choice: &Choice) -> bool {
        let before = |k: usize| {
            let others = choice.counts.iter().flat_map(|other| &other.declared);
            others.chain(&free.declared[..k]).any(|known| *known == free.declared[k])
        };
        let Some(name) = (0..free.declared.len()).find(|k| before(*k)).and_then(|k| names.get(k)) else { return true };
        let message = format!("the number of `{}` is left free twice", name.text);
        self.report(
            Diagnostic::new(Code::E0213, message, name.span, "said again").help("name it in one `choose count` line"),
        );
        false
    }

    /// Components of a kind that are named beside each other, all mistakes told.
    fn free<T>(
        &self,
        placed: &Placed<'t>,
        kind: DeclarationKind,
        references: &'t [Reference],
        read: fn(&Component) -> Option<T>,
    ) -> Option<Vec<Free<T>>> {
        let one = |reference: &'t Reference| {
            let component = self.component(&placed.env, kind, reference)?;
            let item = component.complete.then(|| read(&component))??;
            Some(Free { item, written: self.sources.text(reference.span).trim_end().to_owned() })
        };
        let all: Vec<Option<Free<T>>> = references.iter().map(one).collect();
        all.into_iter().collect()
    }

    /// Each family in each of its lengths within the limits. A reference that gives the length, and a family without a
    /// parameter `length`, is one cart.
    fn free_carts(
        &self,
        placed: &Placed<'t>,
        references: &'t [Reference],
        lengths: Option<&'t (Expr, Expr)>,
    ) -> Option<Vec<Free<Cart>>> {
        let limits = match lengths {
            None => Interval { low: 0.0, high: f64::INFINITY },
            Some((low, high)) => {
                let end = |expr: &'t Expr| {
                    self.bounded_constant(
                        &placed.env,
                        expr,
                        Dimension::LENGTH,
                        "the length of a cart",
                        Bounds::above(0.0, 1e3),
                    )
                };
                let (low_value, high_value) = (end(low), end(high));
                let (low_value, high_value) = (low_value?.value, high_value?.value);
                self.ordered(low_value, high_value, low.span.to(high.span), Dimension::LENGTH)?;
                Interval { low: low_value - 1e-9, high: high_value + 1e-9 }
            }
        };
        let mut carts: Vec<Free<Cart>> = Vec::new();
        let mut sound = true;
        for reference in references {
            match self.family(placed, reference, limits) {
                Some(family) => carts.extend(family),
                None => sound = false,
            }
        }
        if sound && carts.len() > MOST {
            let found = format!("{} carts", carts.len());
            self.report(
                Diagnostic::new(Code::E0306, "too many carts to choose from", placed.span, &found)
                    .expected(format!("at most {MOST} carts"), found.clone())
                    .help("narrow the `lengths`"),
            );
            return None;
        }
        sound.then_some(carts)
    }

    fn family(&self, placed: &Placed<'t>, reference: &'t Reference, limits: Interval) -> Option<Vec<Free<Cart>>> {
        let written = self.component(&placed.env, DeclarationKind::Cart, reference)?;
        if !written.complete {
            return None;
        }
        let own = written.number("length")?;
        let offers: Vec<f64> = written.numbers("lengths").map_or_else(|| vec![own], <[f64]>::to_vec);
        let symbol = self.resolve(placed.env.module, Space::Component(DeclarationKind::Cart), &reference.name)?;
        let Item::Declaration(declaration) = self.program.item(symbol) else { return None };
        let parameter = declaration.params.nodes.iter().map(|node| &node.value.name).find(|name| name.text == "length");
        let said = reference.args.iter().flat_map(|args| &args.nodes);
        let said = said.filter_map(|arg| arg.value.name.as_ref()).any(|name| name.text == "length");
        let lengths: Vec<f64> = match parameter {
            Some(_) if !said => offers.clone(),
            _ => vec![own],
        };
        let within: Vec<f64> = lengths.iter().copied().filter(|length| limits.contains(*length)).collect();
        if within.is_empty() {
            let message = format!("`{}` is made in none of these lengths", reference.name.text);
            let found = format!("{} .. {}", metres(limits.low), metres(limits.high));
            self.report(
                Diagnostic::new(Code::E0310, message, placed.span, "none in the product line")
                    .expected(offered(&lengths), found)
                    .related(written.place("lengths"), "the lengths that it is made in"),
            );
            return None;
        }
        let made = within.into_iter().map(|length| {
            let mut args = match &reference.args {
                Some(block) => self.arguments(&placed.env, &reference.name, block),
                None => Default::default(),
            };
            if let Some(name) = parameter.filter(|_| !said) {
                args.insert(&name.text, (Value::constant(length, Dimension::LENGTH), name, reference.span));
            }
            let component = self.instantiate(symbol, declaration, args, reference.name.span)?;
            let cart = component.complete.then(|| components::cart(&component, placed.span))??;
            let text = self.sources.text(reference.span).trim_end();
            let length = format!("length: {} mm", trimmed(length * 1e3, 6));
            let written = match (parameter, text.rsplit_once(')')) {
                (Some(_), None) if !said => format!("{text}({length})"),
                (Some(_), Some((begun, _))) if !said => {
                    let begun = begun.trim_end().trim_end_matches(',');
                    format!("{begun}{}{length})", if begun.ends_with('(') { "" } else { ", " })
                }
                _ => text.to_owned(),
            };
            Some(Free { item: cart, written })
        });
        made.collect()
    }
}
