//! The typed fields of declarations: one table per kind, and nothing about fields is written anywhere else.

use crate::syntax::tree::DeclarationKind;

/// What a field holds, with units and bounds in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// A constant in this unit.
    Number(&'static str, Bounds),
    /// Constants, ascending: a list or a range with a step.
    Numbers(&'static str, Bounds),
    /// `low .. high`.
    Interval(&'static str, Bounds),
    /// A tuple of this many constants.
    Tuple(&'static str, Bounds, usize),
    /// K of a contact law: N/m to the power of the exponent beside it.
    Stiffness,
    Text,
    /// One of these words.
    Word(&'static [&'static str]),
    /// Another declaration.
    Reference(DeclarationKind),
}

/// Which values a number may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub low: f64,
    pub high: f64,
    /// Whether `low` itself is excluded.
    pub open: bool,
}

impl Bounds {
    pub const fn between(low: f64, high: f64) -> Self {
        Bounds { low, high, open: false }
    }

    pub const fn above(low: f64, high: f64) -> Self {
        Bounds { low, high, open: true }
    }

    pub fn contains(&self, value: f64) -> bool {
        value <= self.high && if self.open { value > self.low } else { value >= self.low }
    }
}

/// What happens when a field is not written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Presence {
    Required,
    /// Required once any field of its group is written.
    InGroup,
    Optional,
}

/// A field; those of a group have the group's name before a dot.
#[derive(Clone, Copy, Debug)]
pub(super) struct FieldSpec {
    pub path: &'static str,
    pub shape: Shape,
    pub presence: Presence,
    /// Shown when the field is missing or wrong.
    pub doc: &'static str,
}

const fn field(path: &'static str, shape: Shape, presence: Presence, doc: &'static str) -> FieldSpec {
    FieldSpec { path, shape, presence, doc }
}

const NOT_NEGATIVE: Bounds = Bounds::between(0.0, 1e12);
const POSITIVE: Bounds = Bounds::above(0.0, 1e12);
const LENGTH: Bounds = Bounds::above(0.0, 1e3);
const LENGTH_OR_ZERO: Bounds = Bounds::between(0.0, 1e3);
const SLOPE: Bounds = Bounds::above(0.0, 1.0);
const RESTITUTION: Bounds = Bounds::above(0.0, 1.0);
const EXPONENT: Bounds = Bounds::between(1.0, 2.0);
const TURN: Bounds = Bounds::above(0.0, 3.1);

use Presence::{InGroup, Optional, Required};
use Shape::{Interval, Number, Numbers, Reference, Stiffness, Text, Tuple, Word};

const CATALOG: &[FieldSpec] = &[
    field("take_up", Number("m", LENGTH_OR_ZERO), Required, "length that the chain's take-up compensates"),
    field("headroom", Number("m", LENGTH_OR_ZERO), Optional, "least height between two sections that cross"),
    field("straight.article", Text, Required, "article number prefix"),
    field("straight.stock", Numbers("m", LENGTH), Required, "lengths on stock, may be an empty list"),
    field("straight.cut", Interval("m", LENGTH_OR_ZERO), Optional, "lengths that a piece may be cut to"),
    field("straight.cut_price", Number("EUR", NOT_NEGATIVE), Required, "surcharge for a cut piece"),
    field("straight.shortest", Number("m", LENGTH_OR_ZERO), Required, "shortest straight between two curves"),
    field("straight.piece_price", Number("EUR", NOT_NEGATIVE), Required, "price of a piece, besides its length"),
    field("straight.metre_price", Number("EUR/m", NOT_NEGATIVE), Required, "price of a metre"),
    field("straight.piece_mass", Number("kg", NOT_NEGATIVE), Required, "mass of a piece, besides its length"),
    field("straight.metre_mass", Number("kg/m", NOT_NEGATIVE), Required, "mass of a metre"),
    field("curve.article", Text, Required, "article number prefix"),
    field("curve.radii", Numbers("m", LENGTH), Required, "radii of horizontal curves"),
    field("curve.angle_step", Number("rad", TURN), Required, "every turn is a multiple of it"),
    field("curve.largest", Number("rad", TURN), Required, "largest angle of a single piece"),
    field("curve.turns", Interval("rad", TURN), Required, "least and largest turn at a vertex"),
    field("curve.piece_price", Number("EUR", NOT_NEGATIVE), Required, "price of a piece, besides its length"),
    field("curve.metre_price", Number("EUR/m", NOT_NEGATIVE), Required, "price of a metre of centre line"),
    field("curve.piece_mass", Number("kg", NOT_NEGATIVE), Required, "mass of a piece, besides its length"),
    field("curve.metre_mass", Number("kg/m", NOT_NEGATIVE), Required, "mass of a metre of centre line"),
    field("vertical.article", Text, InGroup, "article number prefix"),
    field("vertical.radii", Numbers("m", LENGTH), InGroup, "radii of vertical curves"),
    field(
        "vertical.angle_step",
        Number("rad", Bounds::between(0.0, 1.6)),
        InGroup,
        "step of the slope angle, 0 for any",
    ),
    field("vertical.steepest", Number("", SLOPE), InGroup, "largest slope, rise over run"),
    field("vertical.piece_price", Number("EUR", NOT_NEGATIVE), InGroup, "price of a piece, besides its length"),
    field("vertical.metre_price", Number("EUR/m", NOT_NEGATIVE), InGroup, "price of a metre of centre line"),
    field("vertical.piece_mass", Number("kg", NOT_NEGATIVE), InGroup, "mass of a piece, besides its length"),
    field("vertical.metre_mass", Number("kg/m", NOT_NEGATIVE), InGroup, "mass of a metre of centre line"),
    field("spiral.article", Text, InGroup, "article number prefix"),
    field("spiral.radii", Numbers("m", LENGTH), InGroup, "radii of spirals, seen from above"),
    field("spiral.angle_step", Number("rad", TURN), InGroup, "every turn is a multiple of it"),
    field("spiral.steepest", Number("", SLOPE), InGroup, "largest slope, rise over run"),
    field("spiral.piece_price", Number("EUR", NOT_NEGATIVE), InGroup, "price of a piece, besides its length"),
    field("spiral.metre_price", Number("EUR/m", NOT_NEGATIVE), InGroup, "price of a metre of centre line"),
    field("spiral.piece_mass", Number("kg", NOT_NEGATIVE), InGroup, "mass of a piece, besides its length"),
    field("spiral.metre_mass", Number("kg/m", NOT_NEGATIVE), InGroup, "mass of a metre of centre line"),
    field("support.article", Text, Optional, "article number of a support"),
    field("support.price", Number("EUR", NOT_NEGATIVE), Optional, "price of a support"),
    field("support.mass", Number("kg", NOT_NEGATIVE), Optional, "mass of a support"),
];

const CART: &[FieldSpec] = &[
    field("length", Number("m", Bounds::between(0.05, 20.0)), Required, "from front joint to rear joint"),
    field("lengths", Numbers("m", LENGTH), Optional, "lengths that the family is made in"),
    field("mass", Number("kg", Bounds::above(0.0, 1e5)), Required, "of the cart with its carrier"),
    field("inertia", Tuple("kg*m^2", POSITIVE, 3), Required, "about the centre of mass: roll, pitch, yaw"),
    field(
        "centre_of_mass",
        Tuple("m", Bounds::between(-20.0, 20.0), 2),
        Required,
        "forward of and above the front joint",
    ),
    field("steering", Reference(DeclarationKind::Wheel), Required, "the steering wheels"),
    field("running", Reference(DeclarationKind::Wheel), Required, "the running wheels"),
    field("joint", Reference(DeclarationKind::Joint), Required, "the joint to the next cart"),
    field("motor_height", Number("m", Bounds::between(-5.0, 5.0)), Required, "of the motor force, below the joint"),
    field("drag", Number("kg/m", NOT_NEGATIVE), Optional, "air drag, c in c v^2"),
    field("tension", Number("N", NOT_NEGATIVE), Optional, "chain tension unless the layout says otherwise"),
    field("article", Text, Optional, "article number; the length in mm is added"),
    field("price", Number("EUR", NOT_NEGATIVE), Optional, "price of a cart with its wheels, without the joint"),
];

const WHEEL: &[FieldSpec] = &[
    field("radius", Number("m", Bounds::above(0.0, 5.0)), Required, "of the wheel"),
    field("half_spacing", Number("m", Bounds::between(0.0, 5.0)), Required, "half the lateral distance of the pair"),
    field("height", Number("m", Bounds::between(-5.0, 5.0)), Required, "of the contact, below the joint"),
    field("gap", Number("m", Bounds::between(0.0, 1.0)), Required, "clearance to the rail"),
    field("stiffness", Stiffness, Required, "of the contact law"),
    field("exponent", Number("", EXPONENT), Required, "of the contact law"),
    field("restitution", Number("", RESTITUTION), Required, "coefficient of restitution"),
    field("rolling_resistance", Number("", Bounds::between(0.0, 1.0)), Required, "coefficient of rolling resistance"),
    field("rated", Number("N", POSITIVE), Optional, "largest force that it carries"),
    field("fatigue.range", Number("N", POSITIVE), InGroup, "range of force of the S-N curve's point"),
    field("fatigue.cycles", Number("", Bounds::above(0.0, 1e12)), InGroup, "cycles of that range that it carries"),
    field("fatigue.exponent", Number("", Bounds::between(1.0, 30.0)), InGroup, "slope m of the S-N curve, N ~ S^-m"),
];

const JOINT: &[FieldSpec] = &[
    field("approach_floor", Number("m/s", Bounds::above(0.0, 10.0)), Required, "least approach speed in damping terms"),
    field("axial.stiffness", Stiffness, Required, "of the contact law along the chain"),
    field("axial.exponent", Number("", EXPONENT), Required, "of the contact law along the chain"),
    field("axial.restitution", Number("", RESTITUTION), Required, "coefficient of restitution along the chain"),
    field("radial.stiffness", Stiffness, Required, "of the contact law across the chain"),
    field("radial.exponent", Number("", EXPONENT), Required, "of the contact law across the chain"),
    field("radial.restitution", Number("", RESTITUTION), Required, "coefficient of restitution across the chain"),
    field("rated", Number("N", POSITIVE), Optional, "largest force that it carries"),
    field("fatigue.range", Number("N", POSITIVE), InGroup, "range of force of the S-N curve's point"),
    field("fatigue.cycles", Number("", Bounds::above(0.0, 1e12)), InGroup, "cycles of that range that it carries"),
    field("fatigue.exponent", Number("", Bounds::between(1.0, 30.0)), InGroup, "slope m of the S-N curve, N ~ S^-m"),
    field("article", Text, Optional, "article number"),
    field("price", Number("EUR", NOT_NEGATIVE), Optional, "price of a joint"),
    field("mass", Number("kg", NOT_NEGATIVE), Optional, "mass of a joint"),
];

const MOTOR: &[FieldSpec] = &[
    field("length", Number("m", Bounds::above(0.0, 100.0)), Required, "of the stretch that it covers"),
    field("force", Number("N", POSITIVE), Required, "largest thrust"),
    field("efficiency", Number("", Bounds::above(0.0, 1.0)), Optional, "thrust times speed over electrical power"),
    field("article", Text, Optional, "article number"),
    field("price", Number("EUR", NOT_NEGATIVE), Optional, "price of a motor"),
    field("mass", Number("kg", NOT_NEGATIVE), Optional, "mass of a motor"),
];

const CONTROLLER: &[FieldSpec] = &[
    field("proportional", Number("N*s/m", NOT_NEGATIVE), Required, "gain on the speed error"),
    field("integral", Number("N/m", NOT_NEGATIVE), Required, "gain on the integrated speed error"),
    field("derivative", Number("N*s^2/m", NOT_NEGATIVE), Required, "gain on the rate of the speed error"),
    field("period", Number("s", Bounds::above(0.0, 10.0)), Required, "time between two samples"),
];

const SENSOR: &[FieldSpec] = &[
    field("lowpass", Number("Hz", Bounds::above(0.0, 1e6)), Required, "corner frequency of the low-pass"),
    field("rate", Number("Hz", Bounds::above(0.0, 1e6)), Required, "samples a second"),
    field(
        "trigger_length",
        Number("m", Bounds::above(0.0, 100.0)),
        Required,
        "past the photocell, where the trigger reads 1",
    ),
    field("range", Number("N", POSITIVE), Optional, "largest force that its load cells measure"),
    field("article", Text, Optional, "article number"),
    field("price", Number("EUR", NOT_NEGATIVE), Optional, "price of a sensor cart's equipment"),
    field("mass", Number("kg", NOT_NEGATIVE), Optional, "mass of a sensor cart's equipment"),
];

const TAKE_UP: &[FieldSpec] = &[
    field("travel", Number("m", LENGTH_OR_ZERO), Required, "length of chain that it compensates, longer or shorter"),
    field("force", Number("N", POSITIVE), Optional, "largest tension of the chain that it holds"),
    field("article", Text, Optional, "article number"),
    field("price", Number("EUR", NOT_NEGATIVE), Optional, "price of one"),
    field("mass", Number("kg", NOT_NEGATIVE), Optional, "mass of one"),
];

const EQUIPMENT: &[FieldSpec] = &[
    field("kind", Word(&["induction", "chute", "scanner", "gate", "lift"]), Required, "what it does"),
    field("stretch", Number("m", LENGTH), Required, "length along the track"),
    field("depth", Number("m", LENGTH_OR_ZERO), Required, "across the track, from the band's edge"),
    field(
        "side",
        Word(&["left", "right", "outer", "inner", "either", "both"]),
        Required,
        "side of travel, or of the loop, that it stands on",
    ),
    field("from_curve", Number("m", LENGTH_OR_ZERO), Optional, "least distance from curves"),
    field("aisle", Number("m", LENGTH_OR_ZERO), Optional, "free room behind it"),
    field("service", Number("m", LENGTH_OR_ZERO), Optional, "free room at either end of it"),
    field("conveyor", Number("EUR/m", NOT_NEGATIVE), Optional, "price of a metre of the conveyor that feeds it"),
    field("article", Text, Optional, "article number"),
    field("price", Number("EUR", NOT_NEGATIVE), Optional, "price of one"),
    field("mass", Number("kg", NOT_NEGATIVE), Optional, "mass of one"),
];

/// The fields of a kind.
pub(super) fn fields(kind: DeclarationKind) -> &'static [FieldSpec] {
    match kind {
        DeclarationKind::Catalog => CATALOG,
        DeclarationKind::Cart => CART,
        DeclarationKind::Wheel => WHEEL,
        DeclarationKind::Joint => JOINT,
        DeclarationKind::Motor => MOTOR,
        DeclarationKind::Controller => CONTROLLER,
        DeclarationKind::Sensor => SENSOR,
        DeclarationKind::TakeUp => TAKE_UP,
        DeclarationKind::Equipment => EQUIPMENT,
    }
}

/// Any quantity that a stated bound would not hold, such as a vertex' coordinate: finite and of this world.
pub(super) const COORDINATE: Bounds = Bounds::between(-1e5, 1e5);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::semantics::dimension::parse_unit;

    #[test]
    fn tables_are_sound() {
        for kind in DeclarationKind::ALL {
            let mut paths: Vec<&str> = fields(kind).iter().map(|f| f.path).collect();
            paths.sort_unstable();
            assert!(paths.windows(2).all(|w| w[0] != w[1]), "{kind:?} repeats a field");
            for field in fields(kind) {
                assert!(!field.doc.is_empty(), "{}", field.path);
                if let Number(unit, _) | Numbers(unit, _) | Interval(unit, _) | Tuple(unit, _, _) = field.shape {
                    assert!(unit.is_empty() || parse_unit(unit).is_ok(), "{}: {unit}", field.path);
                }
                if matches!(field.shape, Stiffness) {
                    let beside = field.path.replace("stiffness", "exponent");
                    assert!(paths.contains(&beside.as_str()), "{} has no exponent beside it", field.path);
                }
            }
        }
    }
}
