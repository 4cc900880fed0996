//! The keywords of the tree's enumerations: how each is written.

use super::tree::*;

impl DeclarationKind {
    pub const ALL: [DeclarationKind; 9] = [
        DeclarationKind::Catalog,
        DeclarationKind::Cart,
        DeclarationKind::Wheel,
        DeclarationKind::Joint,
        DeclarationKind::Motor,
        DeclarationKind::Controller,
        DeclarationKind::Sensor,
        DeclarationKind::TakeUp,
        DeclarationKind::Equipment,
    ];

    pub fn word(self) -> &'static str {
        match self {
            DeclarationKind::Catalog => "catalog",
            DeclarationKind::Cart => "cart",
            DeclarationKind::Wheel => "wheel",
            DeclarationKind::Joint => "joint",
            DeclarationKind::Motor => "motor",
            DeclarationKind::Controller => "controller",
            DeclarationKind::Sensor => "sensor",
            DeclarationKind::TakeUp => "take_up",
            DeclarationKind::Equipment => "equipment",
        }
    }
}

impl FixKind {
    pub const ALL: [FixKind; 5] =
        [FixKind::Length, FixKind::Rotation, FixKind::Parallel, FixKind::Perpendicular, FixKind::All];

    pub fn word(self) -> &'static str {
        match self {
            FixKind::Length => "length",
            FixKind::Rotation => "rotation",
            FixKind::Parallel => "parallel",
            FixKind::Perpendicular => "perpendicular",
            FixKind::All => "all",
        }
    }
}

impl StationWord {
    pub const ALL: [StationWord; 5] =
        [StationWord::Induction, StationWord::Chutes, StationWord::Scanner, StationWord::Gate, StationWord::Lift];

    pub fn word(self) -> &'static str {
        match self {
            StationWord::Induction => "induction",
            StationWord::Chutes => "chutes",
            StationWord::Scanner => "scanner",
            StationWord::Gate => "gate",
            StationWord::Lift => "lift",
        }
    }
}

impl Goal {
    pub const ALL: [Goal; 5] = [Goal::Length, Goal::Cost, Goal::TotalPrice, Goal::PolygonAction, Goal::Nothing];

    pub fn word(self) -> &'static str {
        match self {
            Goal::Length => "length",
            Goal::Cost => "cost",
            Goal::TotalPrice => "total_price",
            Goal::PolygonAction => "polygon_action",
            Goal::Nothing => "nothing",
        }
    }
}

impl TitleField {
    pub const ALL: [TitleField; 7] = [
        TitleField::Project,
        TitleField::Number,
        TitleField::Revision,
        TitleField::Date,
        TitleField::Author,
        TitleField::Checked,
        TitleField::Approved,
    ];

    pub fn word(self) -> &'static str {
        match self {
            TitleField::Project => "project",
            TitleField::Number => "number",
            TitleField::Revision => "revision",
            TitleField::Date => "date",
            TitleField::Author => "author",
            TitleField::Checked => "checked",
            TitleField::Approved => "approved",
        }
    }
}

impl Axis {
    pub fn word(self) -> &'static str {
        match self {
            Axis::X => "x",
            Axis::Y => "y",
        }
    }
}

impl SideWord {
    pub const ALL: [SideWord; 3] = [SideWord::Left, SideWord::Right, SideWord::Either];

    pub fn word(self) -> &'static str {
        match self {
            SideWord::Left => "left",
            SideWord::Right => "right",
            SideWord::Either => "either",
        }
    }
}

impl Relation {
    pub fn sign(self) -> &'static str {
        match self {
            Relation::Less => "<",
            Relation::LessEqual => "<=",
            Relation::Equal => "==",
            Relation::GreaterEqual => ">=",
            Relation::Greater => ">",
        }
    }
}
