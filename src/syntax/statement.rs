//! pest's pairs to the statements of a layout.

use super::Rule;
use super::build::{Builder, take};
use super::tree::*;
use crate::diagnostic::{Code, Diagnostic};
use pest::iterators::{Pair, Pairs};

impl Builder<'_> {
    pub fn statement(&mut self, pair: Pair<Rule>) -> Option<Statement> {
        let rule = pair.as_rule();
        if rule == Rule::let_line {
            return self.let_line(pair).map(Statement::Let);
        }
        let mut parts = pair.into_inner();
        let parts = &mut parts;
        Some(match rule {
            Rule::component => {
                let word = take(parts, Rule::component_kind)?;
                let kind = DeclarationKind::ALL.into_iter().find(|kind| kind.word() == word.as_str())?;
                Statement::Component { kind, reference: self.reference(take(parts, Rule::reference)?)? }
            }
            Rule::speed => Statement::Speed(self.value(parts)?),
            Rule::width => Statement::Width(self.value(parts)?),
            Rule::turns => Statement::Turns { low: self.value(parts)?, high: self.value(parts)? },
            Rule::radii => Statement::Radii { low: self.value(parts)?, high: self.value(parts)? },
            Rule::vertex => Statement::Vertex {
                name: self.next_name(parts)?,
                point: self.point(take(parts, Rule::point)?)?,
                radius: self.value(parts),
            },
            Rule::building => Statement::Building { polygon: self.polygon(parts)?, clearance: self.value(parts) },
            Rule::obstacle => Statement::Obstacle {
                name: self.next_name(parts)?,
                polygon: self.polygon(parts)?,
                clearance: self.value(parts),
            },
            Rule::fix => self.fix(parts)?,
            Rule::require => self.require(parts)?,
            Rule::equal => {
                let values = std::iter::from_fn(|| self.value(parts)).collect();
                Statement::Equal { values }
            }
            Rule::mirror => Statement::Mirror {
                first: self.next_name(parts)?,
                second: self.next_name(parts)?,
                axis: axis(&take(parts, Rule::axis)?),
                at: self.value(parts)?,
            },
            Rule::pass => Statement::Pass {
                obstacle: self.next_name(parts)?,
                side: {
                    let word = take(parts, Rule::side)?;
                    SideWord::ALL.into_iter().find(|side| side.word() == word.as_str())?
                },
            },
            Rule::level => {
                let Section { from, to, .. } = self.section(parts)?;
                Statement::Level { from, to, height: self.value(parts)? }
            }
            Rule::ramp => self.ramp(parts)?,
            Rule::start => Statement::Start(self.place(parts)?),
            Rule::photocell => Statement::Photocell(self.place(parts)?),
            Rule::induction => Statement::Induction { name: self.next_name(parts)?, place: self.place(parts)? },
            Rule::chutes => Statement::Chutes { name: self.next_name(parts)?, row: self.row(take(parts, Rule::row)?)? },
            Rule::scanner => Statement::Scanner(self.place(parts)?),
            Rule::station_of | Rule::chutes_of => self.equipped(rule, parts)?,
            Rule::feed => {
                let induction = self.next_name(parts)?;
                let shares = take(&mut parts.clone(), Rule::row_shares);
                let shares = shares.map_or(Some(Vec::new()), |shares| self.row_shares(shares))?;
                let [rate, most, efficiency] =
                    self.clauses(parts, [Rule::feed_rate, Rule::feed_most, Rule::feed_efficiency])?;
                Statement::Feed { induction, rate, most, efficiency, shares }
            }
            Rule::storage => Statement::Storage {
                chutes: self.next_name(parts)?,
                count: self.value(parts)?,
                every: {
                    let [every] = self.clauses(parts, [Rule::storage_every])?;
                    every
                },
            },
            Rule::items => {
                let [laps, double, unread] =
                    self.clauses(parts, [Rule::items_laps, Rule::items_double, Rule::items_unread])?;
                Statement::Items { laps, double, unread }
            }
            Rule::stops => Statement::Stops { every: self.value(parts)?, duration: self.value(parts)? },
            Rule::fails => Statement::Fails {
                equipment: self.next_name(parts)?,
                every: self.value(parts)?,
                duration: self.value(parts)?,
            },
            Rule::waves => {
                let every = self.value(parts)?;
                let [changeover, spread] = self.clauses(parts, [Rule::waves_changeover, Rule::waves_spread])?;
                Statement::Waves { every, changeover, spread }
            }
            Rule::wave => {
                let name = self.next_name(parts)?;
                Statement::Wave { name, shares: self.row_shares(take(parts, Rule::row_shares)?)? }
            }
            Rule::require_capacity => Statement::RequireCapacity {
                least: self.value(parts)?,
                reason: take(parts, Rule::text).map(|text| self.unescape(&text)),
            },
            Rule::choose => {
                let what = |part: &Pair<Rule>| {
                    use Rule::{
                        choose_cart, choose_count, choose_motor, choose_radii, choose_sensor, choose_speed,
                        choose_take_up,
                    };
                    let rule = part.as_rule();
                    matches!(rule, choose_cart | choose_motor | choose_sensor | choose_take_up)
                        || matches!(rule, choose_speed | choose_radii | choose_count)
                };
                self.choose(parts.find(what)?)?
            }
            Rule::drive => {
                let rules = [Rule::drive_load, Rule::drive_starts, Rule::drive_stops, Rule::drive_spare];
                let [load, starts, stops, spare] = self.clauses(parts, rules)?;
                Statement::Drive { load, starts, stops, spare }
            }
            Rule::energy => {
                Statement::Energy { price: self.value(parts)?, hours: self.value(parts)?, years: self.value(parts)? }
            }
            Rule::motors => match parts.find(|part| matches!(part.as_rule(), Rule::row | Rule::value))? {
                row if row.as_rule() == Rule::row => Statement::MotorsRow(self.row(row)?),
                count => Statement::MotorsEvenly { count: self.expression(count)? },
            },
            Rule::supports => Statement::Supports { every: self.value(parts)? },
            Rule::sensor_cart => Statement::SensorCart { cart: self.value(parts)? },
            Rule::chain => {
                let what = parts.find(|part| matches!(part.as_rule(), Rule::chain_tension | Rule::chain_closes))?;
                let rule = what.as_rule();
                let value = self.value(&mut what.into_inner())?;
                if rule == Rule::chain_tension { Statement::ChainTension(value) } else { Statement::ChainCloses(value) }
            }
            Rule::effect => Statement::Effect(self.reference(take(parts, Rule::reference)?)?),
            Rule::grid_axis => self.grid_axis(parts)?,
            Rule::drawing => {
                let what = parts.find(|part| matches!(part.as_rule(), Rule::drawing_origin | Rule::drawing_field))?;
                let rule = what.as_rule();
                let mut parts = what.into_inner();
                if rule == Rule::drawing_origin {
                    Statement::DrawingOrigin(self.point(take(&mut parts, Rule::point)?)?)
                } else {
                    let word = take(&mut parts, Rule::title_field)?;
                    let field = TitleField::ALL.into_iter().find(|field| field.word() == word.as_str())?;
                    Statement::DrawingField { field, text: self.quoted(&mut parts)? }
                }
            }
            Rule::track_section => self.track_section(parts)?,
            Rule::route => {
                let mut sections = Vec::new();
                let mut any_order = false;
                for part in parts {
                    match part.as_rule() {
                        Rule::name => sections.push(self.name(&part)),
                        Rule::any_order => any_order = true,
                        _ => {}
                    }
                }
                Statement::Route { sections, any_order }
            }
            Rule::optimise => Statement::Optimise(self.objective(take(parts, Rule::objective)?)?),
            _ => return None,
        })
    }

    fn choose(&mut self, pair: Pair<Rule>) -> Option<Statement> {
        let rule = pair.as_rule();
        let mut parts = pair.into_inner();
        if matches!(rule, Rule::choose_speed | Rule::choose_radii) {
            let values = self.expression(take(&mut parts, Rule::expr)?)?;
            let of = if rule == Rule::choose_speed { Statement::ChooseSpeed } else { Statement::ChooseRadii };
            return Some(of(values));
        }
        if rule == Rule::choose_count {
            let names: Vec<Pair<Rule>> = parts.clone().filter(|part| part.as_rule() == Rule::name).collect();
            let equipment = names.iter().map(|name| self.name(name)).collect();
            return Some(Statement::ChooseCount { equipment, counts: self.expression(take(&mut parts, Rule::expr)?)? });
        }
        let (mut references, mut lengths, mut on_straights) = (Vec::new(), None, false);
        for part in parts {
            match part.as_rule() {
                Rule::reference => references.push(self.reference(part)?),
                Rule::choose_lengths => {
                    let mut ends = part.into_inner();
                    lengths = Some((self.value(&mut ends)?, self.value(&mut ends)?));
                }
                Rule::on_straights => on_straights = true,
                _ => {}
            }
        }
        Some(match rule {
            Rule::choose_cart => Statement::ChooseCart { carts: references, lengths },
            Rule::choose_motor => Statement::ChooseMotor { motors: references, on_straights },
            Rule::choose_sensor => Statement::ChooseComponent { kind: DeclarationKind::Sensor, components: references },
            _ => Statement::ChooseComponent { kind: DeclarationKind::TakeUp, components: references },
        })
    }

    fn track_section(&mut self, parts: &mut Pairs<Rule>) -> Option<Statement> {
        let name = self.next_name(parts)?;
        let (mut length, mut limits, mut either_way, mut on) = (None, None, false, None);
        for part in parts {
            match part.as_rule() {
                Rule::value => length = Some(self.expression(part)?),
                Rule::limits => {
                    let mut points = part.into_inner().filter(|p| p.as_rule() == Rule::point);
                    let (from, to) = (points.next()?, points.next()?);
                    limits = Some((self.point(from)?, self.point(to)?));
                }
                Rule::either_way => either_way = true,
                Rule::section => on = Some(self.section_of(part)?),
                _ => {}
            }
        }
        let (from, to) = limits?;
        Some(Statement::Section(Box::new(PlacedSection { name, length, from, to, either_way, on })))
    }

    fn equipped(&mut self, rule: Rule, parts: &mut Pairs<Rule>) -> Option<Statement> {
        let word = match rule {
            Rule::chutes_of => StationWord::Chutes,
            _ => {
                let word = take(parts, Rule::station_word)?;
                StationWord::ALL.into_iter().find(|known| known.word() == word.as_str())?
            }
        };
        let name = self.next_name(parts)?;
        let of = self.reference(take(parts, Rule::of_kind)?.into_inner().find(|p| p.as_rule() == Rule::reference)?)?;
        let (mut place, mut least, mut fed) = (None, None, None);
        for part in parts {
            match part.as_rule() {
                Rule::row => place = Some(EquippedPlace::Row(Box::new(self.row(part)?))),
                Rule::place => place = Some(EquippedPlace::At(self.place_of(part)?)),
                Rule::value => least = Some(self.expression(part)?),
                Rule::where_free => place = Some(self.anywhere(part)?),
                Rule::fed => fed = Some(self.point(take(&mut part.into_inner(), Rule::point)?)?),
                _ => {}
            }
        }
        let mut place = place?;
        if let EquippedPlace::Free { least: of, .. } = &mut place {
            *of = least;
        }
        Some(Statement::Equipped(Box::new(EquippedExpr { word, name, of, place, fed })))
    }

    fn anywhere(&mut self, pair: Pair<Rule>) -> Option<EquippedPlace> {
        let (mut on, mut after, mut before) = (Vec::new(), After::Names(Vec::new()), Vec::new());
        let mut straights = false;
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::section => on.push(self.section_of(part)?),
                Rule::kw_straights => straights = true,
                rule @ (Rule::after | Rule::before) => {
                    let mut parts = part.into_inner();
                    let zone = parts.clone().find(|p| p.as_rule() == Rule::each_zone);
                    let names = parts.by_ref().filter(|p| p.as_rule() == Rule::name).map(|p| self.name(&p)).collect();
                    match (rule, zone) {
                        (Rule::before, _) => before = names,
                        (_, Some(zone)) => after = After::EachZone(self.span_of(&zone)),
                        (_, None) => after = After::Names(names),
                    }
                }
                _ => {}
            }
        }
        Some(EquippedPlace::Free { least: None, on, straights, after, before })
    }

    fn value(&mut self, parts: &mut Pairs<Rule>) -> Option<Expr> {
        take(parts, Rule::value).and_then(|pair| self.expression(pair))
    }

    fn next_name(&mut self, parts: &mut Pairs<Rule>) -> Option<Name> {
        take(parts, Rule::name).map(|pair| self.name(&pair))
    }

    /// Rows of chutes with their shares.
    fn row_shares(&mut self, shares: Pair<Rule>) -> Option<Vec<(Name, Expr)>> {
        let one = |share: Pair<Rule>| {
            let mut of = share.into_inner();
            Some((self.next_name(&mut of)?, self.value(&mut of)?))
        };
        shares.into_inner().filter(|part| part.as_rule() == Rule::row_share).map(one).collect()
    }

    fn quoted(&mut self, parts: &mut Pairs<Rule>) -> Option<TextExpr> {
        take(parts, Rule::text).map(|pair| TextExpr { text: self.unescape(&pair), span: self.span_of(&pair) })
    }

    fn grid_axis(&mut self, parts: &mut Pairs<Rule>) -> Option<Statement> {
        let name = self.quoted(parts)?;
        let axis = axis(&take(parts, Rule::axis)?);
        let at = self.value(parts)?;
        let row = match take(parts, Rule::grid_row) {
            Some(row) => {
                let mut parts = row.into_inner();
                Some((self.value(&mut parts)?, self.value(&mut parts)?))
            }
            None => None,
        };
        Some(Statement::GridAxis { name, axis, at, row })
    }

    fn section(&mut self, parts: &mut Pairs<Rule>) -> Option<Section> {
        self.section_of(take(parts, Rule::section)?)
    }

    fn section_of(&mut self, pair: Pair<Rule>) -> Option<Section> {
        let span = self.span_of(&pair);
        let mut names = pair.into_inner();
        Some(Section { from: self.next_name(&mut names)?, to: self.next_name(&mut names)?, span })
    }

    fn point(&mut self, pair: Pair<Rule>) -> Option<PointExpr> {
        let span = self.span_of(&pair);
        let mut parts = pair.into_inner();
        Some(PointExpr { x: self.value(&mut parts)?, y: self.value(&mut parts)?, span })
    }

    fn polygon(&mut self, parts: &mut Pairs<Rule>) -> Option<Block<PointExpr>> {
        let pair = take(parts, Rule::polygon)?;
        Some(self.block(pair, 1, |builder, pair| match pair.as_rule() {
            Rule::point => builder.point(pair),
            _ => None,
        }))
    }

    fn place(&mut self, parts: &mut Pairs<Rule>) -> Option<PlaceExpr> {
        self.place_of(take(parts, Rule::place)?)
    }

    fn place_of(&mut self, pair: Pair<Rule>) -> Option<PlaceExpr> {
        let mut parts = pair.into_inner();
        Some(PlaceExpr { section: self.section(&mut parts)?, at: self.value(&mut parts)? })
    }

    fn row(&mut self, pair: Pair<Rule>) -> Option<RowExpr> {
        let mut parts = pair.into_inner();
        Some(RowExpr {
            section: self.section(&mut parts)?,
            from: self.value(&mut parts)?,
            every: self.value(&mut parts)?,
            count: self.value(&mut parts)?,
        })
    }

    fn fix(&mut self, parts: &mut Pairs<Rule>) -> Option<Statement> {
        let what =
            parts.find(|part| matches!(part.as_rule(), Rule::fix_radius | Rule::fix_section | Rule::fix_vertex))?;
        let rule = what.as_rule();
        let mut parts = what.into_inner();
        match rule {
            Rule::fix_radius => Some(Statement::FixRadius { vertex: self.next_name(&mut parts)? }),
            Rule::fix_vertex => Some(Statement::FixVertex { vertex: self.next_name(&mut parts)? }),
            _ => {
                let mut kinds = Vec::new();
                for part in parts {
                    match part.as_rule() {
                        Rule::fix_kind => {
                            let kind = FixKind::ALL.into_iter().find(|kind| kind.word() == part.as_str())?;
                            kinds.push((kind, self.span_of(&part)));
                        }
                        Rule::target => return Some(Statement::FixSection { kinds, target: self.target(part)? }),
                        _ => {}
                    }
                }
                None
            }
        }
    }

    fn target(&mut self, pair: Pair<Rule>) -> Option<Target> {
        let span = self.span_of(&pair);
        let what = pair.into_inner().next()?;
        let straight = what.as_rule() == Rule::straight;
        let section = if straight { self.section(&mut what.into_inner())? } else { self.section_of(what)? };
        Some(Target { section, straight, span })
    }

    fn ramp(&mut self, parts: &mut Pairs<Rule>) -> Option<Statement> {
        let section = self.section(parts)?;
        let [from, slope, radius] = self.clauses(parts, [Rule::ramp_from, Rule::ramp_slope, Rule::ramp_radius])?;
        Some(Statement::Ramp { section, from, slope, radius })
    }

    /// The values of clauses that may be left out, each of which has one.
    fn clauses<const N: usize>(&mut self, parts: &mut Pairs<Rule>, rules: [Rule; N]) -> Option<[Option<Expr>; N]> {
        let mut values = [const { None }; N];
        for part in parts {
            if let Some(k) = rules.iter().position(|rule| *rule == part.as_rule()) {
                values[k] = Some(self.value(&mut part.into_inner())?);
            }
        }
        Some(values)
    }

    fn require(&mut self, parts: &mut Pairs<Rule>) -> Option<Statement> {
        let first = self.value(parts)?;
        let mut rest = Vec::new();
        let mut reason = None;
        let mut relation = None;
        for part in parts {
            match part.as_rule() {
                Rule::relation => relation = Some((self.relation(&part), self.span_of(&part))),
                Rule::value => {
                    let (relation, span) = relation.take()?;
                    rest.push((relation, span, self.expression(part)?));
                }
                Rule::text => reason = Some(self.unescape(&part)),
                _ => {}
            }
        }
        Some(Statement::Require { first, rest, reason })
    }

    fn relation(&mut self, pair: &Pair<Rule>) -> Relation {
        let written = pair.as_str();
        let (relation, meant) = match written {
            "<" => (Relation::Less, "<"),
            "<=" | "≤" | "=<" => (Relation::LessEqual, "<="),
            ">=" | "≥" | "=>" => (Relation::GreaterEqual, ">="),
            ">" => (Relation::Greater, ">"),
            _ => (Relation::Equal, "=="),
        };
        if matches!(written, "=" | "=<" | "=>") {
            let span = self.span_of(pair);
            let message = format!("a requirement compares with `{meant}`, not `{written}`");
            self.report.add(
                Diagnostic::new(Code::E0101, message, span, format!("write `{meant}`"))
                    .expected(format!("`{meant}`"), format!("`{written}`"))
                    .fix(span, meant),
            );
        }
        relation
    }

    fn objective(&mut self, pair: Pair<Rule>) -> Option<ObjectiveExpr> {
        let span = self.span_of(&pair);
        let mut terms = Vec::new();
        let mut within = None;
        for part in pair.into_inner() {
            let span = self.span_of(&part);
            match part.as_rule() {
                Rule::goal_term => {
                    let mut weight = None;
                    for part in part.into_inner() {
                        match part.as_rule() {
                            Rule::weight => weight = Some(self.expression(part)?),
                            Rule::goal => terms.push((weight.take(), goal(&part)?, span)),
                            _ => {}
                        }
                    }
                }
                Rule::within => {
                    let mut parts = part.into_inner();
                    let goal = goal(&take(&mut parts, Rule::goal)?)?;
                    within = Some((goal, self.value(&mut parts)?));
                }
                _ => {}
            }
        }
        Some(ObjectiveExpr { terms, within, span })
    }
}

fn axis(pair: &Pair<Rule>) -> Axis {
    if pair.as_str() == "x" { Axis::X } else { Axis::Y }
}

fn goal(pair: &Pair<Rule>) -> Option<Goal> {
    Goal::ALL.into_iter().find(|goal| goal.word() == pair.as_str())
}
