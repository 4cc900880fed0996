//! The syntax tree: what was written, with every comment and every span, and no meaning yet.
//!
//! Lists that may span lines (statements in a block, polygon points, arguments) hold [`Node`]s, which carry the
//! comments around an item; comments can stand nowhere else, so the formatter keeps them all.

use crate::source::{FileId, Span};

/// A whole file.
#[derive(Clone, Debug)]
pub struct Tree {
    pub file: FileId,
    pub items: Block<Item>,
}

/// An item of a list with the comments that belong to it.
#[derive(Clone, Debug)]
pub struct Node<T> {
    /// Comment lines directly above the item (text with the leading `//`, trimmed at the end). An empty string
    /// stands for a blank line between comments.
    pub above: Vec<String>,
    /// Whether a blank line separates this item (with its comments) from the one before.
    pub blank_before: bool,
    pub value: T,
    /// Comment at the end of the item's (last) line.
    pub beside: Option<String>,
    pub span: Span,
}

/// Items between braces, brackets or parentheses, and the comments after the last one (an empty string stands for a
/// blank line there too).
#[derive(Clone, Debug)]
pub struct Block<T> {
    pub nodes: Vec<Node<T>>,
    /// Comments after the last item.
    pub tail: Vec<String>,
    /// Comment on the line of the opening bracket.
    pub beside_open: Option<String>,
    /// Whether the writer put it on several lines (lists and arguments keep that choice).
    pub multiline: bool,
    pub span: Span,
}

impl<T> Block<T> {
    /// A block that was not written: nothing between brackets that are not there.
    pub fn absent(span: Span) -> Self {
        Block {
            nodes: Vec::new(),
            tail: Vec::new(),
            beside_open: None,
            multiline: false,
            span: Span { end: span.start, ..span },
        }
    }

    /// Whether the brackets themselves were left out.
    pub fn is_absent(&self) -> bool {
        self.span.start == self.span.end
    }

    /// The items without their comments.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &T> + ExactSizeIterator {
        self.nodes.iter().map(|node| &node.value)
    }

    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    pub text: String,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Item {
    Use(Use),
    Let(Let),
    Declaration(Declaration),
    Layout(LayoutDeclaration),
    /// A statement that did not parse; already reported. The formatter refuses a file with one.
    Bad,
}

/// `use std.tracks.standard` (the path as written, with `std`) or `use "../shared/carts.lss"`.
#[derive(Clone, Debug)]
pub enum Use {
    Std { path: Vec<Name>, span: Span },
    File { path: String, span: Span },
}

/// `let aisle = 2 * 1.2 m`.
#[derive(Clone, Debug)]
pub struct Let {
    pub name: Name,
    pub value: Expr,
}

/// What a declaration beside `layout` declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DeclarationKind {
    Catalog,
    Cart,
    Wheel,
    Joint,
    Motor,
    Controller,
    Sensor,
    Equipment,
}

/// `cart heavy(length: 1250 mm) from tilt_tray(length: length) { mass = 52 kg }`. With `from` the body may be absent.
#[derive(Clone, Debug)]
pub struct Declaration {
    pub kind: DeclarationKind,
    pub kind_span: Span,
    pub name: Name,
    pub params: Block<Param>,
    pub from: Option<Reference>,
    pub fields: Block<Field>,
    pub span: Span,
}

/// A parameter with its default, which also gives its dimension.
#[derive(Clone, Debug)]
pub struct Param {
    pub name: Name,
    pub default: Expr,
}

/// A declaration's name with arguments: `tilt_tray(length: 1250 mm)`.
#[derive(Clone, Debug)]
pub struct Reference {
    pub name: Name,
    pub args: Option<Block<Arg>>,
    pub span: Span,
}

/// An argument; calls of functions have unnamed ones.
#[derive(Clone, Debug)]
pub struct Arg {
    pub name: Option<Name>,
    pub value: Expr,
}

#[derive(Clone, Debug)]
pub enum Field {
    /// `mass = 52 kg`
    Value {
        name: Name,
        value: Expr,
    },
    /// `straight { ... }`
    Group {
        name: Name,
        fields: Block<Field>,
    },
    Bad,
}

/// `layout west_b from west_a { ... }`. With `from` the body may be absent.
#[derive(Clone, Debug)]
pub struct LayoutDeclaration {
    pub name: Name,
    pub params: Block<Param>,
    pub from: Option<Reference>,
    pub body: Block<Statement>,
    pub span: Span,
}

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
    /// `choose speed 1.5 m/s .. 2.5 m/s step 0.1 m/s`
    ChooseSpeed(Expr),
    /// `choose radii [3 m, 4 m, 5 m]`
    ChooseRadii(Expr),
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

/// A text in quotes, without them.
#[derive(Clone, Debug, PartialEq)]
pub struct TextExpr {
    pub text: String,
    pub span: Span,
}

/// `(28.0 m, 1.5 m)`.
#[derive(Clone, Debug)]
pub struct PointExpr {
    pub x: Expr,
    pub y: Expr,
    pub span: Span,
}

/// `section chutes 40 m within (0 m, 30 m)..(80 m, 30 m) either way on P1..P2`.
#[derive(Clone, Debug)]
pub struct PlacedSection {
    pub name: Name,
    /// With the line that it slides along, else it runs from end to end.
    pub length: Option<Expr>,
    pub from: PointExpr,
    pub to: PointExpr,
    pub either_way: bool,
    pub on: Option<Section>,
}

/// `P4..P5`.
#[derive(Clone, Debug)]
pub struct Section {
    pub from: Name,
    pub to: Name,
    pub span: Span,
}

/// A section between vertices, or the straight between its tangent points.
#[derive(Clone, Debug)]
pub struct Target {
    pub section: Section,
    /// `straight(P4..P5)` rather than `P4..P5`.
    pub straight: bool,
    pub span: Span,
}

/// `on P1..P2 at 6 m`.
#[derive(Clone, Debug)]
pub struct PlaceExpr {
    pub section: Section,
    pub at: Expr,
}

/// `on P7..P8 from 2 m every 1.25 m count 12`.
#[derive(Clone, Debug)]
pub struct RowExpr {
    pub section: Section,
    pub from: Expr,
    pub every: Expr,
    pub count: Expr,
}

/// Equipment of a declared kind.
#[derive(Clone, Debug)]
pub struct EquippedExpr {
    pub word: StationWord,
    pub name: Name,
    pub of: Reference,
    pub place: EquippedPlace,
    /// Where its conveyor begins.
    pub fed: Option<PointExpr>,
}

/// What a statement places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StationWord {
    Induction,
    Chutes,
    Scanner,
    Gate,
    Lift,
}

#[derive(Clone, Debug)]
pub enum EquippedPlace {
    /// `on P1..P2 at 6 m`
    At(PlaceExpr),
    /// `on P7..P8 from 2 m every 1.25 m count 12`
    Row(Box<RowExpr>),
    /// `at least 40 on P1..P2, P3..P4 after west before row_b`
    Free {
        /// Of chutes.
        least: Option<Expr>,
        /// None: `anywhere`.
        on: Vec<Section>,
        after: Vec<Name>,
        before: Vec<Name>,
    },
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
    PolygonAction,
    Nothing,
}

/// `optimise polygon_action within length + 0.5 %`, `optimise 0.7 * length + 0.3 * cost`.
#[derive(Clone, Debug)]
pub struct ObjectiveExpr {
    /// Weight (1 when not written) and goal.
    pub terms: Vec<(Option<Expr>, Goal, Span)>,
    pub within: Option<(Goal, Expr)>,
    pub span: Span,
}

/// An expression. Sums and products are flat, so that a long one does not nest.
#[derive(Clone, Debug)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum ExprKind {
    /// The digits as written, and the unit as written.
    Number {
        digits: String,
        unit: Option<Name>,
    },
    Text(String),
    Name(String),
    /// `length(P4..P5)`, `straight(P4..P5)`, `tilt_tray(length: 1250 mm)`
    Call {
        name: Name,
        args: Block<Arg>,
    },
    Negative(Box<Expr>),
    Sum {
        first: Box<Expr>,
        rest: Vec<(SumOp, Expr)>,
    },
    Product {
        first: Box<Expr>,
        rest: Vec<(ProductOp, Expr)>,
    },
    Paren(Box<Expr>),
    /// `[3 m, 4 m]`
    List(Block<Expr>),
    /// `(1 m, 2 m)`
    Tuple(Vec<Expr>),
    /// `P4..P5`, `3 m .. 8 m`, `500 mm .. 1250 mm step 50 mm`
    Range {
        low: Box<Expr>,
        high: Box<Expr>,
        step: Option<Box<Expr>>,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SumOp {
    Plus,
    Minus,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProductOp {
    Times,
    Divide,
}
