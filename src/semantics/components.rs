//! Components to the model's types. A complete component has every required field; `None` stands for one that has
//! been reported.

use crate::model::{
    Article, Cart, Catalog, ContactParameters, Controller, CurveStock, EquipmentKind, EquipmentSide, EquipmentType,
    Fatigue, Joint, Motor, Rate, Sensor, SpiralStock, StraightStock, Strength, TakeUp, VerticalStock, Wheel,
};
use crate::semantics::component::Component;
use crate::source::Span;

/// The catalogue; `span` is the layout's statement.
pub(super) fn catalog(c: &Component, span: Span) -> Option<Catalog> {
    Some(Catalog {
        name: c.name.clone(),
        span,
        straight: StraightStock {
            article: c.text("straight.article")?.to_string(),
            stock: c.numbers("straight.stock")?.to_vec(),
            cut: c.interval("straight.cut"),
            cut_price: c.number("straight.cut_price")?,
            shortest: c.number("straight.shortest")?,
            price: rate(c, "straight", "price")?,
            mass: rate(c, "straight", "mass")?,
        },
        curve: CurveStock {
            article: c.text("curve.article")?.to_string(),
            radii: c.numbers("curve.radii")?.to_vec(),
            angle_step: c.number("curve.angle_step")?,
            largest: c.number("curve.largest")?,
            turns: c.interval("curve.turns")?,
            price: rate(c, "curve", "price")?,
            mass: rate(c, "curve", "mass")?,
        },
        vertical: vertical(c),
        spiral: spiral(c),
        take_up: c.number("take_up")?,
        headroom: c.number("headroom").unwrap_or(0.0),
        support: article(c, "support."),
    })
}

fn vertical(c: &Component) -> Option<VerticalStock> {
    Some(VerticalStock {
        article: c.text("vertical.article")?.to_string(),
        radii: c.numbers("vertical.radii")?.to_vec(),
        angle_step: c.number("vertical.angle_step")?,
        steepest: c.number("vertical.steepest")?,
        price: rate(c, "vertical", "price")?,
        mass: rate(c, "vertical", "mass")?,
    })
}

fn spiral(c: &Component) -> Option<SpiralStock> {
    Some(SpiralStock {
        article: c.text("spiral.article")?.to_string(),
        radii: c.numbers("spiral.radii")?.to_vec(),
        angle_step: c.number("spiral.angle_step")?,
        steepest: c.number("spiral.steepest")?,
        price: rate(c, "spiral", "price")?,
        mass: rate(c, "spiral", "mass")?,
    })
}

fn rate(c: &Component, group: &str, of: &str) -> Option<Rate> {
    Some(Rate {
        per_piece: c.number(&format!("{group}.piece_{of}"))?,
        per_metre: c.number(&format!("{group}.metre_{of}"))?,
    })
}

fn article(c: &Component, prefix: &str) -> Article {
    let number = |of: &str| c.number(&format!("{prefix}{of}"));
    let text = c.text(&format!("{prefix}article")).map(str::to_owned);
    Article { number: text, price: number("price"), mass: number("mass") }
}

/// The cart; `span` is the layout's statement.
pub(super) fn cart(c: &Component, span: Span) -> Option<Cart> {
    let [roll, pitch, yaw] = c.numbers("inertia")? else { return None };
    let [forward, above] = c.numbers("centre_of_mass")? else { return None };
    Some(Cart {
        name: c.name.clone(),
        span,
        length: c.number("length")?,
        lengths: c.numbers("lengths").map_or_else(Vec::new, <[f64]>::to_vec),
        mass: c.number("mass")?,
        inertia: [*roll, *pitch, *yaw],
        centre_of_mass: [*forward, *above],
        steering: wheel(c.component("steering")?)?,
        running: wheel(c.component("running")?)?,
        joint: joint(c.component("joint")?)?,
        motor_height: c.number("motor_height")?,
        drag: c.number("drag"),
        tension: c.number("tension"),
        article: Article { mass: None, ..article(c, "") },
    })
}

fn wheel(c: &Component) -> Option<Wheel> {
    Some(Wheel {
        name: c.name.clone(),
        radius: c.number("radius")?,
        half_spacing: c.number("half_spacing")?,
        height: c.number("height")?,
        gap: c.number("gap")?,
        contact: contact(c, "")?,
        rolling_resistance: c.number("rolling_resistance")?,
        strength: strength(c),
    })
}

fn joint(c: &Component) -> Option<Joint> {
    Some(Joint {
        name: c.name.clone(),
        axial: contact(c, "axial.")?,
        radial: contact(c, "radial.")?,
        approach_floor: c.number("approach_floor")?,
        strength: strength(c),
        article: article(c, ""),
    })
}

fn strength(c: &Component) -> Strength {
    let number = |of: &str| c.number(&format!("fatigue.{of}"));
    let fatigue = |range: f64| Some(Fatigue { range, cycles: number("cycles")?, exponent: number("exponent")? });
    Strength { rated: c.number("rated"), fatigue: number("range").and_then(fatigue) }
}

fn contact(c: &Component, prefix: &str) -> Option<ContactParameters> {
    Some(ContactParameters {
        stiffness: c.number(&format!("{prefix}stiffness"))?,
        exponent: c.number(&format!("{prefix}exponent"))?,
        restitution: c.number(&format!("{prefix}restitution"))?,
    })
}

pub(super) fn motor(c: &Component) -> Option<Motor> {
    let (length, force) = (c.number("length")?, c.number("force")?);
    Some(Motor { name: c.name.clone(), length, force, efficiency: c.number("efficiency"), article: article(c, "") })
}

pub(super) fn controller(c: &Component) -> Option<Controller> {
    Some(Controller {
        name: c.name.clone(),
        proportional: c.number("proportional")?,
        integral: c.number("integral")?,
        derivative: c.number("derivative")?,
        period: c.number("period")?,
    })
}

/// `None` is also a kind or a side that has been reported.
pub(super) fn equipment(c: &Component) -> Option<EquipmentType> {
    let (kind, side) = (c.text("kind")?, c.text("side")?);
    let optional = |field: &str| c.number(field).unwrap_or(0.0);
    Some(EquipmentType {
        name: c.name.clone(),
        kind: EquipmentKind::ALL.into_iter().find(|known| known.word() == kind)?,
        stretch: c.number("stretch")?,
        depth: c.number("depth")?,
        side: EquipmentSide::ALL.into_iter().find(|known| known.word() == side)?,
        from_curve: optional("from_curve"),
        aisle: optional("aisle"),
        service: optional("service"),
        conveyor: optional("conveyor"),
        article: article(c, ""),
    })
}

pub(super) fn sensor(c: &Component) -> Option<Sensor> {
    Some(Sensor {
        name: c.name.clone(),
        lowpass: c.number("lowpass")?,
        rate: c.number("rate")?,
        trigger_length: c.number("trigger_length")?,
        range: c.number("range"),
        article: article(c, ""),
    })
}

pub(super) fn take_up(c: &Component) -> Option<TakeUp> {
    Some(TakeUp {
        name: c.name.clone(),
        travel: c.number("travel")?,
        force: c.number("force"),
        article: article(c, ""),
    })
}
