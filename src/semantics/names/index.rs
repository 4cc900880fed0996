//! Walks the trees of a program and says of each name what it stands for.

use super::scopes::{Part, Scope, declared, of_layouts};
use super::{LayoutNames, NameKind, Names, Occurrence, Visible};
use crate::model::effect_definitions::EFFECTS;
use crate::semantics::fields::{Shape, fields};
use crate::semantics::functions;
use crate::semantics::program::{Program, Space, Symbol, named};
use crate::source::{STDLIB, Span};
use crate::syntax::tree::*;

pub fn index(program: &Program) -> Names {
    let scopes = of_layouts(program);
    let mut index = Index { program, found: Vec::new() };
    for (module, file) in program.modules.iter().enumerate() {
        let global = Scope::of_file(module);
        for (number, node) in file.tree.items.nodes.iter().enumerate() {
            if let Some((space, name)) = named(&node.value) {
                index.declare(name, space.into(), name.span);
            }
            match &node.value {
                Item::Use(item) => index.import(item),
                Item::Let(item) => index.expression(&global, &item.value),
                Item::Declaration(item) => index.declaration(module, item),
                Item::Layout(item) => {
                    index.params(module, &item.params);
                    let params = Scope::of_params(module, &item.params);
                    index.reference(&params, Space::Layout, item.from.as_ref());
                    if let Some(scope) = scopes.get(&Symbol { module, item: number }) {
                        item.body.iter().for_each(|statement| index.statement(scope, statement));
                    }
                }
                Item::Bad => {}
            }
        }
    }
    let mut occurrences = index.found;
    occurrences.sort_unstable();
    occurrences.dedup();
    let layouts = scopes.iter().filter_map(|(symbol, scope)| match program.item(*symbol) {
        Item::Layout(layout) => {
            Some(LayoutNames { name: layout.name.text.clone(), span: layout.span, names: scope.visible() })
        }
        _ => None,
    });
    let files = program.modules.iter().map(|module| {
        let own = module.own.iter();
        let all = own.chain(module.imported.iter().map(|(key, (symbol, _))| (key, symbol)));
        let seen = all.filter_map(|((space, name), symbol)| {
            let definition = named(program.item(*symbol))?.1.span;
            Some(Visible { name: name.clone(), kind: (*space).into(), definition })
        });
        (module.file, seen.collect())
    });
    Names { occurrences, layouts: layouts.collect(), files: files.collect() }
}

/// The name without the space behind it, which belongs to its expression.
fn own(name: &str, expr: Span) -> Span {
    Span { end: expr.end.min(expr.start + name.len() as u32), ..expr }
}

struct Index<'p> {
    program: &'p Program,
    found: Vec<Occurrence>,
}

impl Index<'_> {
    fn push(&mut self, span: Span, kind: NameKind, definition: Option<Span>, symbol: Option<Span>) {
        self.found.push(Occurrence { span, kind, definition, symbol });
    }

    fn declare(&mut self, name: &Name, kind: NameKind, symbol: Span) {
        self.push(name.span, kind, Some(name.span), Some(symbol));
    }

    /// A name that nothing declares.
    fn known(&mut self, span: Span, kind: NameKind) {
        self.push(span, kind, None, None);
    }

    fn used(&mut self, span: Span, kind: NameKind, definition: Span) {
        self.push(span, kind, Some(definition), Some(definition));
    }

    /// The item that a name stands for.
    fn item(&mut self, module: usize, space: Space, text: &str, span: Span) -> Option<Symbol> {
        let (symbol, _) = self.program.modules[module].find(space, text)?;
        let (_, name) = named(self.program.item(symbol))?;
        self.used(span, space.into(), name.span);
        Some(symbol)
    }

    fn import(&mut self, item: &Use) {
        let Use::Std { path, .. } = item else { return };
        let [_, module, rest @ ..] = &path[..] else { return };
        if !STDLIB.iter().any(|(name, _)| *name == module.text) {
            return;
        }
        let home = self.program.modules.iter().find(|m| m.standard == Some(&module.text));
        let start = home.map(|home| Span::new(home.file, 0, 0));
        self.push(module.span, NameKind::Module, start, None);
        let (Some(item), Some(home)) = (rest.first(), home) else { return };
        for ((space, _), symbol) in home.own.iter().filter(|((_, name), _)| *name == item.text) {
            if let Some((_, name)) = named(self.program.item(*symbol)) {
                self.used(item.span, (*space).into(), name.span);
            }
        }
    }

    fn params(&mut self, module: usize, params: &Block<Param>) {
        let global = Scope::of_file(module);
        for param in params.iter() {
            self.declare(&param.name, NameKind::Parameter, param.name.span);
            self.expression(&global, &param.default);
        }
    }

    fn declaration(&mut self, module: usize, declaration: &Declaration) {
        self.params(module, &declaration.params);
        let scope = Scope::of_params(module, &declaration.params);
        self.reference(&scope, Space::Component(declaration.kind), declaration.from.as_ref());
        self.fields(&scope, declaration.kind, "", &declaration.fields);
    }

    fn fields(&mut self, scope: &Scope, kind: DeclarationKind, prefix: &str, block: &Block<Field>) {
        for field in block.iter() {
            let (Field::Value { name, .. } | Field::Group { name, .. }) = field else { continue };
            let path = format!("{prefix}{}", name.text);
            let spec = fields(kind).iter().find(|f| f.path == path);
            let group = fields(kind).iter().any(|f| f.path.strip_prefix(&path).is_some_and(|r| r.starts_with('.')));
            if spec.is_some() || group {
                self.known(name.span, NameKind::Field(kind, path.clone()));
            }
            match field {
                Field::Group { fields, .. } => self.fields(scope, kind, &format!("{path}."), fields),
                Field::Value { value, .. } => match (spec.map(|s| s.shape), &value.kind) {
                    (Some(Shape::Reference(kind)), ExprKind::Name(text)) => {
                        self.item(scope.module, Space::Component(kind), text, own(text, value.span));
                    }
                    (Some(Shape::Reference(kind)), ExprKind::Call { name, args }) => {
                        self.instance(scope, Space::Component(kind), name, Some(args));
                    }
                    _ => self.expression(scope, value),
                },
                Field::Bad => {}
            }
        }
    }

    fn reference(&mut self, scope: &Scope, space: Space, reference: Option<&Reference>) {
        if let Some(reference) = reference {
            self.instance(scope, space, &reference.name, reference.args.as_ref());
        }
    }

    /// A declaration's name with arguments.
    fn instance(&mut self, scope: &Scope, space: Space, name: &Name, args: Option<&Block<Arg>>) {
        let symbol = self.item(scope.module, space, &name.text, name.span);
        let program = self.program;
        let params = symbol.and_then(|symbol| match program.item(symbol) {
            Item::Declaration(declaration) => Some(&declaration.params),
            Item::Layout(layout) => Some(&layout.params),
            Item::Use(_) | Item::Let(_) | Item::Bad => None,
        });
        for arg in args.iter().flat_map(|args| args.iter()) {
            let param = arg.name.as_ref().zip(params).and_then(|(name, params)| {
                let param = params.iter().find(|p| p.name.text == name.text)?;
                Some((name.span, param.name.span))
            });
            if let Some((span, definition)) = param {
                self.used(span, NameKind::Parameter, definition);
            }
            self.expression(scope, &arg.value);
        }
    }

    fn part(&mut self, scope: &Scope, part: Part, name: &Name) {
        if let Some(declared) = scope.part(part, &name.text) {
            self.push(name.span, part.into(), Some(declared.definition), Some(declared.symbol));
        }
    }

    fn section(&mut self, scope: &Scope, section: &Section) {
        self.part(scope, Part::Vertex, &section.from);
        self.part(scope, Part::Vertex, &section.to);
    }

    fn point(&mut self, scope: &Scope, point: &PointExpr) {
        self.expression(scope, &point.x);
        self.expression(scope, &point.y);
    }

    fn all<'e>(&mut self, scope: &Scope, expressions: impl IntoIterator<Item = &'e Expr>) {
        expressions.into_iter().for_each(|expr| self.expression(scope, expr));
    }

    fn row_shares(&mut self, scope: &Scope, shares: &[(Name, Expr)]) {
        for (row, share) in shares {
            self.part(scope, Part::Chutes, row);
            self.expression(scope, share);
        }
    }

    fn row(&mut self, scope: &Scope, row: &RowExpr) {
        self.section(scope, &row.section);
        self.all(scope, [&row.from, &row.every, &row.count]);
    }

    fn statement(&mut self, scope: &Scope, statement: &Statement) {
        if let Some((part, name)) = declared(statement) {
            let symbol = scope.part(part, &name.text).map_or(name.span, |declared| declared.symbol);
            self.declare(name, part.into(), symbol);
        }
        match statement {
            Statement::Let(item) => {
                self.declare(&item.name, NameKind::Value, item.name.span);
                self.expression(scope, &item.value);
            }
            Statement::Component { kind, reference } => self.reference(scope, Space::Component(*kind), Some(reference)),
            Statement::ChooseCart { carts, lengths } => {
                let cart = Space::Component(DeclarationKind::Cart);
                carts.iter().for_each(|reference| self.reference(scope, cart, Some(reference)));
                self.all(scope, lengths.iter().flat_map(|(low, high)| [low, high]));
            }
            Statement::ChooseCount { equipment, counts } => {
                equipment.iter().for_each(|name| self.along(scope, name));
                self.expression(scope, counts);
            }
            Statement::ChooseMotor { motors, .. } => {
                let motor = Space::Component(DeclarationKind::Motor);
                motors.iter().for_each(|reference| self.reference(scope, motor, Some(reference)));
            }
            Statement::ChooseComponent { kind, components } => {
                let space = Space::Component(*kind);
                components.iter().for_each(|reference| self.reference(scope, space, Some(reference)));
            }
            Statement::Drive { load, starts, stops, spare } => {
                self.all(scope, [load, starts, stops, spare].into_iter().flatten());
            }
            Statement::Energy { price, hours, years } => self.all(scope, [price, hours, years]),
            Statement::ChooseSpeed(expr)
            | Statement::ChooseRadii(expr)
            | Statement::Speed(expr)
            | Statement::Width(expr)
            | Statement::ChainTension(expr)
            | Statement::ChainCloses(expr)
            | Statement::MotorsEvenly { count: expr }
            | Statement::Supports { every: expr }
            | Statement::SensorCart { cart: expr } => self.expression(scope, expr),
            Statement::Vertex { point, radius, .. } => {
                self.point(scope, point);
                self.all(scope, radius);
            }
            Statement::Building { polygon, clearance } | Statement::Obstacle { polygon, clearance, .. } => {
                polygon.iter().for_each(|point| self.point(scope, point));
                self.all(scope, clearance);
            }
            Statement::Turns { low, high } | Statement::Radii { low, high } => self.all(scope, [low, high]),
            Statement::FixSection { target, .. } => self.section(scope, &target.section),
            Statement::FixVertex { vertex } | Statement::FixRadius { vertex } => {
                self.part(scope, Part::Vertex, vertex);
            }
            Statement::Require { first, rest, .. } => {
                self.expression(scope, first);
                self.all(scope, rest.iter().map(|(_, _, expr)| expr));
            }
            Statement::Equal { values } => self.all(scope, values),
            Statement::Mirror { first, second, at, .. } => {
                self.part(scope, Part::Vertex, first);
                self.part(scope, Part::Vertex, second);
                self.expression(scope, at);
            }
            Statement::Pass { obstacle, .. } => self.part(scope, Part::Obstacle, obstacle),
            Statement::Level { from, to, height } => {
                self.part(scope, Part::Vertex, from);
                self.part(scope, Part::Vertex, to);
                self.expression(scope, height);
            }
            Statement::Ramp { section, from, slope, radius } => {
                self.section(scope, section);
                self.all(scope, [from, slope, radius].into_iter().flatten());
            }
            Statement::Feed { induction, rate, most, efficiency, shares } => {
                self.part(scope, Part::Induction, induction);
                self.all(scope, [rate, most, efficiency].into_iter().flatten());
                self.row_shares(scope, shares);
            }
            Statement::Storage { chutes, count, every } => {
                self.part(scope, Part::Chutes, chutes);
                self.all(scope, std::iter::once(count).chain(every));
            }
            Statement::Items { laps, double, unread } => {
                self.all(scope, [laps, double, unread].into_iter().flatten());
            }
            Statement::Stops { every, duration } => self.all(scope, [every, duration]),
            Statement::Fails { equipment, every, duration } => {
                let part =
                    if scope.part(Part::Induction, &equipment.text).is_some() { Part::Induction } else { Part::Chutes };
                self.part(scope, part, equipment);
                self.all(scope, [every, duration]);
            }
            Statement::Waves { every, changeover, spread } => {
                self.all(scope, std::iter::once(every).chain(changeover).chain(spread));
            }
            Statement::Wave { shares, .. } => self.row_shares(scope, shares),
            Statement::RequireCapacity { least, .. } => self.expression(scope, least),
            Statement::Start(place)
            | Statement::Photocell(place)
            | Statement::Scanner(place)
            | Statement::Induction { place, .. } => {
                self.section(scope, &place.section);
                self.expression(scope, &place.at);
            }
            Statement::Equipped(equipped) => self.equipped(scope, equipped),
            Statement::Chutes { row, .. } | Statement::MotorsRow(row) => self.row(scope, row),
            Statement::Effect(reference) => self.effect(scope, reference),
            Statement::GridAxis { at, row, .. } => {
                self.expression(scope, at);
                self.all(scope, row.iter().flat_map(|(every, count)| [every, count]));
            }
            Statement::DrawingOrigin(point) => self.point(scope, point),
            Statement::Optimise(objective) => {
                self.all(scope, objective.terms.iter().filter_map(|(weight, ..)| weight.as_ref()));
                self.all(scope, objective.within.iter().map(|(_, ratio)| ratio));
            }
            Statement::Section(section) => {
                self.all(scope, &section.length);
                self.point(scope, &section.from);
                self.point(scope, &section.to);
                section.on.iter().for_each(|on| self.section(scope, on));
            }
            Statement::Route { sections, .. } => {
                sections.iter().for_each(|name| self.part(scope, Part::Section, name));
            }
            Statement::DrawingField { .. } | Statement::Bad => {}
        }
    }

    fn equipped(&mut self, scope: &Scope, equipped: &EquippedExpr) {
        self.reference(scope, Space::Component(DeclarationKind::Equipment), Some(&equipped.of));
        match &equipped.place {
            EquippedPlace::At(place) => {
                self.section(scope, &place.section);
                self.expression(scope, &place.at);
            }
            EquippedPlace::Row(row) => self.row(scope, row),
            EquippedPlace::Free { least, on, after, before, .. } => {
                self.all(scope, least);
                on.iter().for_each(|section| self.section(scope, section));
                after.names().iter().chain(before).for_each(|name| self.along(scope, name));
            }
        }
        equipped.fed.iter().for_each(|point| self.point(scope, point));
    }

    /// A name of something that stands along the track.
    fn along(&mut self, scope: &Scope, name: &Name) {
        let parts = [Part::Induction, Part::Chutes, Part::Station];
        if let Some(part) = parts.into_iter().find(|part| scope.part(*part, &name.text).is_some()) {
            self.part(scope, part, name);
        }
    }

    fn effect(&mut self, scope: &Scope, reference: &Reference) {
        let effect = EFFECTS.iter().find(|effect| effect.name == reference.name.text);
        if effect.is_some() {
            self.known(reference.name.span, NameKind::Effect);
        }
        for arg in reference.args.iter().flat_map(|args| args.iter()) {
            if let (Some(effect), Some(name)) = (effect, &arg.name) {
                self.known(name.span, NameKind::EffectArgument(effect.name.to_owned()));
            }
            self.expression(scope, &arg.value);
        }
    }

    fn expression(&mut self, scope: &Scope, expr: &Expr) {
        match &expr.kind {
            ExprKind::Number { .. } | ExprKind::Text(_) => {}
            ExprKind::Name(name) => match scope.value(name) {
                Some((kind, definition)) => self.used(own(name, expr.span), kind, definition),
                None => {
                    self.item(scope.module, Space::Let, name, own(name, expr.span));
                }
            },
            ExprKind::Call { name, args } => self.call(scope, name, args),
            ExprKind::Negative(inner) | ExprKind::Paren(inner) => self.expression(scope, inner),
            ExprKind::Sum { first, rest } => {
                self.expression(scope, first);
                self.all(scope, rest.iter().map(|(_, expr)| expr));
            }
            ExprKind::Product { first, rest } => {
                self.expression(scope, first);
                self.all(scope, rest.iter().map(|(_, expr)| expr));
            }
            ExprKind::List(block) => self.all(scope, block.iter()),
            ExprKind::Tuple(items) => self.all(scope, items),
            ExprKind::Range { low, high, step } => {
                self.all(scope, [&**low, &**high]);
                self.all(scope, step.as_deref());
            }
        }
    }

    fn call(&mut self, scope: &Scope, name: &Name, args: &Block<Arg>) {
        let Some(geometric) = functions::all().find(|f| f.name == name.text).map(|f| f.geometric) else { return };
        self.known(name.span, NameKind::Function);
        for (number, arg) in args.iter().enumerate() {
            match geometric {
                // As a value is worked out: what a distance leads to is an obstacle first.
                true => self.geometry(scope, &arg.value, name.text == "distance" && number == 1),
                false => self.expression(scope, &arg.value),
            }
        }
    }

    /// What a function of the geometry asks of: vertices, sections, `straight(...)`, an obstacle or the walls.
    fn geometry(&mut self, scope: &Scope, expr: &Expr, obstacle_first: bool) {
        match &expr.kind {
            ExprKind::Name(text) => {
                let name = Name { text: text.clone(), span: own(text, expr.span) };
                let parts = if obstacle_first { vec![Part::Obstacle, Part::Vertex] } else { vec![Part::Vertex] };
                match parts.into_iter().find(|part| scope.part(*part, text).is_some()) {
                    Some(part) => self.part(scope, part, &name),
                    None if text == "building" => self.known(name.span, NameKind::Building),
                    None => {}
                }
            }
            ExprKind::Range { low, high, .. } => {
                self.geometry(scope, low, false);
                self.geometry(scope, high, false);
            }
            ExprKind::Call { name, args } if name.text == "straight" => {
                self.known(name.span, NameKind::Function);
                args.iter().for_each(|arg| self.geometry(scope, &arg.value, false));
            }
            ExprKind::Paren(inner) => self.geometry(scope, inner, obstacle_first),
            _ => {}
        }
    }
}
