//! Layouts built in code for unit tests, without the language in between.

use super::*;
use crate::base::trig;
use crate::source::FileId;

/// A span for items that no text stands behind.
pub fn span() -> Span {
    Span::new(FileId(0), 0, 0)
}

fn spanned<T>(value: T) -> Spanned<T> {
    Spanned::new(value, span())
}

/// A rectangle with four equal fillets, driven counter-clockwise from its lower left vertex `P1` along +x, on
/// [`catalog`], with the reference cart and drive (design: chain model), without building, obstacles and
/// equipment.
pub fn rectangle(width_m: f64, height_m: f64, radius: f64) -> Layout {
    let corners = [(0.0, 0.0), (width_m, 0.0), (width_m, height_m), (0.0, height_m)];
    loop_through("rectangle", &corners.map(|(x, y)| (x, y, radius)))
}

/// The same for any vertices (x, y, radius).
pub fn loop_through(name: &str, corners: &[(f64, f64, f64)]) -> Layout {
    let vertices = corners
        .iter()
        .enumerate()
        .map(|(i, &(x, y, radius))| Vertex {
            name: format!("P{}", i + 1),
            point: Point::new(x, y),
            point_span: span(),
            radius: spanned(radius),
            span: span(),
        })
        .collect();
    let catalog = catalog();
    Layout {
        name: name.to_owned(),
        span: span(),
        turns: spanned(catalog.curve.turns),
        radii: spanned(Interval { low: 3.0, high: 8.0 }),
        catalog,
        cart: cart(),
        drive: drive(),
        sensor: Sensor {
            name: "sensor_cart".to_owned(),
            lowpass: 100.0,
            rate: 500.0,
            trigger_length: 0.10,
            range: None,
            article: Article::default(),
        },
        take_up: None,
        speed: spanned(2.0),
        width: spanned(1.2),
        vertices,
        building: None,
        obstacles: Vec::new(),
        constraints: Vec::new(),
        equipment: equipment(),
        capacity: Capacity::default(),
        choice: Choice::default(),
        levels: Vec::new(),
        ramps: Vec::new(),
        chain: ChainDeclaration { tension: 500.0, tension_is_said: true, closes_within: None },
        effects: Vec::new(),
        drawing: DrawingSettings::default(),
        objective: Objective { terms: vec![(1.0, Goal::Length)], ..Objective::default() },
        route: None,
    }
}

/// The thesis' grid: radii 1 m apart, turns in steps of 2.5°, straights of 1, 2 and 3 m or cut to any length.
pub fn catalog() -> Catalog {
    let degree = trig::PI / 180.0;
    Catalog {
        name: "thesis".to_owned(),
        span: span(),
        straight: StraightStock {
            article: "ST".to_owned(),
            stock: vec![1.0, 2.0, 3.0],
            cut: Some(Interval { low: 0.0, high: 3.0 }),
            cut_price: 25.0,
            shortest: 0.0,
            price: Rate { per_piece: 40.0, per_metre: 100.0 },
            mass: Rate { per_piece: 2.0, per_metre: 20.0 },
        },
        curve: CurveStock {
            article: "CU".to_owned(),
            radii: vec![3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
            angle_step: 2.5 * degree,
            largest: 45.0 * degree,
            turns: Interval { low: 5.0 * degree, high: 90.0 * degree },
            price: Rate { per_piece: 60.0, per_metre: 200.0 },
            mass: Rate { per_piece: 3.0, per_metre: 25.0 },
        },
        vertical: None,
        spiral: None,
        take_up: 0.05,
        headroom: 1.0,
        support: Article::default(),
    }
}

fn equipment() -> Equipment {
    Equipment {
        start: None,
        photocell: None,
        inductions: Vec::new(),
        chutes: Vec::new(),
        declared: Vec::new(),
        motors: Motors::Evenly { count: 4 },
        supports: None,
        sensor_cart: 1,
    }
}

fn cart() -> Cart {
    let contact = |stiffness, exponent| ContactParameters { stiffness, exponent, restitution: 0.6 };
    let wheel = |name: &str, radius, height, gap, stiffness| Wheel {
        name: name.to_owned(),
        radius,
        half_spacing: 0.30,
        height,
        gap,
        contact: contact(stiffness, 1.5),
        rolling_resistance: 0.015,
        strength: Strength::default(),
    };
    Cart {
        name: "tilt_tray".to_owned(),
        span: span(),
        length: 1.25,
        lengths: Vec::new(),
        mass: 41.0,
        inertia: [1.6, 5.6, 6.4],
        centre_of_mass: [-0.40, 0.05],
        steering: wheel("steering", 0.040, 0.0, 0.0001, 4.0e7),
        running: wheel("running", 0.050, 0.08, 0.002, 5.0e7),
        joint: Joint {
            name: "spherical".to_owned(),
            axial: contact(4.0e6, 1.0),
            radial: contact(2.0e6, 1.0),
            approach_floor: 0.05,
            strength: Strength::default(),
            article: Article::default(),
        },
        motor_height: 0.10,
        drag: None,
        tension: None,
        article: Article::default(),
    }
}

fn drive() -> Drive {
    Drive {
        motor: Motor {
            name: "linear".to_owned(),
            length: 1.0,
            force: 400.0,
            efficiency: None,
            article: Article::default(),
        },
        controller: Controller {
            name: "pi".to_owned(),
            proportional: 400.0,
            integral: 200.0,
            derivative: 0.0,
            period: 0.010,
        },
    }
}

#[test]
fn the_rectangle_is_what_it_says() {
    let track = crate::geometry::Track::new(&rectangle(20.0, 10.0, 4.0).corners());
    assert!((track.length - (2.0 * (12.0 + 2.0) + 8.0 * trig::PI)).abs() < 1e-12);
}

/// A kind of equipment that costs 1000 EUR, without any room around it.
pub fn equipment_type(kind: EquipmentKind, stretch: f64, depth: f64, side: EquipmentSide) -> EquipmentType {
    EquipmentType {
        name: kind.word().to_owned(),
        kind,
        stretch,
        depth,
        side,
        from_curve: 0.0,
        aisle: 0.0,
        service: 0.0,
        conveyor: 0.0,
        article: Article { number: None, price: Some(1000.0), mass: None },
    }
}

/// So many of a kind, wherever there is room.
pub fn anywhere(name: &str, of: EquipmentType, count: usize) -> Declared {
    let stands = Stands::Free { count, on: Vec::new(), after: Vec::new(), before: Vec::new() };
    Declared { name: name.to_owned(), of, stands, fed: None, span: span() }
}
