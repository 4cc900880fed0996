//! What may follow the beginning of a line, as the grammar says it.

use super::Rule;
use super::expected::{Context, words_of};
use super::grammar::Grammar;
use super::tree::Goal;
use pest::Parser;
use pest::error::ErrorVariant;

/// What may stand next in a line.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Next {
    /// A keyword.
    Word(String),
    /// A name that the line declares or refers to.
    Name,
    /// A section between vertices, or the first of them.
    Section,
    /// A number, a name, a call: anything that has a value.
    Value,
    /// A unit behind its number.
    Unit,
    /// A text in quotes.
    Text,
    /// The line may end here.
    End,
}

/// A character that no rule takes, so that the parser says what it would have taken in its place.
const NOTHING: char = '\u{1}';

/// What may follow `begun`, a line from its first word to a place between two tokens. Nothing where the grammar does not
/// get that far.
pub fn continuations(context: Context, begun: &str) -> Vec<Next> {
    let text = format!("{begun}{NOTHING}");
    let Err(error) = Grammar::parse(context.entry(), &text) else { return Vec::new() };
    let at = match error.location {
        pest::error::InputLocation::Pos(at) | pest::error::InputLocation::Span((at, _)) => at,
    };
    let ErrorVariant::ParsingError { positives, .. } = error.variant else { return Vec::new() };
    if at < begun.trim_end().len() {
        return Vec::new();
    }
    let mut all: Vec<Next> = positives.into_iter().flat_map(|rule| of_rule(rule, begun)).collect();
    all.sort_unstable();
    all.dedup();
    all
}

fn of_rule(rule: Rule, begun: &str) -> Vec<Next> {
    let mut words = words_of(rule);
    // The grammar takes any goal beside others; what a layout means does not.
    if matches!(rule, Rule::goal | Rule::goal_term | Rule::objective) && begun.split_whitespace().count() > 1 {
        words.retain(|word| !Goal::ALL.iter().any(|goal| goal.word() == word && goal.stands_alone()));
    }
    if !words.is_empty() {
        return words.into_iter().map(Next::Word).collect();
    }
    let last = begun.trim_end().rsplit(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
    // pest names a rule by the first one that could begin there.
    match rule {
        Rule::name if matches!(last, "level" | "ramp" | "on") => vec![Next::Section],
        Rule::name => vec![Next::Name],
        Rule::target => vec![Next::Section, Next::Word("straight".to_owned())],
        Rule::value | Rule::expr | Rule::arg | Rule::number => vec![Next::Value],
        Rule::unit => vec![Next::Unit],
        Rule::text => vec![Next::Text],
        Rule::EOI => vec![Next::End],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(context: Context, begun: &str) -> String {
        let all = continuations(context, begun).into_iter().map(|next| match next {
            Next::Word(word) => format!("`{word}`"),
            other => format!("{other:?}"),
        });
        all.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn the_grammar_says_what_may_follow() {
        for (begun, expected) in [
            ("vertex P1 (2 ", "Unit"),
            ("vertex P1 (2 m, 1.5 m) ", "`radius` End"),
            ("fix ", "`all` `length` `parallel` `perpendicular` `radius` `rotation` Name"),
            ("fix length ", "`straight` Section End"),
            ("fix length P1..", "Name"),
            ("require length(P1..P2) >= 3 ", "Unit Text End"),
            ("pass column ", "`either` `left` `right`"),
            ("start on ", "Section"),
            ("chutes a on P1..P2 from 2 m ", "`every`"),
            ("motors 5 ", "`evenly` Unit"),
            ("induction a of feeder ", "`anywhere` `at` `on`"),
            ("scanner a of portal on ", "`straights` Section"),
            ("scanner a of portal anywhere after ", "`the` Name"),
            ("scanner a of portal anywhere after the last ", "`induction`"),
            ("chutes a of slide ", "`at` `on`"),
            ("scanner a of portal anywhere ", "`after` `before` `fed` End"),
            ("chain ", "`closes` `tension`"),
            ("storage row_a 12 ", "`every` Unit End"),
            ("waves every 30 min ", "`changeover` `spread` End"),
            ("wave a to row_a ", "Value"),
            ("feed a efficiency 90 % to row_a ", "Value"),
            ("fails west ", "`every`"),
            ("optimise ", "`cost` `length` `nothing` `polygon_action` `total_price`"),
            ("optimise 2 * ", "`cost` `length` `polygon_action`"),
            ("optimise cost + ", "`cost` `length` `polygon_action`"),
            ("optimise cost within ", "`cost` `length` `polygon_action`"),
            ("let a = ", "Value"),
            ("vertex vertex vertex ", ""),
        ] {
            assert_eq!(shown(Context::Statement, begun), expected, "{begun}");
        }
        assert_eq!(continuations(Context::Statement, "").len(), 48);
        assert_eq!(shown(Context::Item, "layout a "), "`from`");
        assert_eq!(shown(Context::Item, "use "), "Name Text");
        assert_eq!(shown(Context::Field, "lengths = 500 mm .. 1 m "), "`step` End");
    }
}
