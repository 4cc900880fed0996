//! `study.toml`: its sweeps, read with the place of everything that stands in it.

use super::MOST_TASKS;
use super::axis::{Axis, AxisValue, count, spread, stepped, with_unit};
use super::verb::{OptionKind, Verb, Works};
use crate::base::number::shortest;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::{FileId, Span};
use crate::syntax::nearest;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// What is read of a `study.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyFile {
    /// For the page's title.
    pub name: Option<String>,
    pub sweeps: Vec<Sweep>,
}

/// Tasks that differ in their parameters alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    pub name: String,
    pub span: Span,
    /// What is done for each task, in turn.
    pub steps: Vec<Verb>,
    /// Whether the steps' outputs are kept beside the result.
    pub keep: bool,
    /// In the file's order, with the parameters that have one value.
    pub axes: Vec<Axis>,
    /// Axes that go together, by their numbers; every axis is in one.
    pub groups: Vec<Vec<usize>>,
}

const KEYS: [&str; 2] = ["name", "sweep"];
const SWEEP_KEYS: [&str; 11] =
    ["name", "steps", "file", "zip", "keep", "let", "build", "simulate", "identify", "diagnose", "challenge"];
const RANGE_KEYS: [&str; 5] = ["from", "to", "step", "count", "unit"];
const RANGE: &str = "{ from = 1, to = 3, step = 0.5, unit = \"m/s\" }, or count in the place of step";

/// Reads the text of a `study.toml`; what is wrong with it is returned with it, all of it.
pub fn read(file: FileId, text: &str) -> (StudyFile, Vec<Diagnostic>) {
    let mut reader = Reader { file, said: Vec::new() };
    let study = match DeTable::parse(text) {
        Ok(table) => reader.study(table.get_ref()),
        Err(why) => {
            let at = why.span().unwrap_or(0..0);
            let span = Span::new(file, at.start.min(text.len()), at.end.min(text.len()));
            let message = format!("the study is not TOML: {}", why.message().lines().next().unwrap_or_default());
            reader.said.push(
                Diagnostic::new(Code::E0901, message, span, "here")
                    .help("docs/study.md shows a study to begin with; strings stand in quotes: \"1.5 m/s\""),
            );
            StudyFile { name: None, sweeps: Vec::new() }
        }
    };
    (study, reader.said)
}

const NOT_KNOWN: &str = "not known";

type Value<'a> = Spanned<DeValue<'a>>;
type Entry<'a, 'b> = (&'b str, Span, &'b Value<'a>);

struct Reader {
    file: FileId,
    said: Vec<Diagnostic>,
}

impl Reader {
    fn span<T>(&self, of: &Spanned<T>) -> Span {
        Span::new(self.file, of.span().start, of.span().end)
    }

    fn wrong(&mut self, span: Span, message: impl Into<String>, expected: &str, found: impl Into<String>) {
        let diagnostic = Diagnostic::new(Code::E0903, message, span, "not that");
        self.said.push(diagnostic.expected(expected, found));
    }

    fn unknown(&mut self, span: Span, key: &str, message: String, known: &[&str]) {
        let listed: Vec<String> = known.iter().map(|k| format!("`{k}`")).collect();
        let mut diagnostic =
            Diagnostic::new(Code::E0902, message, span, NOT_KNOWN).expected(listed.join(", "), format!("`{key}`"));
        if let Some(near) = nearest(key, known.iter().copied()) {
            diagnostic = diagnostic.fix(span, near);
        }
        self.said.push(diagnostic);
    }

    /// The entries of a table in the file's order.
    fn entries<'a, 'b>(&self, table: &'b DeTable<'a>) -> Vec<Entry<'a, 'b>> {
        let mut all: Vec<Entry> = table.iter().map(|(k, v)| (k.get_ref().as_ref(), self.span(k), v)).collect();
        all.sort_by_key(|(_, span, _)| span.start);
        all
    }

    fn study(&mut self, table: &DeTable) -> StudyFile {
        let mut study = StudyFile { name: None, sweeps: Vec::new() };
        let mut begun = false;
        for (key, span, value) in self.entries(table) {
            match key {
                "name" => study.name = self.text(value, "a title in quotes"),
                "sweep" => {
                    begun = true;
                    match value.get_ref().as_array() {
                        Some(sweeps) if sweeps.iter().all(|s| s.get_ref().is_table()) => {
                            for (number, sweep) in sweeps.iter().enumerate() {
                                let span = Span::new(self.file, sweep.span().start, sweep.span().start + 1);
                                let table = sweep.get_ref().as_table();
                                let read = table.and_then(|table| self.sweep(number, span, table));
                                study.sweeps.extend(read);
                            }
                        }
                        _ => self.wrong(
                            span,
                            "`sweep` is no list of tables",
                            "tables, each headed by [[sweep]]",
                            kind(value),
                        ),
                    }
                }
                _ => self.unknown(span, key, format!("a study has no `{key}`"), &KEYS),
            }
        }
        if study.sweeps.is_empty() && self.said.is_empty() {
            let span = Span::new(self.file, 0, 0);
            let message = if begun { "the list of sweeps is empty" } else { "the study has no sweeps" };
            self.said.push(
                Diagnostic::new(Code::E0906, message, span, "nothing to do").help("add [[sweep]] with steps and file"),
            );
        }
        self.names(&study);
        self.size(&study);
        study
    }

    fn names(&mut self, study: &StudyFile) {
        for (k, sweep) in study.sweeps.iter().enumerate() {
            if let Some(first) = study.sweeps[..k].iter().find(|other| other.name == sweep.name) {
                let message = format!("two sweeps are called `{}`", sweep.name);
                self.said.push(
                    Diagnostic::new(Code::E0903, message, sweep.span, "the second")
                        .related(first.span, "the first")
                        .help("the table of results tells sweeps by their names: give one of them another"),
                );
            }
        }
    }

    fn size(&mut self, study: &StudyFile) {
        let counts: Vec<Option<usize>> = study.sweeps.iter().map(|s| count(&s.axes, &s.groups)).collect();
        let all = counts.iter().try_fold(0_usize, |all, count| all.checked_add((*count)?));
        if all.is_some_and(|all| all <= MOST_TASKS) {
            return;
        }
        let largest = (0..counts.len()).max_by_key(|k| counts[*k].unwrap_or(usize::MAX)).unwrap_or(0);
        let Some(sweep) = study.sweeps.get(largest) else { return };
        let most = sweep.axes.iter().max_by_key(|axis| axis.values.len());
        let factors: Vec<String> = sweep
            .axes
            .iter()
            .filter(|axis| axis.values.len() > 1)
            .map(|axis| format!("{} of {}", axis.values.len(), axis.key))
            .collect();
        let amount = all.map_or_else(|| "more than can be counted".to_owned(), |all| all.to_string());
        self.said.push(
            Diagnostic::new(
                Code::E0906,
                "the study has too many tasks",
                most.map_or(sweep.span, |axis| axis.span),
                format!("sweep `{}` multiplies {}", sweep.name, factors.join(", ")),
            )
            .expected(format!("at most {MOST_TASKS} tasks"), amount)
            .help("take larger steps, split the study, or let parameters go together with zip"),
        );
    }

    fn sweep(&mut self, number: usize, span: Span, table: &DeTable) -> Option<Sweep> {
        let before = self.said.len();
        let mut sweep = Sweep {
            name: format!("sweep {}", number + 1),
            span,
            steps: Vec::new(),
            keep: true,
            axes: Vec::new(),
            groups: Vec::new(),
        };
        let entries = self.entries(table);
        match entries.iter().find(|(key, ..)| *key == "steps") {
            Some((_, span, value)) => sweep.steps = self.steps(*span, value),
            None => {
                let diagnostic = Diagnostic::new(Code::E0903, "the sweep says no steps", span, "here");
                self.said.push(
                    diagnostic.help("add steps = [\"simulate\"]: build, simulate, identify, diagnose, challenge"),
                );
            }
        }
        let mut zip = None;
        for (key, span, value) in entries {
            match key {
                "steps" => {}
                "name" => sweep.name = self.text(value, "a name in quotes").unwrap_or_default(),
                "keep" => match value.get_ref().as_bool() {
                    Some(keep) => sweep.keep = keep,
                    None => self.wrong(span, "`keep` says whether outputs are kept", "true or false", kind(value)),
                },
                "zip" => zip = Some((span, value)),
                "file" => self.axis("file", span, value, &mut sweep.axes),
                "let" => self.table("let", span, value, &mut sweep.axes),
                _ => match Verb::find(key) {
                    Some(verb) => self.options(verb, span, value, &mut sweep),
                    None => self.unknown(span, key, format!("a sweep has no `{key}`"), &SWEEP_KEYS),
                },
            }
        }
        self.file_is_there(&sweep);
        match zip {
            Some((span, value)) => self.zip(span, value, &mut sweep),
            None => sweep.groups = (0..sweep.axes.len()).map(|k| vec![k]).collect(),
        }
        (self.said.len() == before).then_some(sweep)
    }

    /// A text that says something.
    fn text(&mut self, value: &Value, expected: &str) -> Option<String> {
        let span = self.span(value);
        match value.get_ref().as_str().filter(|text| !text.is_empty() && !text.contains(char::is_control)) {
            Some(text) => Some(text.to_owned()),
            None => {
                self.wrong(span, "this is no name", expected, kind(value));
                None
            }
        }
    }

    fn steps(&mut self, span: Span, value: &Value) -> Vec<Verb> {
        const EXPECTED: &str = "a list such as [\"build\", \"simulate\"]";
        let list: Vec<&Value> = match value.get_ref() {
            DeValue::String(_) => vec![value],
            DeValue::Array(list) => list.iter().collect(),
            _ => Vec::new(),
        };
        let mut steps = Vec::new();
        for step in &list {
            let Some(name) = step.get_ref().as_str() else {
                self.wrong(self.span(step), "a step is a verb", EXPECTED, kind(step));
                continue;
            };
            match Verb::find(name) {
                Some(verb) if steps.contains(&verb) => {
                    let message = format!("`{name}` comes twice");
                    self.wrong(self.span(step), message, "each step once", format!("`{name}` again"));
                }
                Some(verb) => steps.push(verb),
                None => {
                    let known: Vec<&str> = Verb::ALL.into_iter().map(Verb::name).collect();
                    // Within the quotes, which a fix keeps.
                    let quoted = self.span(step);
                    let span = Span { start: quoted.start + 1, end: quoted.end.saturating_sub(1), ..quoted };
                    self.unknown(span, name, format!("there is no step `{name}`"), &known);
                }
            }
        }
        if list.is_empty() {
            self.wrong(span, "a sweep needs steps", EXPECTED, kind(value));
        }
        // What a later step makes cannot be what an earlier one takes.
        for (k, verb) in steps.iter().enumerate() {
            let late = verb.takes_from().is_some_and(|(from, _)| steps[k..].contains(&from));
            if late {
                let message = format!("`{}` comes before what it takes", verb.name());
                self.wrong(span, message, "steps in the order build, simulate, identify", "another order");
            }
        }
        steps
    }

    /// That the sweep has one kind of file, and that there is one.
    fn file_is_there(&mut self, sweep: &Sweep) {
        let takes = |verb: &Verb| verb.takes_from().is_none_or(|(from, _)| !sweep.steps.contains(&from));
        let needs: Vec<Verb> = sweep.steps.iter().copied().filter(takes).collect();
        let kinds = [Works::OnTrack, Works::OnRuns].map(|works| needs.iter().find(|v| v.works() == works));
        if let [Some(track), Some(runs)] = kinds {
            let message = format!("`{}` takes a layout and `{}` takes runs", track.name(), runs.name());
            self.said.push(
                Diagnostic::new(Code::E0903, message, sweep.span, "of one file they cannot both")
                    .help("put simulate before it, which makes runs, or make two sweeps"),
            );
        }
        let has = sweep.axes.iter().any(|axis| axis.key == "file");
        if !has && needs.iter().any(|verb| *verb != Verb::Challenge) {
            let message = format!("the sweep says no file for `{}`", needs[0].name());
            self.said.push(Diagnostic::new(Code::E0903, message, sweep.span, "here").help(match needs[0].works() {
                Works::OnTrack => "add file = \"plant.lss\", or a list of layouts",
                Works::OnRuns => "add file = \"campaign\", the folder of measured runs, or a list of them",
            }));
        }
    }

    fn options(&mut self, verb: Verb, span: Span, value: &Value, sweep: &mut Sweep) {
        // Where a step is mistyped it may be this one.
        if !sweep.steps.is_empty()
            && !sweep.steps.contains(&verb)
            && !self.said.iter().any(|d| d.label.text == NOT_KNOWN)
        {
            let message = format!("`{}` is no step of this sweep", verb.name());
            let names: Vec<&str> = sweep.steps.iter().map(|v| v.name()).collect();
            self.wrong(
                span,
                message,
                &format!("options of its steps: {}", names.join(", ")),
                format!("`{}`", verb.name()),
            );
            return;
        }
        let Some(table) = value.get_ref().as_table() else {
            let expected = format!("a table: [sweep.{}]", verb.name());
            self.wrong(span, format!("options of `{}` stand in a table", verb.name()), &expected, kind(value));
            return;
        };
        for (key, span, value) in self.entries(table) {
            let name = format!("{}.{key}", verb.name());
            match verb.option(key).map(|option| option.kind) {
                Some(OptionKind::Table) => self.table(&name, span, value, &mut sweep.axes),
                Some(_) => self.axis(&name, span, value, &mut sweep.axes),
                None => {
                    let known: Vec<&str> = verb.options().iter().map(|option| option.key).collect();
                    self.unknown(span, key, format!("`{}` has no option `{key}` in a study", verb.name()), &known);
                }
            }
        }
    }

    /// Parameters in a table, each with its values; tables within it are names with dots.
    fn table(&mut self, name: &str, span: Span, value: &Value, axes: &mut Vec<Axis>) {
        let Some(table) = value.get_ref().as_table() else {
            let message = format!("`{name}` is a table of names and values");
            self.wrong(span, message, &format!("[sweep.{name}] with NAME = VALUE"), kind(value));
            return;
        };
        for (key, span, value) in self.entries(table) {
            let name = format!("{name}.{key}");
            match value.get_ref().as_table() {
                Some(inner) if !inner.contains_key("from") => self.table(&name, span, value, axes),
                _ => self.axis(&name, span, value, axes),
            }
        }
    }

    /// A parameter: one value, a list, or a range.
    fn axis(&mut self, key: &str, span: Span, value: &Value, axes: &mut Vec<Axis>) {
        if let Some(first) = axes.iter().find(|axis| axis.key == key) {
            let diagnostic = Diagnostic::new(Code::E0903, format!("`{key}` is given twice"), span, "again");
            self.said.push(diagnostic.related(first.span, "first").help("put all its values into one list"));
            return;
        }
        let values = match value.get_ref() {
            DeValue::Array(list) if list.is_empty() => {
                let message = format!("`{key}` has no values");
                self.said.push(
                    Diagnostic::new(Code::E0906, message, self.span(value), "an empty list makes no task")
                        .help("give it a value, or take the line out"),
                );
                return;
            }
            DeValue::Array(list) => list.iter().filter_map(|value| self.value(value)).collect(),
            DeValue::Table(table) => self.range(self.span(value), table),
            _ => self.value(value).into_iter().collect::<Vec<_>>(),
        };
        axes.push(Axis { key: key.to_owned(), span, values });
    }

    fn value(&mut self, value: &Value) -> Option<AxisValue> {
        let span = self.span(value);
        let text = match value.get_ref() {
            DeValue::String(text) if !text.is_empty() && !text.contains(char::is_control) => Some(text.to_string()),
            DeValue::Boolean(it) => Some(it.to_string()),
            _ => number(value).map(shortest),
        };
        if text.is_none() {
            let expected = "a number, true, false, or a text in quotes such as \"1.5 m/s\"";
            self.wrong(span, "this is no value of a parameter", expected, kind(value));
        }
        text.map(|text| AxisValue { text, span })
    }

    fn range(&mut self, span: Span, table: &DeTable) -> Vec<AxisValue> {
        let mut numbers = [None; 4];
        let mut unit = String::new();
        let before = self.said.len();
        for (key, at, value) in self.entries(table) {
            match RANGE_KEYS.iter().position(|known| *known == key) {
                Some(4) => unit = self.text(value, "a unit in quotes").unwrap_or_default(),
                Some(k) => {
                    numbers[k] = number(value);
                    if numbers[k].is_none() {
                        self.wrong(self.span(value), format!("`{key}` is no number"), RANGE, kind(value));
                    }
                }
                None => self.unknown(at, key, format!("a range has no `{key}`"), &RANGE_KEYS),
            }
        }
        if self.said.len() > before {
            return Vec::new();
        }
        let values = match numbers {
            [Some(from), Some(to), Some(step), None] => stepped(from, to, step, MOST_TASKS),
            [Some(from), Some(to), None, Some(count)] if count.fract() == 0.0 && count >= 1.0 => {
                (count <= MOST_TASKS as f64).then(|| spread(from, to, count as usize))
            }
            _ => {
                self.wrong(span, "the range is not complete", RANGE, "something else");
                return Vec::new();
            }
        };
        let Some(values) = values else {
            self.wrong(
                span,
                "the range does not get to its end",
                "steps towards `to`, at most 100 000 of them",
                "none",
            );
            return Vec::new();
        };
        values.into_iter().map(|x| AxisValue { text: with_unit(x, &unit), span }).collect()
    }

    /// Which parameters go together.
    fn zip(&mut self, span: Span, value: &Value, sweep: &mut Sweep) {
        const EXPECTED: &str = "lists of parameters that go together: zip = [[\"let.aisle\", \"simulate.speed\"]]";
        let mut taken: Vec<Vec<usize>> = Vec::new();
        let lists = value.get_ref().as_array().filter(|lists| lists.iter().all(|list| list.get_ref().is_array()));
        let Some(lists) = lists else {
            self.wrong(span, "`zip` is a list of lists", EXPECTED, kind(value));
            return;
        };
        for list in lists.iter() {
            let mut group: Vec<usize> = Vec::new();
            for name in list.get_ref().as_array().into_iter().flat_map(|list| list.iter()) {
                let at = self.span(name);
                let key = name.get_ref().as_str().unwrap_or_default();
                let Some(k) = sweep.axes.iter().position(|axis| axis.key == key) else {
                    let known: Vec<&str> = sweep.axes.iter().map(|axis| axis.key.as_str()).collect();
                    let inner = Span { start: at.start + 1, end: at.end.saturating_sub(1).max(at.start + 1), ..at };
                    self.unknown(inner, key, format!("the sweep has no parameter `{key}`"), &known);
                    continue;
                };
                if group.contains(&k) || taken.iter().any(|other| other.contains(&k)) {
                    self.wrong(at, format!("`{key}` goes together with two"), "each parameter once", "it again");
                    continue;
                }
                if let Some(first) = group.first()
                    && sweep.axes[*first].values.len() != sweep.axes[k].values.len()
                {
                    let (a, b) = (&sweep.axes[*first], &sweep.axes[k]);
                    let message = format!("`{}` and `{}` cannot go together", a.key, b.key);
                    let found = format!("{} of `{}` and {} of `{}`", a.values.len(), a.key, b.values.len(), b.key);
                    self.said.push(
                        Diagnostic::new(Code::E0903, message, b.span, "of another number")
                            .related(a.span, "of this number")
                            .expected("as many values of each", found),
                    );
                }
                group.push(k);
            }
            taken.push(group);
        }
        for k in 0..sweep.axes.len() {
            if !taken.iter().any(|group| group.contains(&k)) {
                taken.push(vec![k]);
            }
        }
        taken.retain(|group| !group.is_empty());
        taken.iter_mut().for_each(|group| group.sort_unstable());
        taken.sort();
        sweep.groups = taken;
    }
}

/// A finite number.
fn number(value: &Value) -> Option<f64> {
    let value = match value.get_ref() {
        DeValue::Integer(n) => i64::from_str_radix(&n.as_str().replace('_', ""), n.radix()).ok().map(|n| n as f64),
        DeValue::Float(x) => x.as_str().replace('_', "").parse().ok(),
        _ => None,
    };
    value.filter(|x: &f64| x.is_finite())
}

fn kind(value: &Value) -> String {
    match value.get_ref() {
        DeValue::String(_) => "a text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
    .to_owned()
}
