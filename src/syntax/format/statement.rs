//! Statements of a layout as text.

use super::Writer;
use crate::source::Span;
use crate::syntax::tree::*;

impl Writer<'_> {
    pub fn statement(&mut self, statement: &Statement, span: Span) {
        match statement {
            Statement::Let(line) => self.let_line(line),
            Statement::Component { kind, reference } => {
                self.push(kind.word());
                self.push(" ");
                self.reference(reference);
            }
            Statement::Speed(value) => self.word_value("speed ", value),
            Statement::Width(value) => self.word_value("width ", value),
            Statement::Vertex { name, point, radius } => {
                self.words(&["vertex ", &name.text, " "]);
                self.point(point);
                self.clause(" radius ", radius);
            }
            Statement::Building { polygon, clearance } => {
                self.push("building ");
                self.polygon(polygon);
                self.clause(" clearance ", clearance);
            }
            Statement::Obstacle { name, polygon, clearance } => {
                self.words(&["obstacle ", &name.text, " "]);
                self.polygon(polygon);
                self.clause(" clearance ", clearance);
            }
            Statement::Turns { low, high } => {
                self.word_value("turns ", low);
                self.word_value(" .. ", high);
            }
            Statement::Radii { low, high } => {
                self.word_value("radii ", low);
                self.word_value(" .. ", high);
            }
            Statement::FixSection { kinds, target } => {
                self.push("fix ");
                for (index, (kind, _)) in kinds.iter().enumerate() {
                    self.words(&[if index > 0 { ", " } else { "" }, kind.word()]);
                }
                self.push(if target.straight { " straight(" } else { " " });
                self.section(&target.section);
                self.push(if target.straight { ")" } else { "" });
            }
            Statement::FixVertex { vertex } => self.words(&["fix ", &vertex.text]),
            Statement::FixRadius { vertex } => self.words(&["fix radius ", &vertex.text]),
            Statement::Require { first, rest, reason } => {
                self.word_value("require ", first);
                for (relation, _, value) in rest {
                    self.words(&[" ", relation.sign(), " "]);
                    self.expr(value);
                }
                if let Some(reason) = reason {
                    self.push(" ");
                    self.text(reason);
                }
            }
            Statement::Equal { values } => {
                for (index, value) in values.iter().enumerate() {
                    self.word_value(if index > 0 { ", " } else { "equal " }, value);
                }
            }
            Statement::Mirror { first, second, axis, at } => {
                self.words(&["mirror ", &first.text, ", ", &second.text, " about ", axis.word(), " = "]);
                self.expr(at);
            }
            Statement::Pass { obstacle, side } => self.words(&["pass ", &obstacle.text, " ", side.word()]),
            Statement::Level { from, to, height } => {
                self.words(&["level ", &from.text, "..", &to.text, " "]);
                self.expr(height);
            }
            Statement::Ramp { section, from, slope, radius } => {
                self.push("ramp ");
                self.section(section);
                self.clause(" from ", from);
                self.clause(" slope ", slope);
                self.clause(" radius ", radius);
            }
            Statement::Start(place) => {
                self.push("start");
                self.place(place);
            }
            Statement::Photocell(place) => {
                self.push("photocell");
                self.place(place);
            }
            Statement::Induction { name, place } => {
                self.words(&["induction ", &name.text]);
                self.place(place);
            }
            Statement::Chutes { name, row } => {
                self.words(&["chutes ", &name.text]);
                self.row(row);
            }
            Statement::Scanner(place) => {
                self.push("scanner");
                self.place(place);
            }
            Statement::Equipped(equipped) => self.equipped(equipped),
            Statement::Feed { induction, rate, most, efficiency, shares } => {
                self.words(&["feed ", &induction.text]);
                self.per_hour(" ", rate);
                self.per_hour(" up to ", most);
                self.clause(" efficiency ", efficiency);
                self.row_shares(shares);
            }
            Statement::Storage { chutes, count, every } => {
                self.words(&["storage ", &chutes.text]);
                self.word_value(" ", count);
                self.clause(" every ", every);
            }
            Statement::Items { laps, double, unread } => {
                self.push("items");
                self.clause(" laps ", laps);
                self.clause(" double ", double);
                self.clause(" unread ", unread);
            }
            Statement::Stops { every, duration } => {
                self.word_value("stops every ", every);
                self.word_value(" for ", duration);
            }
            Statement::Fails { equipment, every, duration } => {
                self.words(&["fails ", &equipment.text]);
                self.word_value(" every ", every);
                self.word_value(" for ", duration);
            }
            Statement::Waves { every, changeover, spread } => {
                self.word_value("waves every ", every);
                self.clause(" changeover ", changeover);
                self.clause(" spread ", spread);
            }
            Statement::Wave { name, shares } => {
                self.words(&["wave ", &name.text]);
                self.row_shares(shares);
            }
            Statement::RequireCapacity { least, reason } => {
                self.word_value("require capacity >= ", least);
                self.push(" per hour");
                if let Some(reason) = reason {
                    self.push(" ");
                    self.text(reason);
                }
            }
            Statement::ChooseCart { carts, lengths } => {
                self.references("choose cart ", carts);
                if let Some((low, high)) = lengths {
                    self.word_value(" lengths ", low);
                    self.word_value(" .. ", high);
                }
            }
            Statement::ChooseMotor { motors, on_straights } => {
                self.references("choose motor ", motors);
                self.push(if *on_straights { " on straights" } else { "" });
            }
            Statement::ChooseComponent { kind, components } => {
                self.references(&format!("choose {} ", kind.word()), components);
            }
            Statement::ChooseSpeed(values) => self.word_value("choose speed ", values),
            Statement::ChooseRadii(values) => self.word_value("choose radii ", values),
            Statement::ChooseCount { equipment, counts } => {
                self.names("choose count ", equipment);
                self.word_value(" ", counts);
            }
            Statement::Drive { load, starts, stops, spare } => {
                self.push("drive");
                self.clause(" load ", load);
                self.clause(" starts within ", starts);
                self.clause(" stops within ", stops);
                self.clause(" spare ", spare);
            }
            Statement::Energy { price, hours, years } => {
                self.word_value("energy ", price);
                self.word_value(" for ", hours);
                self.word_value(" per year over ", years);
                self.push(" years");
            }
            Statement::MotorsEvenly { count } => {
                self.word_value("motors ", count);
                self.push(" evenly");
            }
            Statement::MotorsRow(row) => {
                self.push("motors");
                self.row(row);
            }
            Statement::Supports { every } => self.word_value("supports every ", every),
            Statement::SensorCart { cart } => self.word_value("sensor_cart at cart ", cart),
            Statement::ChainTension(force) => self.word_value("chain tension ", force),
            Statement::ChainCloses(gap) => self.word_value("chain closes within ", gap),
            Statement::Effect(reference) => {
                self.push("effect ");
                self.reference(reference);
            }
            Statement::GridAxis { name, axis, at, row } => {
                self.push("axis ");
                self.text(&name.text);
                self.words(&[" ", axis.word(), " = "]);
                self.expr(at);
                if let Some((every, count)) = row {
                    self.word_value(" every ", every);
                    self.word_value(" count ", count);
                }
            }
            Statement::DrawingOrigin(point) => {
                self.push("drawing origin ");
                self.point(point);
            }
            Statement::DrawingField { field, text } => {
                self.words(&["drawing ", field.word(), " "]);
                self.text(&text.text);
            }
            Statement::Optimise(objective) => self.objective(objective),
            Statement::Section(section) => {
                let PlacedSection { name, length, from, to, either_way, on } = &**section;
                self.words(&["section ", &name.text, " "]);
                if let Some(length) = length {
                    self.expr(length);
                    self.push(" within ");
                }
                self.point(from);
                self.push("..");
                self.point(to);
                self.push(if *either_way { " either way" } else { "" });
                if let Some(on) = on {
                    self.push(" on ");
                    self.section(on);
                }
            }
            Statement::Route { sections, any_order } => {
                for (index, name) in sections.iter().enumerate() {
                    self.words(&[if index > 0 { ", " } else { "route " }, &name.text]);
                }
                self.push(if *any_order { " in any order" } else { "" });
            }
            Statement::Bad => self.verbatim(span),
        }
    }

    fn references(&mut self, word: &str, references: &[Reference]) {
        for (index, reference) in references.iter().enumerate() {
            self.push(if index > 0 { ", " } else { word });
            self.reference(reference);
        }
    }

    fn equipped(&mut self, equipped: &EquippedExpr) {
        let EquippedExpr { word, name, of, place, fed } = equipped;
        self.words(&[word.word(), " ", &name.text, " of "]);
        self.reference(of);
        match place {
            EquippedPlace::At(place) => self.place(place),
            EquippedPlace::Row(row) => self.row(row),
            EquippedPlace::Free { least, on, straights, after, before } => {
                self.clause(" at least ", least);
                if on.is_empty() {
                    self.push(if *straights { " on straights" } else { " anywhere" });
                }
                for (index, section) in on.iter().enumerate() {
                    self.push(if index > 0 { ", " } else { " on " });
                    self.section(section);
                }
                match after {
                    After::Names(names) => self.names(" after ", names),
                    After::EachZone(_) => self.push(" after the last induction of each zone"),
                }
                self.names(" before ", before);
            }
        }
        if let Some(point) = fed {
            self.push(" fed from ");
            self.point(point);
        }
    }

    fn names(&mut self, clause: &str, names: &[Name]) {
        for (index, name) in names.iter().enumerate() {
            self.words(&[if index > 0 { ", " } else { clause }, &name.text]);
        }
    }

    fn words(&mut self, words: &[&str]) {
        for word in words {
            self.push(word);
        }
    }

    fn word_value(&mut self, word: &str, value: &Expr) {
        self.push(word);
        self.expr(value);
    }

    fn clause(&mut self, word: &str, value: &Option<Expr>) {
        if let Some(value) = value {
            self.word_value(word, value);
        }
    }

    /// Rows of chutes with their shares, if there are any.
    fn row_shares(&mut self, shares: &[(Name, Expr)]) {
        for (index, (row, share)) in shares.iter().enumerate() {
            self.words(&[if index > 0 { ", " } else { " to " }, &row.text, " "]);
            self.expr(share);
        }
    }

    fn per_hour(&mut self, word: &str, value: &Option<Expr>) {
        if let Some(value) = value {
            self.word_value(word, value);
            self.push(" per hour");
        }
    }

    fn point(&mut self, point: &PointExpr) {
        self.word_value("(", &point.x);
        self.word_value(", ", &point.y);
        self.push(")");
    }

    fn polygon(&mut self, polygon: &Block<PointExpr>) {
        self.list("[", polygon, "]", false, |writer, point, _| writer.point(point));
    }

    fn section(&mut self, section: &Section) {
        self.words(&[&section.from.text, "..", &section.to.text]);
    }

    fn place(&mut self, place: &PlaceExpr) {
        self.push(" on ");
        self.section(&place.section);
        self.word_value(" at ", &place.at);
    }

    fn row(&mut self, row: &RowExpr) {
        self.push(" on ");
        self.section(&row.section);
        self.word_value(" from ", &row.from);
        self.word_value(" every ", &row.every);
        self.word_value(" count ", &row.count);
    }

    fn objective(&mut self, objective: &ObjectiveExpr) {
        self.push("optimise ");
        for (index, (weight, goal, _)) in objective.terms.iter().enumerate() {
            self.push(if index > 0 { " + " } else { "" });
            if let Some(weight) = weight {
                self.expr(weight);
                self.push(" * ");
            }
            self.push(goal.word());
        }
        if let Some((goal, slack)) = &objective.within {
            self.words(&[" within ", goal.word(), " + "]);
            self.expr(slack);
        }
    }
}
