//! A layout's statements after `from`: what a variant names replaces what it extends, the rest stays.

use std::collections::BTreeMap;
use std::rc::Rc;

use crate::diagnostic::{Code, Diagnostic};
use crate::semantics::arguments::Arguments;
use crate::semantics::program::{Space, Symbol, repeated};
use crate::semantics::scope::{Context, Env, Local, Slot};
use crate::source::Span;
use crate::syntax::tree::{DeclarationKind, Item, LayoutDeclaration, Name, Statement, StationWord, TitleField};

/// A statement with the names that it sees.
#[derive(Clone, Debug)]
pub(super) struct Placed<'t> {
    pub statement: &'t Statement,
    pub span: Span,
    pub env: Rc<Env<'t>>,
    /// How many variants deep it was written; the base is 0.
    layer: usize,
}

/// Which statements stand for the same thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Key<'t> {
    /// One a layout, by its keyword.
    Once(&'static str),
    Vertex(&'t str),
    Obstacle(&'t str),
    Induction(&'t str),
    Chutes(&'t str),
    /// A scanner, a gate or a lift.
    Station(&'t str),
    Feed(&'t str),
    Storage(&'t str),
    Fails(&'t str),
    Wave(&'t str),
    Pass(&'t str),
    /// The first of a row.
    GridAxis(&'t str),
    Section(&'t str),
}

/// All statements of a layout.
#[derive(Debug)]
pub(super) struct Draft<'t> {
    pub name: &'t Name,
    /// Behind the brace that opens its block, if it has one: where a statement can be put in.
    pub opens: Option<Span>,
    /// In driving order where that counts.
    pub statements: Vec<Placed<'t>>,
    keys: BTreeMap<Key<'t>, usize>,
    /// Texts of statements that did not parse, here or in the layouts that this one extends.
    pub bad: Vec<String>,
    /// The innermost environment, for lets.
    env: Rc<Env<'t>>,
    layer: usize,
    /// A vertex' name was given twice: which of the two the others mean is not known.
    pub doubtful: bool,
    /// False when `from` could not be resolved: nothing is missing then.
    pub base_known: bool,
}

impl<'t> Draft<'t> {
    /// What the layout's own statements see.
    pub fn innermost(&self) -> &Rc<Env<'t>> {
        &self.env
    }

    /// The statement that a layout has once, by keyword.
    pub fn once(&self, keyword: &'static str) -> Option<&Placed<'t>> {
        self.keys.get(&Key::Once(keyword)).map(|i| &self.statements[*i])
    }

    /// Whether items are read somewhere.
    pub fn has_scanner(&self) -> bool {
        self.statements.iter().any(|placed| match placed.statement {
            Statement::Scanner(_) => true,
            Statement::Equipped(equipped) => equipped.word == StationWord::Scanner,
            _ => false,
        })
    }
}

/// The words that a field of the title block begins with.
fn title_key(field: TitleField) -> &'static str {
    match field {
        TitleField::Project => "drawing project",
        TitleField::Number => "drawing number",
        TitleField::Revision => "drawing revision",
        TitleField::Date => "drawing date",
        TitleField::Author => "drawing author",
        TitleField::Checked => "drawing checked",
        TitleField::Approved => "drawing approved",
    }
}

/// What a statement stands for; `None` when any number of them may stand side by side.
fn key(statement: &Statement) -> Option<(Key<'_>, Option<&Name>)> {
    let once = |keyword| Some((Key::Once(keyword), None));
    match statement {
        Statement::Component { kind, .. } => once(Space::Component(*kind).word()),
        Statement::Speed(_) => once("speed"),
        Statement::Width(_) => once("width"),
        Statement::Building { .. } => once("building"),
        Statement::Turns { .. } => once("turns"),
        Statement::Radii { .. } => once("radii"),
        Statement::Start(_) => once("start"),
        Statement::Photocell(_) => once("photocell"),
        Statement::Items { .. } => once("items"),
        Statement::Stops { .. } => once("stops"),
        Statement::Waves { .. } => once("waves"),
        Statement::Wave { name, .. } => Some((Key::Wave(&name.text), Some(name))),
        Statement::Fails { equipment, .. } => Some((Key::Fails(&equipment.text), Some(equipment))),
        Statement::RequireCapacity { .. } => once("require capacity"),
        Statement::ChooseCart { .. } => once("choose cart"),
        Statement::ChooseMotor { .. } => once("choose motor"),
        Statement::ChooseComponent { kind: DeclarationKind::TakeUp, .. } => once("choose take_up"),
        Statement::ChooseComponent { .. } => once("choose sensor"),
        Statement::ChooseSpeed(_) => once("choose speed"),
        Statement::ChooseRadii(_) => once("choose radii"),
        Statement::Drive { .. } => once("drive"),
        Statement::Energy { .. } => once("energy"),
        Statement::Feed { induction, .. } => Some((Key::Feed(&induction.text), Some(induction))),
        Statement::Storage { chutes, .. } => Some((Key::Storage(&chutes.text), Some(chutes))),
        Statement::MotorsEvenly { .. } => once("motors"),
        Statement::Supports { .. } => once("supports"),
        Statement::SensorCart { .. } => once("sensor_cart"),
        Statement::ChainTension(_) => once("chain tension"),
        Statement::ChainCloses(_) => once("chain closes"),
        Statement::DrawingOrigin(_) => once("drawing origin"),
        Statement::DrawingField { field, .. } => once(title_key(*field)),
        Statement::Optimise(_) => once("optimise"),
        Statement::Route { .. } => once("route"),
        Statement::Section(section) => Some((Key::Section(&section.name.text), Some(&section.name))),
        Statement::Vertex { name, .. } => Some((Key::Vertex(&name.text), Some(name))),
        Statement::Obstacle { name, .. } => Some((Key::Obstacle(&name.text), Some(name))),
        Statement::Induction { name, .. } => Some((Key::Induction(&name.text), Some(name))),
        Statement::Chutes { name, .. } => Some((Key::Chutes(&name.text), Some(name))),
        Statement::Equipped(equipped) => {
            let name = &equipped.name;
            let key = match equipped.word {
                StationWord::Induction => Key::Induction(&name.text),
                StationWord::Chutes => Key::Chutes(&name.text),
                StationWord::Scanner | StationWord::Gate | StationWord::Lift => Key::Station(&name.text),
            };
            Some((key, Some(name)))
        }
        Statement::Pass { obstacle, .. } => Some((Key::Pass(&obstacle.text), None)),
        Statement::GridAxis { name, .. } => Some((Key::GridAxis(&name.text), None)),
        _ => None,
    }
}

impl<'t> Context<'t> {
    /// The layout's statements with its arguments in.
    pub(super) fn draft(
        &self,
        symbol: Symbol,
        layout: &'t LayoutDeclaration,
        args: Arguments<'t>,
        used_at: Span,
    ) -> Option<Draft<'t>> {
        if self.instantiating.borrow().contains(&symbol) {
            let message = format!("the layout `{}` extends itself", layout.name.text);
            self.report(
                Diagnostic::new(Code::E0216, message, used_at, "needed to declare itself")
                    .related(layout.name.span, "declared here")
                    .help("extend another layout, or none"),
            );
            return None;
        }
        self.instantiating.borrow_mut().push(symbol);
        let draft = self.deeper(used_at, || self.draft_here(symbol, layout, args));
        self.instantiating.borrow_mut().pop();
        draft
    }

    fn draft_here(&self, symbol: Symbol, layout: &'t LayoutDeclaration, args: Arguments<'t>) -> Draft<'t> {
        let params = self.bind(symbol.module, &layout.params, args, &layout.name);
        let base = layout.from.as_ref().map(|from| {
            let env = Rc::new(Env { module: symbol.module, locals: params.clone(), outer: None });
            let base = self.resolve(symbol.module, Space::Layout, &from.name)?;
            let Item::Layout(declaration) = self.program.item(base) else { return None };
            let args = match &from.args {
                Some(block) => self.arguments(&env, &from.name, block),
                None => Arguments::new(),
            };
            self.draft(base, declaration, args, from.name.span)
        });
        let (base, base_known) = match base {
            None => (None, true),
            Some(base) => {
                let known = base.as_ref().is_some_and(|b| b.base_known);
                (base, known)
            }
        };
        let env = Rc::new(Env {
            module: symbol.module,
            locals: self.with_lets(layout, params),
            outer: base.as_ref().map(|b| b.env.clone()),
        });
        let mut draft = base.unwrap_or_else(|| Draft {
            name: &layout.name,
            opens: None,
            statements: Vec::new(),
            keys: BTreeMap::new(),
            bad: Vec::new(),
            env: env.clone(),
            layer: 0,
            doubtful: false,
            base_known: true,
        });
        draft.layer += usize::from(layout.from.is_some());
        let body = layout.body.span;
        let opens = (!layout.body.is_absent()).then(|| Span { start: body.start + 1, end: body.start + 1, ..body });
        draft = Draft { name: &layout.name, opens, env, base_known, ..draft };
        draft.replace_rows(layout);
        draft.replace_way(layout);
        for node in &layout.body.nodes {
            match &node.value {
                Statement::Bad => draft.bad.push(self.sources.text(node.span).to_string()),
                Statement::Let(_) => {}
                statement => self.place(&mut draft, statement, node.span),
            }
        }
        draft
    }

    /// The layout's own lets beside its parameters; a name given twice is reported.
    fn with_lets(
        &self,
        layout: &'t LayoutDeclaration,
        params: BTreeMap<&'t str, Local<'t>>,
    ) -> BTreeMap<&'t str, Local<'t>> {
        let mut locals = params;
        let mut first: BTreeMap<&'t str, &'t Name> = BTreeMap::new();
        first.extend(layout.params.nodes.iter().map(|n| (n.value.name.text.as_str(), &n.value.name)));
        for node in &layout.body.nodes {
            let Statement::Let(item) = &node.value else { continue };
            match first.get(item.name.text.as_str()) {
                Some(earlier) => self.report(repeated("value", &item.name, earlier.span)),
                None => {
                    first.insert(&item.name.text, &item.name);
                    locals.insert(&item.name.text, Local::Let(Slot::new(item)));
                }
            }
        }
        locals
    }

    fn place(&self, draft: &mut Draft<'t>, statement: &'t Statement, span: Span) {
        let placed = Placed { statement, span, env: draft.env.clone(), layer: draft.layer };
        let Some((key, name)) = key(statement) else {
            draft.statements.push(placed);
            return;
        };
        let Some(index) = draft.keys.get(&key).copied() else {
            draft.keys.insert(key, draft.statements.len());
            draft.statements.push(placed);
            return;
        };
        if draft.statements[index].layer < draft.layer {
            draft.statements[index] = placed;
            return;
        }
        let first = draft.statements[index].clone();
        match (key, name) {
            (Key::Once(keyword), _) => self.report(
                Diagnostic::new(Code::E0213, format!("`{keyword}` is said twice"), span, "said again")
                    .related(first.span, "first said here")
                    .help("remove one of the two"),
            ),
            // Names that meet are told of where rows are counted out.
            (Key::GridAxis(_), _) => draft.statements.push(placed),
            (Key::Pass(_), _) => self.passed_twice(first.statement, first.span, statement, span),
            (_, Some(name)) => {
                let what = match key {
                    Key::Vertex(_) => {
                        draft.doubtful = true;
                        "vertex"
                    }
                    Key::Obstacle(_) => "obstacle",
                    Key::Induction(_) => "induction",
                    Key::Section(_) => "section",
                    Key::Station(_) => "station",
                    Key::Feed(_) => "feed of",
                    Key::Storage(_) => "storage of",
                    Key::Fails(_) => "failure of",
                    Key::Wave(_) => "wave",
                    _ => "row of chutes",
                };
                let first = self::key(first.statement).and_then(|(_, n)| n).map_or(first.span, |n| n.span);
                self.report(repeated(what, name, first));
            }
            _ => {}
        }
    }

    fn passed_twice(&self, first: &Statement, first_span: Span, second: &Statement, span: Span) {
        let (Statement::Pass { side: a, .. }, Statement::Pass { side: b, obstacle }) = (first, second) else { return };
        let name = &obstacle.text;
        self.report(match a == b {
            true => Diagnostic::new(Code::W0704, format!("`{name}` is passed twice"), span, "says nothing new")
                .related(first_span, "said here")
                .help("remove it")
                .fix(span, ""),
            false => Diagnostic::new(Code::E0502, format!("`{name}` is passed on two sides"), span, "one side")
                .related(first_span, "another side")
                .expected("one side", "two")
                .help(format!("`pass {name} either` leaves the choice to the optimiser")),
        });
    }
}

impl<'t> Draft<'t> {
    /// Motors: a variant that places any replaces all that it extends, evenly or in rows.
    fn replace_rows(&mut self, layout: &LayoutDeclaration) {
        let motors = |s: &Statement| matches!(s, Statement::MotorsEvenly { .. } | Statement::MotorsRow(_));
        if layout.from.is_none() || !layout.body.nodes.iter().any(|n| motors(&n.value)) {
            return;
        }
        self.statements.retain(|p| !motors(p.statement));
        self.keys = self.statements.iter().enumerate().filter_map(|(i, p)| Some((key(p.statement)?.0, i))).collect();
    }
}

impl<'t> Draft<'t> {
    /// Vertices of a variant replace the route of what it extends, and its route their vertices.
    fn replace_way(&mut self, layout: &LayoutDeclaration) {
        let own = |of: fn(&Statement) -> bool| layout.body.nodes.iter().any(|n| of(&n.value));
        let vertex = |s: &Statement| matches!(s, Statement::Vertex { .. });
        let route = |s: &Statement| matches!(s, Statement::Route { .. });
        match (layout.from.is_some(), own(vertex), own(route)) {
            (true, true, false) => self.statements.retain(|p| !route(p.statement)),
            (true, false, true) => self.statements.retain(|p| !vertex(p.statement)),
            _ => return,
        }
        self.keys = self.statements.iter().enumerate().filter_map(|(i, p)| Some((key(p.statement)?.0, i))).collect();
    }
}

/// The keyword of a component statement.
pub(super) fn keyword(kind: DeclarationKind) -> &'static str {
    Space::Component(kind).word()
}
