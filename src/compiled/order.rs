//! What has to be ordered for a layout beside its track: chain, drive, measuring equipment, supports, and what stands along the
//! track.

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
    let measures = equipment.photocell.is_some();
    let sensor = format!("sensor cart's equipment {}, on cart {}", layout.sensor.name, equipment.sensor_cart);
    let none = Article::default();
    lines.push(OrderLine::new(Group::Sensors, &layout.sensor.article, sensor, usize::from(measures)));
    lines.push(OrderLine::new(Group::Sensors, &none, "photocell of the trigger".into(), usize::from(measures)));
    let supports = compiled.supports().len();
    lines.push(OrderLine::new(Group::Supports, &layout.catalog.support, "support".into(), supports));
    let station = |description: String, count: usize| OrderLine::new(Group::Stations, &none, description, count);
    lines.extend(equipment.inductions.iter().map(|i| station(format!("induction {}", i.name), 1)));
    lines.extend(equipment.chutes.iter().map(|c| station(format!("chute of {}", c.name), c.row.count)));
    lines.retain(|line| line.count > 0);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::model::{StraightPlace, fixture};
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
}
