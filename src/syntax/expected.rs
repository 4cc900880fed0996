//! What should have stood where the grammar gave up, in words that a CAD engineer reads, and what may fix it.

use super::Rule;
use super::hints::{hint, meant};
use super::nearest::nearest;
use super::origin::Edit;
use super::token::{first_word, is_bracket, is_foreign, is_letter, last_word, lookalike, token_at};
use super::tree::{DeclarationKind, FixKind, Goal, SideWord, StationWord, TitleField};
use crate::base::words::list;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use pest::error::{Error, ErrorVariant, InputLocation};

/// What a line is read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Context {
    Item,
    Statement,
    Field,
}

impl Context {
    /// The rule that reads one such line and nothing else.
    pub(super) fn entry(self) -> Rule {
        match self {
            Context::Item => Rule::only_item,
            Context::Statement => Rule::only_statement,
            Context::Field => Rule::only_field,
        }
    }

    /// What such a line can be.
    fn phrase(self) -> &'static str {
        match self {
            Context::Item => "`layout`, `use`, `let` or a declaration such as `cart`",
            Context::Statement => "a statement such as `vertex P1 (2 m, 1.5 m)`",
            Context::Field => "a field such as `mass = 52 kg`",
        }
    }
}

/// Where the grammar could not go on, and what it would have taken there.
#[derive(Debug)]
pub struct Failure {
    pub at: usize,
    rules: Vec<Rule>,
}

impl Failure {
    pub fn new(text: &str, error: &Error<Rule>) -> Self {
        let at = match error.location {
            InputLocation::Pos(at) | InputLocation::Span((at, _)) => at.min(text.len()),
        };
        let mut rules = match &error.variant {
            ErrorVariant::ParsingError { positives, .. } => positives.clone(),
            ErrorVariant::CustomError { .. } => Vec::new(),
        };
        rules.retain(|rule| !matches!(rule, Rule::comment | Rule::bad_item | Rule::bad_statement | Rule::bad_field));
        // After a complete value an operator could follow, but hardly anybody forgot one there.
        // Some rules can follow nearly everything: they are named only if nothing else could stand here.
        let after_word = text[..at].trim_end().ends_with(|c: char| is_letter(c) || c.is_ascii_digit());
        keep_if_any(&mut rules, |rule| !(may_follow_anything(rule) || rule == Rule::open_paren && after_word));
        keep_if_any(&mut rules, |rule| rule != Rule::dots);
        Failure { at, rules }
    }

    /// The message, without a fix. `span` leads from positions in `text` to the user's.
    pub fn diagnostic(&self, context: Context, text: &str, span: impl Fn(usize, usize) -> Span) -> Diagnostic {
        let token = token_at(text, self.at);
        let place = span(self.at, self.at + token.len());
        let found = found(token);
        if let Some(c) = token.chars().next().filter(|c| is_foreign(*c)) {
            let problem =
                Diagnostic::new(Code::E0107, format!("unexpected character `{c}`"), place, "not part of the language");
            return match c {
                '“' | '”' | '„' | '\'' => problem.help("texts stand between straight double quotes: \"...\""),
                _ if self.at == 0 => problem.expected(context.phrase(), found),
                _ => problem.expected(self.expected(text), found),
            };
        }
        if self.at == 0 {
            return self.unknown(context, token, place, found);
        }
        let expected = self.expected(text);
        let label = if token.is_empty() { "the line ends here" } else { "not expected here" };
        if first_word(text) == "fix" && token == ".." {
            let kinds = "length, rotation, parallel, perpendicular or all";
            let message = "it is not said what of the section is fixed";
            return Diagnostic::new(Code::E0101, message, place, "a section, so a kind must come before it")
                .expected(kinds, "a section")
                .help(format!("write one of {kinds} between `fix` and the section"));
        }
        let problem = Diagnostic::new(Code::E0101, format!("expected {expected}, found {found}"), place, label)
            .expected(expected, found);
        match hint(text, self.at) {
            Some(hint) => problem.help(hint),
            None => problem,
        }
    }

    /// Whether a statement of a layout stands where only declarations can.
    pub fn is_outside(&self, context: Context, text: &str) -> bool {
        context == Context::Item && self.at == 0 && STATEMENT_WORDS.contains(&first_word(text))
    }

    fn unknown(&self, context: Context, token: &str, place: Span, found: String) -> Diagnostic {
        let what = if context == Context::Item { "declaration" } else { "statement" };
        let whole = context.phrase();
        if self.is_outside(context, token) {
            let message = format!("the statement {found} stands outside of a layout");
            return Diagnostic::new(Code::E0102, message, place, "not inside the braces of a layout")
                .expected(whole, found)
                .help("put it and its like into `layout NAME { ... }`");
        }
        if context == Context::Field || !token.starts_with(is_letter) {
            let message = format!("expected {whole}, found {found}");
            return Diagnostic::new(Code::E0101, message, place, "not expected here").expected(whole, found);
        }
        let problem = Diagnostic::new(Code::E0102, format!("unknown {what} {found}"), place, format!("not a {what}"))
            .expected(whole, found);
        match (context, token) {
            (Context::Statement, "layout" | "use") => {
                problem.help(format!("`{token}` stands outside of a layout's braces"))
            }
            (Context::Statement, "wheel" | "joint") => problem
                .help(format!("a {token} is a part of a cart: name it in a `cart` declaration outside of the layout")),
            (Context::Statement, _) => problem.help(format!("a layout's statements are {}", self.listed_words())),
            _ => problem,
        }
    }

    /// What was expected, as a phrase.
    fn expected(&self, text: &str) -> String {
        let mut phrases: Vec<String> = Vec::new();
        for rule in &self.rules {
            for phrase in phrases_of(*rule, text, self.at) {
                if !phrases.contains(&phrase) {
                    phrases.push(phrase);
                }
            }
        }
        // The end of the line comes last.
        let end = phrases.iter().position(|phrase| phrase == END);
        if let Some(end) = end {
            let end = phrases.remove(end);
            phrases.push(end);
        }
        if phrases.is_empty() { "something else".to_owned() } else { list(&phrases, "or") }
    }

    /// The keywords that could stand here.
    fn words(&self) -> Vec<String> {
        let mut words: Vec<String> = self.rules.iter().flat_map(|rule| words_of(*rule)).collect();
        words.sort_unstable();
        words.dedup();
        words
    }

    fn listed_words(&self) -> String {
        self.words().join(", ")
    }

    /// Edits of `text` that may fix the failure, the likeliest first. They are tried before one is proposed.
    pub fn candidates(&self, context: Context, text: &str) -> Vec<Edit> {
        let token = token_at(text, self.at);
        let before = text[..self.at].trim_end();
        let replace = |with: &str| Edit { at: self.at, removed: token.len(), inserted: with.to_string() };
        let mut edits: Vec<Edit> = decimal_comma(text, self.at).into_iter().collect();
        edits.extend(meant(text, self.at));
        let mut words = self.words();
        if token.starts_with(is_letter)
            && let Some(word) = nearest(token, words.iter().map(String::as_str))
        {
            edits.push(replace(word));
        }
        // Words that were taken for names.
        match first_word(text) {
            "fix" => {
                words.extend(words_of(Rule::fix_kind));
                words.push("radius".to_string());
            }
            "optimise" | "optimize" => words.extend(words_of(Rule::goal)),
            _ => {}
        }
        let last = last_word(before);
        if last.len() < before.len()
            && let Some(word) = nearest(last, words.iter().map(String::as_str))
            && word != last
        {
            edits.push(Edit { at: before.len() - last.len(), removed: last.len(), inserted: word.to_string() });
        }
        if let Some(meant) = token.chars().next().and_then(lookalike) {
            edits.push(replace(meant));
        }
        let mut literals = self.literals(context, token);
        // Before a word that is none of several, none of them is likelier to be missing than another.
        if token.starts_with(is_letter) && literals.iter().filter(|literal| literal.starts_with(is_letter)).count() > 1
        {
            literals.retain(|literal| !literal.starts_with(is_letter));
        }
        // A sign in another's place: `P1-P2` for `P1..P2`, `mass: 5 kg` for `mass = 5 kg`.
        if !token.is_empty() && token.bytes().all(|b| b.is_ascii_punctuation()) && !is_bracket(token) {
            edits.extend(
                literals.iter().rev().filter(|literal| !literal.starts_with(is_letter)).map(|sign| replace(sign)),
            );
        }
        edits.extend(literals.into_iter().map(|literal| match literal.as_str() {
            "," | ":" => Edit { at: before.len(), removed: 0, inserted: literal },
            ".." => Edit { at: before.len(), removed: self.at - before.len(), inserted: literal },
            _ => Edit { at: self.at, removed: 0, inserted: format!("{literal} ") },
        }));
        if self.rules.iter().any(|rule| matches!(rule, Rule::end_of_line | Rule::EOI))
            && matches!(token, ";" | "," | ".")
        {
            edits.push(replace(""));
        }
        edits
    }

    /// The literals that could have been left out before `token`.
    fn literals(&self, context: Context, token: &str) -> Vec<String> {
        let mut literals = Vec::new();
        if token.is_empty() || self.at == 0 {
            return literals;
        }
        let inside = |rule: &Rule| matches!(rule, Rule::comma | Rule::close_bracket | Rule::close_paren);
        let value =
            token.starts_with(|c: char| is_letter(c) || c.is_ascii_digit() || matches!(c, '(' | '[' | '"' | '-'));
        if self.rules.contains(&Rule::comma) || (value && self.rules.iter().any(inside)) {
            literals.push(",".to_string());
        }
        for rule in &self.rules {
            match rule {
                Rule::equals | Rule::dots | Rule::colon => literals.extend(literal_of(*rule).map(str::to_string)),
                _ if context == Context::Statement && is_keyword(*rule) => literals.extend(words_of(*rule)),
                _ => {}
            }
        }
        literals
    }
}

/// A point for the last comma between two digits up to where the grammar stopped: `2,0 m/s` means `2.0 m/s`.
fn decimal_comma(text: &str, at: usize) -> Option<Edit> {
    let bytes = text.as_bytes();
    let digit = |i: Option<usize>| i.and_then(|i| bytes.get(i)).is_some_and(u8::is_ascii_digit);
    let last = bytes.len().checked_sub(1)?.min(at);
    let comma = (0..=last).rev().find(|&i| bytes[i] == b',' && digit(i.checked_sub(1)) && digit(Some(i + 1)))?;
    Some(Edit { at: comma, removed: 1, inserted: ".".to_string() })
}

/// The digits before and behind a decimal comma.
pub fn digits_around(text: &str, comma: usize) -> (&str, &str) {
    let (before, behind) = (&text[..comma], &text[comma + 1..]);
    let from = before.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let to = behind.len() - behind.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    (&before[from..], &behind[..to])
}

/// The words that start a statement of a layout.
pub const STATEMENT_WORDS: [&str; 49] = [
    "axis",
    "building",
    "cart",
    "catalog",
    "chain",
    "choose",
    "chutes",
    "controller",
    "drawing",
    "drive",
    "effect",
    "energy",
    "equal",
    "fails",
    "feed",
    "fix",
    "gate",
    "induction",
    "items",
    "let",
    "level",
    "lift",
    "mirror",
    "motor",
    "motors",
    "obstacle",
    "optimise",
    "optimize",
    "pass",
    "photocell",
    "radii",
    "ramp",
    "require",
    "route",
    "scanner",
    "section",
    "sensor",
    "sensor_cart",
    "speed",
    "start",
    "stops",
    "storage",
    "supports",
    "take_up",
    "turns",
    "vertex",
    "wave",
    "waves",
    "width",
];

const END: &str = "the end of the line";

fn may_follow_anything(rule: Rule) -> bool {
    matches!(rule, Rule::op | Rule::args | Rule::params | Rule::unit)
}

fn keep_if_any(rules: &mut Vec<Rule>, keep: impl Fn(Rule) -> bool) {
    if rules.iter().any(|rule| keep(*rule)) {
        rules.retain(|rule| keep(*rule));
    }
}

fn is_keyword(rule: Rule) -> bool {
    format!("{rule:?}").starts_with("kw_")
}

/// Every keyword that has a rule of its own.
pub fn keywords() -> impl Iterator<Item = &'static str> {
    static ALL: std::sync::OnceLock<Vec<String>> = std::sync::OnceLock::new();
    let all = || Rule::all_rules().iter().filter(|rule| is_keyword(**rule)).flat_map(|rule| words_of(*rule)).collect();
    ALL.get_or_init(all).iter().map(String::as_str)
}

/// The keywords that a rule takes. The name of a keyword's rule is `kw_` and the keyword.
pub(super) fn words_of(rule: Rule) -> Vec<String> {
    let words: Vec<&str> = match rule {
        Rule::kind => DeclarationKind::ALL.map(DeclarationKind::word).to_vec(),
        Rule::component | Rule::component_kind => vec!["cart", "catalog", "controller", "motor", "sensor", "take_up"],
        Rule::fix_kind => FixKind::ALL.map(FixKind::word).to_vec(),
        Rule::axis => vec!["x", "y"],
        Rule::side => SideWord::ALL.map(SideWord::word).to_vec(),
        Rule::goal | Rule::goal_term | Rule::objective => Goal::ALL.map(Goal::word).to_vec(),
        Rule::title_field | Rule::drawing_field => TitleField::ALL.map(TitleField::word).to_vec(),
        Rule::station_word => StationWord::ALL.map(StationWord::word).into_iter().filter(|w| *w != "chutes").collect(),
        Rule::of_kind => vec!["of"],
        Rule::where_free => vec!["anywhere", "on"],
        Rule::drawing_origin => vec!["origin"],
        Rule::grid_row => vec!["every"],
        Rule::chain_tension => vec!["tension"],
        Rule::chain_closes => vec!["closes"],
        Rule::choose_cart => vec!["cart"],
        Rule::choose_motor => vec!["motor"],
        Rule::choose_sensor => vec!["sensor"],
        Rule::choose_take_up => vec!["take_up"],
        Rule::choose_speed => vec!["speed"],
        Rule::choose_radii => vec!["radii"],
        Rule::choose_count => vec!["count"],
        _ => {
            let name = format!("{rule:?}");
            return name.strip_prefix("kw_").map(str::to_string).into_iter().collect();
        }
    };
    words.into_iter().map(str::to_string).collect()
}

fn literal_of(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::comma => ",",
        Rule::colon => ":",
        Rule::equals => "=",
        Rule::dot => ".",
        Rule::dots => "..",
        Rule::plus => "+",
        Rule::open_paren | Rule::args | Rule::params => "(",
        Rule::close_paren => ")",
        Rule::open_bracket => "[",
        Rule::close_bracket => "]",
        Rule::open_brace | Rule::body | Rule::fields => "{",
        Rule::close_brace => "}",
        _ => return None,
    })
}

fn phrases_of(rule: Rule, text: &str, at: usize) -> Vec<String> {
    // pest names the first token of a rule where nothing else could stand.
    let rule = match (first_word(text), rule) {
        (_, Rule::name) if matches!(last_word(text[..at].trim_end()), "level" | "ramp" | "on") => Rule::section,
        ("vertex" | "building" | "obstacle" | "drawing", Rule::open_paren) => Rule::point,
        ("building" | "obstacle", Rule::open_bracket) => Rule::polygon,
        _ => rule,
    };
    if let Some(literal) = literal_of(rule) {
        return vec![format!("`{literal}`")];
    }
    let words = words_of(rule);
    if !words.is_empty() {
        return words.iter().map(|word| format!("`{word}`")).collect();
    }
    let phrase = match rule {
        Rule::EOI | Rule::end_of_line => END,
        Rule::section | Rule::target | Rule::straight => "a section such as `P4..P5`",
        Rule::limits => "a place such as `(5 m, 2 m)..(35 m, 2 m)`",
        Rule::point => "a point such as `(28 m, 1.5 m)`",
        Rule::polygon => "a list of points such as `[(0 m, 0 m), (9 m, 0 m), (9 m, 4 m)]`",
        Rule::place => "a place such as `on P1..P2 at 3 m`",
        Rule::row => "a row such as `on P7..P8 from 2 m every 1.25 m count 12`",
        Rule::relation => "one of `<`, `<=`, `==`, `>=`, `>`",
        Rule::text => "a text in quotes",
        Rule::std_path => "a library such as `std.tracks.standard`",
        Rule::name | Rule::fix_vertex => "a name such as `P1`",
        Rule::reference => "a name such as `tilt_tray`",
        Rule::param => "a parameter such as `length: 1250 mm`",
        Rule::number | Rule::value | Rule::expr | Rule::arg | Rule::weight | Rule::minus | Rule::list | Rule::paren => {
            value_phrase(text, at)
        }
        Rule::times => "`* length` or another goal",
        Rule::op => "one of `+`, `-`, `*`, `/`",
        Rule::unit => "a unit such as `m`",
        Rule::fix_section => "a kind such as `length`",
        Rule::fix => "what to fix, such as `length P4..P5`",
        _ => "something else",
    };
    vec![phrase.to_string()]
}

/// An example of the value that a line's words before it ask for: `4 m`, `5 deg`, `12`.
pub fn value_example(begun: &str) -> &'static str {
    let phrase = value_phrase(begun, begun.len());
    phrase.split('`').nth(1).unwrap_or("4 m")
}

const SHARE_OF_A_ROW: &str = "a share such as `2` or `60 %`";

/// A value as the words before it suggest.
fn value_phrase(text: &str, at: usize) -> &'static str {
    let before = text[..at].trim_end();
    match (first_word(text), last_word(before)) {
        ("drive", "spare") | ("energy", "over") => "a count such as `1`",
        ("drive", "load") => "a mass such as `15 kg`",
        ("energy", "for") | ("drive", "within") => "a time such as `20 s`",
        ("energy", _) => "a price such as `0.22 EUR/kWh`",
        ("stops" | "fails", _) | ("storage", "every") => "a time such as `40 s`",
        ("waves", "spread") => "a share such as `40 %`",
        ("waves", _) => "a time such as `30 min`",
        ("wave", _) => SHARE_OF_A_ROW,
        ("storage", _) | ("items", "laps") => "a count such as `12`",
        ("items", _) | ("feed", "efficiency") => "a share such as `90 %`",
        ("feed", last) if last != "to" && before.contains(" to ") => SHARE_OF_A_ROW,
        ("feed", _) | (_, "capacity") => "a number such as `3000`",
        ("turns", _) => "an angle such as `5 deg`",
        (_, "radius" | "clearance" | "width" | "at" | "from" | "every" | "radii" | "within") => {
            "a length such as `4 m`"
        }
        ("vertex" | "building" | "obstacle" | "radii" | "level" | "axis" | "drawing", _) => "a length such as `4 m`",
        (_, "speed") => "a speed such as `2 m/s`",
        (_, "count" | "motors" | "cart" | "least") => "a count such as `12`",
        (_, "tension") => "a force such as `500 N`",
        (_, "slope") => "a ratio such as `0.14`",
        ("require", _) => "a value such as `length(P4..P5)` or `18 m`",
        _ => "a value such as `4 m`",
    }
}

fn found(token: &str) -> String {
    match token {
        "" | "\n" | "\r\n" => END.to_string(),
        "//" => "a comment".to_string(),
        _ => match token.char_indices().nth(40) {
            Some((cut, _)) => format!("`{}…`", &token[..cut]),
            None => format!("`{token}`"),
        },
    }
}
