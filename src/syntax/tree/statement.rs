//! The lines of a layout.

use super::declaration::{DeclarationKind, Let, Reference};
use super::expression::Expr;
use super::node::{Block, Name, TextExpr};
use super::place::{EquippedExpr, PlaceExpr, PlacedSection, PointExpr, RowExpr, Section, Target};
use crate::source::Span;

/// A line of a layout.
#[derive(Clone, Debug)]
pub enum Statement {
    Let(Let),
    /// `catalog standard`, `cart tilt_tray(length: 1250 mm)`, `motor ...`, `controller ...`, `sensor ...`
    Component {
        kind: DeclarationKind,
        reference: Reference,
    },
    Speed(Expr),
    Width(Expr),
    Vertex {
        name: Name,
        point: PointExpr,
        radius: Option<Expr>,
    },
    Building {
        polygon: Block<PointExpr>,
        clearance: Option<Expr>,
    },
    Obstacle {
        name: Name,
        polygon: Block<PointExpr>,
        clearance: Option<Expr>,
    },
    /// `turns 5 deg .. 90 deg`
    Turns {
        low: Expr,
        high: Expr,
    },
    /// `radii 3 m .. 8 m`
    Radii {
        low: Expr,
        high: Expr,
    },
    /// `fix length, rotation P4..P5`
    FixSection {
        kinds: Vec<(FixKind, Span)>,
        target: Target,
    },
    /// `fix P1`
    FixVertex {
        vertex: Name,
    },
    /// `fix radius P3`
    FixRadius {
        vertex: Name,
    },
    /// `require length(P7..P8) >= 18 m "the chute wall needs 18 m"`; two relations make a chain `a <= b <= c`
    Require {
        first: Expr,
        rest: Vec<(Relation, Span, Expr)>,
        reason: Option<String>,
    },
    /// `equal radius(P1), radius(P2)`
    Equal {
        values: Vec<Expr>,
    },
    /// `mirror P1, P4 about x = 20 m`
    Mirror {
        first: Name,
        second: Name,
        axis: Axis,
        at: Expr,
    },
    /// `pass column_a left`
    Pass {
        obstacle: Name,
        side: SideWord,
    },
    /// `level P1..P3 3.0 m`
    Level {
        from: Name,
        to: Name,
        height: Expr,
    },
    /// `ramp P3..P4 from 2 m slope 0.14 radius 10 m`
    Ramp {
        section: Section,
        from: Option<Expr>,
        slope: Option<Expr>,
        radius: Option<Expr>,
    },
    /// `start on P10..P1 at 3 m`
    Start(PlaceExpr),
    Photocell(PlaceExpr),
    Induction {
        name: Name,
        place: PlaceExpr,
    },
    /// `chutes row_a on P7..P8 from 2 m every 1.25 m count 12`
    Chutes {
        name: Name,
        row: RowExpr,
    },
    /// `scanner on P1..P2 at 8 m`
    Scanner(PlaceExpr),
    /// `induction west of induction_45 anywhere`, `chutes row_a of chute at least 40 on P1..P2`
    Equipped(Box<EquippedExpr>),
    /// `feed west 3000 per hour up to 4500 per hour efficiency 90 % to row_a 1, row_b 2`
    Feed {
        induction: Name,
        rate: Option<Expr>,
        most: Option<Expr>,
        efficiency: Option<Expr>,
        /// None where its items go wherever all do.
        shares: Vec<(Name, Expr)>,
    },
    /// `storage row_a 12 every 6 s`, `storage row_a 12`
    Storage {
        chutes: Name,
        count: Expr,
        every: Option<Expr>,
    },
    /// `items laps 5 double 8 % unread 1 %`
    Items {
        laps: Option<Expr>,
        double: Option<Expr>,
        unread: Option<Expr>,
    },
    /// `stops every 40 min for 2 min`
    Stops {
        every: Expr,
        duration: Expr,
    },
    /// `fails west every 8 h for 10 min`
    Fails {
        equipment: Name,
        every: Expr,
        duration: Expr,
    },
    /// `waves every 30 min changeover 2 min spread 40 %`
    Waves {
        every: Expr,
        changeover: Option<Expr>,
        spread: Option<Expr>,
    },
    /// `wave morning to row_a 3, row_b 1`
    Wave {
        name: Name,
        shares: Vec<(Name, Expr)>,
    },
    /// `require capacity >= 11000 per hour "the evening's peak"`
    RequireCapacity {
        least: Expr,
        reason: Option<String>,
    },
    /// `choose cart tilt_tray, cross_belt lengths 600 mm .. 1000 mm`
    ChooseCart {
        carts: Vec<Reference>,
        lengths: Option<(Expr, Expr)>,
    },
    /// `choose motor linear_motor, linear_motor_800 on straights`
    ChooseMotor {
        motors: Vec<Reference>,
        on_straights: bool,
    },
    /// `choose sensor light, standard`, `choose take_up spring_20, spring_60`
    ChooseComponent {
        kind: DeclarationKind,
        components: Vec<Reference>,
    },
    /// `choose speed 1.5 m/s .. 2.5 m/s step 0.1 m/s`
    ChooseSpeed(Expr),
    /// `choose radii [3 m, 4 m, 5 m]`
    ChooseRadii(Expr),
    /// `choose count row_a, row_b 16 .. 24 step 4`
    ChooseCount {
        equipment: Vec<Name>,
        counts: Expr,
    },
    /// `drive load 15 kg starts within 20 s stops within 4 s spare 1`
    Drive {
        load: Option<Expr>,
        starts: Option<Expr>,
        stops: Option<Expr>,
        spare: Option<Expr>,
    },
    /// `energy 0.22 EUR/kWh for 6000 h per year over 10 years`
    Energy {
        price: Expr,
        hours: Expr,
        years: Expr,
    },
    /// `motors 13 evenly`
    MotorsEvenly {
        count: Expr,
    },
    /// `motors on P1..P2 from 2 m every 3 m count 4`
    MotorsRow(RowExpr),
    /// `supports every 2.5 m`
    Supports {
        every: Expr,
    },
    /// `sensor_cart at cart 1`
    SensorCart {
        cart: Expr,
    },
    /// `chain tension 500 N`
    ChainTension(Expr),
    /// `chain closes within 20 mm`
    ChainCloses(Expr),
    /// `effect joint_clearance(gap: 0.05 mm)`
    Effect(Reference),
    /// `axis "1" x = 0 m every 6 m count 8`
    GridAxis {
        name: TextExpr,
        axis: Axis,
        at: Expr,
        /// Distance and count, when there are several.
        row: Option<(Expr, Expr)>,
    },
    /// `drawing origin (2 m, 1 m)`
    DrawingOrigin(PointExpr),
    /// `drawing revision "B"`
    DrawingField {
        field: TitleField,
        text: TextExpr,
    },
    Optimise(ObjectiveExpr),
    /// `section inductions (5 m, 2 m)..(35 m, 2 m)`, `section chutes 40 m within (0 m, 30 m)..(80 m, 30 m) either way`,
    /// with `on P1..P2` where the layout has vertices
    Section(Box<PlacedSection>),
    /// `route inductions, chutes in any order`
    Route {
        sections: Vec<Name>,
        any_order: bool,
    },
    Bad,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FixKind {
    Length,
    Rotation,
    Parallel,
    Perpendicular,
    All,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    Less,
    LessEqual,
    Equal,
    GreaterEqual,
    Greater,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    X,
    Y,
}

/// What of a drawing's title block a layout says (ISO 7200).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TitleField {
    Project,
    Number,
    Revision,
    Date,
    Author,
    Checked,
    Approved,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SideWord {
    Left,
    Right,
    Either,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    Length,
    Cost,
    TotalPrice,
    PolygonAction,
    Nothing,
}

impl Goal {
    /// Whether it takes no other goal, weight or budget beside it.
    pub fn stands_alone(self) -> bool {
        matches!(self, Goal::TotalPrice | Goal::Nothing)
    }
}

/// `optimise polygon_action within length + 0.5 %`, `optimise 0.7 * length + 0.3 * cost`.
#[derive(Clone, Debug)]
pub struct ObjectiveExpr {
    /// Weight (1 when not written) and goal.
    pub terms: Vec<(Option<Expr>, Goal, Span)>,
    pub within: Option<(Goal, Expr)>,
    pub span: Span,
}
