//! A layout's statements to the model.

mod capacity;
mod checks;
mod choice;
mod constraints;
mod draft;
mod equipment;
mod equipped;
mod objective;
mod route;
mod sheet;
mod vertices;
mod zones;

use std::rc::Rc;

use super::arguments::Arguments;
use super::components;
use super::dimension::Dimension;
use super::fields::Bounds;
use super::program::{Space, Symbol, mentions};
use super::scope::{Context, Env, Scope};
use super::value::{metres, shown};
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Cart, Catalog, ChainDeclaration, Drive, Interval, Layout, Sensor, TakeUp};
use crate::semantics::component::Component;
use crate::semantics::layout::checks::{Facts, Limits};
use crate::source::{Span, Spanned};
use crate::syntax::tree::{DeclarationKind, Expr, Item, LayoutDeclaration, Reference, Statement};
pub use checks::sides::settle as settle_sides;
use draft::{Draft, Placed, keyword};
pub(super) use vertices::Geometry;

impl<'t> Context<'t> {
    /// The checked layout, if it has no mistake.
    pub fn layout(&self, symbol: Symbol, declaration: &'t LayoutDeclaration) -> Option<Layout> {
        let before = self.sink.borrow().errors();
        let draft = self.draft(symbol, declaration, Arguments::new(), declaration.name.span)?;
        self.evaluate_lets(&draft);
        let catalog = self.catalog(&draft);
        let cart = self.cart(&draft);
        let drive = self.drive(&draft);
        let sensor = self.sensor(&draft);
        let speed = self.required(&draft, "speed", Dimension::SPEED, Bounds::above(0.0, 100.0));
        let width = self.required(&draft, "width", Dimension::LENGTH, Bounds::above(0.0, 50.0));
        let chain = self.chain(&draft);
        let take_up = self.take_up(&draft, chain.as_ref());
        let turns = self.limits(&draft, catalog.as_ref(), "turns", Dimension::ANGLE, |c| c.curve.turns);
        let radii = self.limits(&draft, catalog.as_ref(), "radii", Dimension::LENGTH, |c| Interval {
            low: c.curve.radii.first().copied().unwrap_or(0.0),
            high: c.curve.radii.last().copied().unwrap_or(0.0),
        });
        let objective = self.objective(&draft);
        let mut geometry = self.geometry(&draft, radii);
        let route = self.route(&draft, &geometry);
        let constraints = self.constraints(&draft, &geometry).zip(route.as_ref()).map(|(mut all, (_, held))| {
            all.extend(held.iter().cloned());
            all
        });
        let equipment = self.equipment(&draft, &geometry);
        let capacity = equipment.as_ref().and_then(|equipment| self.capacity(&draft, &geometry, equipment));
        let choice = self.choice(&draft, catalog.as_ref(), equipment.as_ref());
        let levels = self.levels(&draft, &geometry);
        let ramps = self.ramps(&draft, &geometry);
        let effects = self.effects(&draft);
        let drawing = self.drawing(&draft);
        if let Some(levels) = &levels {
            let facts = Facts {
                levels,
                limits: Limits::new(turns, radii),
                catalog: catalog.as_ref(),
                objective: objective.as_ref(),
            };
            self.check_geometry(&mut geometry, &facts);
            if let (Some(constraints), Some(vertices)) = (&constraints, &geometry.vertices) {
                self.check_constraints(constraints, vertices, &geometry, &facts);
                self.check_headings(constraints, vertices, &geometry, &facts);
                if let Some(width) = &width {
                    self.check_fixed(constraints, vertices, &geometry, &facts, width.value);
                }
            }
            if let (Some(equipment), Some(track)) = (&equipment, &geometry.track) {
                self.check_equipment(equipment, capacity.as_ref(), &ramps, track, &geometry.named);
            }
        }
        if let (Some(objective), Some(catalog)) = (&objective, &catalog) {
            self.check_prices(objective, catalog);
        }
        if self.sink.borrow().errors() > before || !draft.bad.is_empty() || !draft.base_known {
            return None;
        }
        let mut layout = Layout {
            name: declaration.name.text.clone(),
            span: declaration.name.span,
            catalog: catalog?,
            cart: cart?,
            drive: drive?,
            sensor: sensor?,
            take_up: take_up?,
            speed: speed?,
            width: width?,
            vertices: if draft.once("route").is_some() { Vec::new() } else { geometry.vertices? },
            turns: turns?,
            radii: radii?,
            building: geometry.building,
            obstacles: geometry.obstacles,
            constraints: constraints?,
            equipment: equipment?,
            capacity: capacity?,
            choice: choice?,
            levels: levels?,
            ramps,
            chain: chain?,
            effects,
            drawing: drawing?,
            objective: objective?,
            route: route?.0,
        };
        layout.count_total_price();
        Some(layout)
    }

    /// Every let is evaluated, also one that nothing uses.
    fn evaluate_lets(&self, draft: &Draft<'t>) {
        let mut env = Some(draft.innermost());
        while let Some(here) = env {
            for local in here.locals.values() {
                if let super::scope::Local::Let(slot) = local {
                    self.slot(here, slot, slot.name.span);
                }
            }
            env = here.outer.as_ref();
        }
    }

    fn missing(&self, draft: &Draft<'t>, keyword: &'static str, example: &str) {
        if !draft.base_known || mentions(&draft.bad, keyword) {
            return;
        }
        let message = format!("the layout `{}` has no `{keyword}`", draft.name.text);
        let diagnostic = Diagnostic::new(Code::E0214, message, draft.name.span, "in this layout")
            .expected(format!("a line `{keyword} ...`"), "none")
            .help(format!("for example `{example}`"));
        self.report(match draft.opens {
            Some(opens) => diagnostic.fix(opens, format!("\n  {example}")),
            None => diagnostic,
        });
    }

    /// A statement with one constant that every layout needs.
    fn required(
        &self,
        draft: &Draft<'t>,
        keyword: &'static str,
        dimension: Dimension,
        bounds: Bounds,
    ) -> Option<Spanned<f64>> {
        let Some(placed) = draft.once(keyword) else {
            let example = if keyword == "speed" { "speed 2.0 m/s" } else { "width 1.2 m" };
            self.missing(draft, keyword, example);
            return None;
        };
        let (Statement::Speed(expr) | Statement::Width(expr)) = placed.statement else { return None };
        self.bounded_constant(&placed.env, expr, dimension, &format!("the {keyword}"), bounds)
    }

    /// A constant within bounds, with its place.
    fn bounded_constant(
        &self,
        env: &Rc<Env<'t>>,
        expr: &'t Expr,
        dimension: Dimension,
        what: &str,
        bounds: Bounds,
    ) -> Option<Spanned<f64>> {
        let value = self.constant(Scope { env, geometry: None }, expr, dimension, what)?;
        self.within(value, expr.span, what, dimension, bounds).map(|value| Spanned::new(value, expr.span))
    }

    /// A whole number.
    fn count(&self, env: &Rc<Env<'t>>, expr: &'t Expr, what: &str, least: usize) -> Option<usize> {
        let bounds = Bounds::between(least as f64, 10_000.0);
        let value = self.bounded_constant(env, expr, Dimension::NONE, what, bounds)?.value;
        if value.fract() != 0.0 {
            self.report(
                Diagnostic::new(
                    Code::E0306,
                    format!("{what} is not a whole number"),
                    expr.span,
                    shown(value, Dimension::NONE),
                )
                .expected("a whole number", shown(value, Dimension::NONE)),
            );
            return None;
        }
        Some(value as usize)
    }

    /// The component that a statement names, complete or not at all.
    fn stated(&self, draft: &Draft<'t>, kind: DeclarationKind) -> Option<(Rc<Component>, &'t Reference, Span)> {
        let placed = draft.once(keyword(kind))?;
        let Statement::Component { reference, .. } = placed.statement else { return None };
        let component = self.component(&placed.env, kind, reference)?;
        component.complete.then_some((component, reference, placed.span))
    }

    fn catalog(&self, draft: &Draft<'t>) -> Option<Catalog> {
        if draft.once("catalog").is_none() {
            self.missing(draft, "catalog", "catalog standard");
            return None;
        }
        let (component, _, span) = self.stated(draft, DeclarationKind::Catalog)?;
        let catalog = components::catalog(&component, span)?;
        let place = |path: &str| component.place(path);
        if catalog.curve.radii.is_empty() {
            self.empty(place("curve.radii"), "a catalogue needs at least one radius");
            return None;
        }
        if catalog.straight.stock.is_empty() && catalog.straight.cut.is_none() {
            self.empty(place("straight.stock"), "a catalogue needs stock lengths, or lengths to cut to");
            return None;
        }
        let pieces = catalog.curve.largest / catalog.curve.angle_step;
        if pieces < 1.0 - 1e-9 || (pieces - pieces.round()).abs() > 1e-9 {
            let step = shown(catalog.curve.angle_step, Dimension::ANGLE);
            let found = shown(catalog.curve.largest, Dimension::ANGLE);
            self.report(
                Diagnostic::new(
                    Code::E0306,
                    "the largest curve is not a multiple of the step",
                    place("curve.largest"),
                    &found,
                )
                .expected(format!("a multiple of {step}"), found.clone())
                .related(place("curve.angle_step"), "the step"),
            );
            return None;
        }
        Some(catalog)
    }

    fn empty(&self, span: Span, message: &str) {
        self.report(Diagnostic::new(Code::E0306, message, span, "empty").expected("at least one value", "none"));
    }

    fn cart(&self, draft: &Draft<'t>) -> Option<Cart> {
        if draft.once("cart").is_none() {
            self.missing(draft, "cart", "cart tilt_tray(length: 1250 mm)");
            return None;
        }
        let (component, reference, span) = self.stated(draft, DeclarationKind::Cart)?;
        let cart = components::cart(&component, span)?;
        if let Some(lengths) = component.numbers("lengths")
            && !lengths.iter().any(|l| (l - cart.length).abs() < 1e-9)
        {
            let place = reference
                .args
                .iter()
                .flat_map(|a| &a.nodes)
                .find(|n| n.value.name.as_ref().is_some_and(|n| n.text == "length"))
                .map_or(reference.span, |n| n.value.value.span);
            let near =
                lengths.iter().copied().min_by(|a, b| (a - cart.length).abs().total_cmp(&(b - cart.length).abs()));
            let message = format!("`{}` is not made {} long", component.name, metres(cart.length));
            let mut diagnostic = Diagnostic::new(Code::E0310, message, place, "not in the product line")
                .expected(offered(lengths), metres(cart.length))
                .related(component.place("lengths"), "the lengths that it is made in");
            if let Some(near) = near {
                let near = metres(near);
                diagnostic = diagnostic.help(format!("the nearest is `{near}`"));
                // Without an argument the declaration says its length, for all who use it.
                let declared = component.place("length");
                match place == reference.span {
                    false => diagnostic = diagnostic.fix(place, near),
                    true if declared.file == place.file => diagnostic = diagnostic.fix(declared, near),
                    true => {}
                }
            }
            self.report(diagnostic);
            return None;
        }
        Some(cart)
    }

    fn drive(&self, draft: &Draft<'t>) -> Option<Drive> {
        let drives = self.program.drives;
        let motor = self.stated_or(draft, DeclarationKind::Motor, drives, "linear_motor")?;
        let controller = self.stated_or(draft, DeclarationKind::Controller, drives, "pi")?;
        Some(Drive { motor: components::motor(&motor)?, controller: components::controller(&controller)? })
    }

    fn sensor(&self, draft: &Draft<'t>) -> Option<Sensor> {
        let sensor = self.stated_or(draft, DeclarationKind::Sensor, self.program.sensors, "standard")?;
        components::sensor(&sensor)
    }

    /// What the layout names, if anything: it has to hold the chain's tension.
    fn take_up(&self, draft: &Draft<'t>, chain: Option<&ChainDeclaration>) -> Option<Option<TakeUp>> {
        if draft.once(keyword(DeclarationKind::TakeUp)).is_none() {
            return Some(None);
        }
        let (component, _, span) = self.stated(draft, DeclarationKind::TakeUp)?;
        let take_up = components::take_up(&component)?;
        if let Some((force, tension)) = take_up.force.zip(chain.map(|chain| chain.tension))
            && tension > force
        {
            let (held, found) = (shown(force, Dimension::FORCE), shown(tension, Dimension::FORCE));
            let message = format!("`{}` does not hold the chain's tension", take_up.name);
            let diagnostic = Diagnostic::new(Code::E0306, message, span, format!("holds {held}"))
                .expected(format!("a tension of at most {held}"), found)
                .related(component.place("force"), "what it holds")
                .help("take another take-up, or less `chain tension`");
            self.report(diagnostic);
            return None;
        }
        Some(Some(take_up))
    }

    /// What the layout states, else the standard library's.
    fn stated_or(
        &self,
        draft: &Draft<'t>,
        kind: DeclarationKind,
        module: Option<usize>,
        default: &str,
    ) -> Option<Rc<Component>> {
        if draft.once(keyword(kind)).is_some() {
            return self.stated(draft, kind).map(|(component, ..)| component);
        }
        let symbol = self.find(module?, Space::Component(kind), default)?;
        let Item::Declaration(declaration) = self.program.item(symbol) else { return None };
        self.with_defaults(symbol, declaration)
    }

    fn chain(&self, draft: &Draft<'t>) -> Option<ChainDeclaration> {
        let closes_within = match draft.once("chain closes") {
            Some(Placed { statement: Statement::ChainCloses(expr), env, .. }) => {
                let bounds = Bounds::between(0.0, 100.0);
                Some(self.bounded_constant(env, expr, Dimension::LENGTH, "the chain's left-over", bounds)?)
            }
            _ => None,
        };
        let tension = match draft.once("chain tension") {
            Some(Placed { statement: Statement::ChainTension(expr), env, .. }) => {
                let bounds = Bounds::between(0.0, 1e6);
                self.bounded_constant(env, expr, Dimension::FORCE, "the chain's tension", bounds).map(|t| t.value)
            }
            _ => {
                let usual = self.stated(draft, DeclarationKind::Cart)?.0.number("tension");
                if usual.is_none() {
                    self.missing(draft, "chain tension", "chain tension 500 N");
                }
                usual
            }
        };
        let tension_is_said = draft.once("chain tension").is_some();
        Some(ChainDeclaration { tension: tension?, tension_is_said, closes_within })
    }

    /// `turns` or `radii`: the catalogue's limits, narrowed by the layout.
    fn limits(
        &self,
        draft: &Draft<'t>,
        catalog: Option<&Catalog>,
        keyword: &'static str,
        dimension: Dimension,
        of: fn(&Catalog) -> Interval,
    ) -> Option<Spanned<Interval>> {
        let stated = draft.once(keyword);
        let Some(placed) = stated else {
            return catalog.map(|c| Spanned::new(of(c), c.span));
        };
        let (Statement::Turns { low, high } | Statement::Radii { low, high }) = placed.statement else { return None };
        let scope = Scope { env: &placed.env, geometry: None };
        let (low_what, high_what) = (format!("the least of `{keyword}`"), format!("the largest of `{keyword}`"));
        let low_value = self.constant(scope, low, dimension, &low_what);
        let high_value = self.constant(scope, high, dimension, &high_what);
        let (low_value, high_value) = (low_value?, high_value?);
        let span = low.span.to(high.span);
        self.ordered(low_value, high_value, span, dimension)?;
        let catalog = catalog?;
        let offered = of(catalog);
        let slack = 1e-9;
        if low_value < offered.low - slack || high_value > offered.high + slack {
            let range = |i: Interval| format!("{} .. {}", shown(i.low, dimension), shown(i.high, dimension));
            self.report(
                Diagnostic::new(
                    Code::E0306,
                    format!("`{keyword}` go beyond the catalogue"),
                    span,
                    "may only be narrower",
                )
                .expected(format!("within {}", range(offered)), range(Interval { low: low_value, high: high_value }))
                .related(catalog.span, "the catalogue"),
            );
            return None;
        }
        if keyword == "radii"
            && !catalog.curve.radii.iter().any(|r| (low_value - slack..=high_value + slack).contains(r))
        {
            self.report(
                Diagnostic::new(Code::E0306, "no radius of the catalogue is left", span, "between two of them")
                    .expected(format!("one of {}", offered_text(&catalog.curve.radii)), "none")
                    .related(catalog.span, "the catalogue"),
            );
            return None;
        }
        Some(Spanned::new(Interval { low: low_value.max(offered.low), high: high_value.min(offered.high) }, span))
    }
}

/// `500 mm .. 1250 mm in steps of 50 mm`, or the list.
fn offered(lengths: &[f64]) -> String {
    let steps: Vec<f64> = lengths.windows(2).map(|w| w[1] - w[0]).collect();
    match (lengths.first(), lengths.last(), steps.first()) {
        (Some(low), Some(high), Some(step)) if steps.len() > 2 && steps.iter().all(|s| (s - step).abs() < 1e-9) => {
            format!("{} .. {} in steps of {}", metres(*low), metres(*high), metres(*step))
        }
        _ => offered_text(lengths),
    }
}

fn offered_text(lengths: &[f64]) -> String {
    lengths.iter().map(|l| metres(*l)).collect::<Vec<_>>().join(", ")
}
