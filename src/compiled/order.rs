//! What has to be ordered for a layout beside its track: chain, drive, measuring equipment, supports, and what stands along the
//! track.

use crate::base::number::{fixed, trimmed};
use crate::compiled::Compiled;
use crate::model::{Article, Motors};

/// What a line of an order belongs to, in the order of the bill.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    Chain,
    Drive,
    Sensors,
    Supports,
    Stations,
}

impl Group {
    pub fn name(self) -> &'static str {
        match self {
            Group::Chain => "chain",
            Group::Drive => "drive",
            Group::Sensors => "sensors",
            Group::Supports => "supports",
            Group::Stations => "stations",
        }
    }
}

/// So many of one component.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderLine {
    pub group: Group,
    /// Article number; `None` where the declaration has none.
    pub article: Option<String>,
    pub description: String,
    pub count: usize,
    /// EUR, rounded to the cent; `None` where the declaration has no price.
    pub unit_price: Option<f64>,
    /// kg, rounded to the gram; `None` where it has no mass.
    pub unit_mass: Option<f64>,
}

impl OrderLine {
    fn new(group: Group, article: &Article, description: String, count: usize) -> Self {
        let rounded = |value: f64, units: f64| (value * units).round() / units;
        OrderLine {
            group,
            article: article.number.clone(),
            description,
            count,
            unit_price: article.price.map(|price| rounded(price, 100.0)),
            unit_mass: article.mass.map(|mass| rounded(mass, 1000.0)),
        }
    }

    /// EUR
    pub fn price(&self) -> Option<f64> {
        self.unit_price.map(|price| (price * self.count as f64 * 100.0).round() / 100.0)
    }

    /// kg
    pub fn mass(&self) -> Option<f64> {
        self.unit_mass.map(|mass| (mass * self.count as f64 * 1000.0).round() / 1000.0)
    }
}

/// The lines of a layout, by group; nothing that it has none of. Carts and joints are as many as fit the track.
pub fn lines(compiled: &Compiled) -> Vec<OrderLine> {
    let layout = &compiled.layout;
    let (cart, equipment) = (&layout.cart, &layout.equipment);
    let millimetres = format!("{}", (cart.length * 1e3).round());
    let carts = compiled.chain.map_or(0, |fit| fit.carts);
    let of_cart = Article {
        number: cart.article.number.as_ref().map(|prefix| format!("{prefix}-{millimetres}")),
        price: cart.article.price,
        mass: Some(cart.mass),
    };
    let motor = &layout.drive.motor;
    let motors = match &equipment.motors {
        Motors::Evenly { count } => *count,
        Motors::Rows(rows) => rows.iter().map(|row| row.count).sum(),
    };
    let thrust = format!("motor {}, {} mm, {} N", motor.name, (motor.length * 1e3).round(), motor.force);
    let mut lines = vec![
        OrderLine::new(Group::Chain, &of_cart, format!("cart {}, {millimetres} mm", cart.name), carts),
        OrderLine::new(Group::Chain, &cart.joint.article, format!("joint {}", cart.joint.name), carts),
        OrderLine::new(Group::Drive, &motor.article, thrust, motors),
    ];
    if let Some(take_up) = &layout.take_up {
        let description = format!("take-up {}, {} mm", take_up.name, trimmed(take_up.travel * 1e3, 3));
        lines.push(OrderLine::new(Group::Drive, &take_up.article, description, 1));
    }
    let measures = equipment.photocell.is_some();
    let sensor = format!("sensor cart's equipment {}, on cart {}", layout.sensor.name, equipment.sensor_cart);
    let none = Article::default();
    lines.push(OrderLine::new(Group::Sensors, &layout.sensor.article, sensor, usize::from(measures)));
    lines.push(OrderLine::new(Group::Sensors, &none, "photocell of the trigger".into(), usize::from(measures)));
    let supports = compiled.supports().len();
    lines.push(OrderLine::new(Group::Supports, &layout.catalog.support, "support".into(), supports));
    let station = |description: String, count: usize| OrderLine::new(Group::Stations, &none, description, count);
    let own = |name: &str| equipment.declared.iter().all(|declared| declared.name != name);
    let inductions = equipment.inductions.iter().filter(|i| own(&i.name));
    lines.extend(inductions.map(|i| station(format!("induction {}", i.name), 1)));
    let chutes = equipment.chutes.iter().filter(|c| own(&c.name));
    lines.extend(chutes.map(|c| station(format!("chute of {}", c.name), c.count())));
    lines.extend(declared(compiled));
    lines.retain(|line| line.count > 0);
    lines
}

/// What a layout costs as a whole, as far as declarations have prices.
#[derive(Clone, Debug, PartialEq)]
pub struct Total {
    /// Of the track's elements, EUR.
    pub elements: f64,
    /// Of what is ordered beside them, EUR, for each group in which something has a price.
    pub groups: Vec<(Group, f64)>,
    /// Of all of these, EUR.
    pub all: f64,
    /// What has no price, in words.
    pub unpriced: Vec<String>,
}

/// The price of a layout's elements and of everything beside them.
pub fn total(compiled: &Compiled) -> Total {
    let lines = lines(compiled);
    let elements = compiled.bill.price;
    let mut groups: Vec<(Group, f64)> = Vec::new();
    for (group, price) in lines.iter().filter_map(|line| Some((line.group, line.price()?))) {
        match groups.last_mut().filter(|(last, _)| *last == group) {
            Some((_, sum)) => *sum += price,
            None => groups.push((group, price)),
        }
    }
    let cents = |price: f64| (price * 100.0).round() / 100.0;
    groups.iter_mut().for_each(|(_, price)| *price = cents(*price));
    let all = cents(elements + groups.iter().map(|(_, price)| price).sum::<f64>());
    let unpriced = lines.into_iter().filter(|line| line.unit_price.is_none()).map(|line| line.description).collect();
    Total { elements, groups, all, unpriced }
}

/// Equipment of declared kinds, each with its conveyor behind it.
fn declared(compiled: &Compiled) -> Vec<OrderLine> {
    let mut lines = Vec::new();
    for (i, declared) in compiled.layout.equipment.declared.iter().enumerate() {
        let (of, placed) = (&declared.of, compiled.placement.placed.iter().filter(|p| p.declared == i));
        let kind = of.kind.word();
        let place = if declared.count() > 1 { "of" } else { "at" };
        let description = format!("{kind} {}, {place} {}", of.name, declared.name);
        lines.push(OrderLine::new(Group::Stations, &of.article, description, placed.clone().count()));
        let length: f64 = placed.filter_map(|p| p.conveyor).sum();
        if length > 0.0 && of.conveyor > 0.0 {
            let article = Article { price: Some(length * of.conveyor), ..Article::default() };
            let description = format!("conveyor to {}, {} m", declared.name, fixed(length, 2));
            lines.push(OrderLine::new(Group::Stations, &article, description, 1));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::geometry::Point;
    use crate::model::{Declared, EquipmentKind, EquipmentSide, EquipmentType, StraightPlace, fixture};
    use crate::source::Spanned;

    #[test]
    fn a_layout_is_ordered_with_its_chain() {
        let mut layout = fixture::rectangle(20.0, 10.5, 4.0);
        layout.cart.article = Article { number: Some("TT".into()), price: Some(800.004), mass: None };
        layout.equipment.supports = Some(Spanned { value: 2.5, span: fixture::span() });
        layout.equipment.photocell = Some(StraightPlace { section: 0, at: 0.0, span: fixture::span() });
        layout.catalog.support = Article { number: Some("SU".into()), price: Some(145.0), mass: Some(17.0) };
        let compiled = compile(layout);
        let carts = compiled.chain.unwrap().carts;
        let lines = lines(&compiled);
        let told: Vec<_> =
            lines.iter().map(|l| (l.group, l.description.as_str(), l.count, l.price(), l.mass())).collect();
        let supports = (compiled.length() / 2.5).ceil() as usize;
        assert_eq!(
            told,
            [
                (Group::Chain, "cart tilt_tray, 1250 mm", carts, Some(800.0 * carts as f64), Some(41.0 * carts as f64)),
                (Group::Chain, "joint spherical", carts, None, None),
                (Group::Drive, "motor linear, 1000 mm, 400 N", 4, None, None),
                (Group::Sensors, "sensor cart's equipment sensor_cart, on cart 1", 1, None, None),
                (Group::Sensors, "photocell of the trigger", 1, None, None),
                (Group::Supports, "support", supports, Some(145.0 * supports as f64), Some(17.0 * supports as f64)),
            ]
        );
        assert_eq!(lines[0].article.as_deref(), Some("TT-1250"));
    }

    #[test]
    fn without_supports_and_photocell_there_are_none() {
        let lines = lines(&compile(fixture::rectangle(20.0, 10.5, 4.0)));
        assert!(lines.iter().all(|l| matches!(l.group, Group::Chain | Group::Drive)), "{lines:?}");
    }

    #[test]
    fn equipment_of_declared_kinds_is_ordered_with_its_conveyors() {
        let mut layout = fixture::rectangle(40.0, 20.0, 4.0);
        (layout.obstacles, layout.building) = (Vec::new(), None);
        let of = fixture::equipment_type(EquipmentKind::Induction, 3.0, 2.0, EquipmentSide::Outer);
        let article = Article { number: Some("IN".into()), price: Some(5000.0), mass: Some(80.0) };
        let of = EquipmentType { conveyor: 100.0, article, ..of };
        let chute = fixture::equipment_type(EquipmentKind::Chute, 1.5, 2.0, EquipmentSide::Outer);
        // 2.6 m from the centre line to the outer edge.
        let fed = Some(Point::new(20.0, -10.6));
        layout.equipment.declared =
            vec![Declared { fed, ..fixture::anywhere("west", of, 1) }, fixture::anywhere("row_a", chute, 25)];
        let compiled = compile(layout);
        let lines = lines(&compiled);
        let told: Vec<_> = lines
            .iter()
            .filter(|l| l.group == Group::Stations)
            .map(|l| (l.article.as_deref(), l.description.as_str(), l.count, l.price(), l.mass()))
            .collect();
        assert_eq!(
            told,
            [
                (Some("IN"), "induction induction, at west", 1, Some(5000.0), Some(80.0)),
                (None, "conveyor to west, 8.00 m", 1, Some(800.0), None),
                (None, "chute chute, of row_a", 25, Some(25_000.0), None),
            ]
        );
        assert_eq!((compiled.placement.price(), compiled.placement.bound), (30_800.0, 800.0));
        // Carts, joints and motors of this layout have no prices.
        let total = total(&compiled);
        assert_eq!(total.groups, [(Group::Stations, 30_800.0)]);
        assert!((total.all - compiled.bill.price - 30_800.0).abs() < 0.005, "{total:?}");
        assert_eq!(total.unpriced[1..], ["joint spherical", "motor linear, 1000 mm, 400 N"]);
    }
}
