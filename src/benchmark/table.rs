//! A score as text for the terminal and as Markdown for the documentation.

use super::key::StrengthLevel;
use super::score::{Accuracy, CaseRow, Score, ScoreRow};
use super::statistics::{Mean, Share};
use crate::base::number::{fixed, trimmed};
use crate::effects::LIBRARY;
use std::fmt::Write;

/// Rows of cells; the first row heads the columns.
type Cells = Vec<Vec<String>>;

/// The longest ranking there can be: every effect of the library, no gap and unknown.
const RANKS: usize = LIBRARY.len() + 2;

fn share(share: Share) -> String {
    let Some(value) = share.value() else { return "–".to_owned() };
    let percent = |x: f64| fixed(100.0 * x, 0);
    format!("{} % ({}/{}, {}–{})", percent(value), share.hits, share.of, percent(share.low), percent(share.high))
}

fn mean(mean: Option<Mean>) -> String {
    mean.map_or_else(|| "–".to_owned(), |m| format!("{} ({}–{})", fixed(m.value, 2), fixed(m.low, 2), fixed(m.high, 2)))
}

fn fine(mean: Option<Mean>) -> String {
    mean.map_or_else(|| "–".to_owned(), |m| format!("{} ({}–{})", fixed(m.value, 4), fixed(m.low, 4), fixed(m.high, 4)))
}

fn row(name: &str, a: &Accuracy) -> Vec<String> {
    let shares = [a.top_1, a.top_3, a.top_1_group, a.top_3_group].map(share);
    std::iter::once(name.to_owned()).chain(shares).chain([mean(a.probability)]).collect()
}

fn accuracies(first: &str, rows: &[ScoreRow]) -> Cells {
    let head = [first, "top-1", "top-3", "top-1 by group", "top-3 by group", "probability on the truth"];
    let rows = rows.iter().filter(|r| r.accuracy.top_1.of > 0).map(|r| row(&r.name, &r.accuracy));
    std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect()
}

fn figures(score: &Score) -> Cells {
    let rows = [
        ("top-1 on medium and strong effects", share(score.headline.top_1)),
        ("top-3 on medium and strong effects", share(score.headline.top_3)),
        ("top-1 by group on medium and strong effects", share(score.headline.top_1_group)),
        ("top-3 by group on medium and strong effects", share(score.headline.top_3_group)),
        ("false alarms where there is no gap", share(score.false_alarms)),
        ("area under the curve for unknown", mean(score.unknown_area)),
        ("the same, medium and strong unknown effects", mean(score.unknown_area_clear)),
        ("Brier score", fine(score.brier)),
        ("Brier score of always saying the prevalence", score.brier_of_prevalence.map_or("–".into(), |x| fixed(x, 4))),
        ("place named right, of effects named", share(score.places)),
        ("share of the local gap at the true place", mean(score.overlap)),
        ("the same of a map without knowledge", mean(score.overlap_by_chance)),
        ("90 % intervals of strengths that hold the truth", share(score.coverage)),
        ("gap closed", mean(score.closed)),
        ("gap closed by the oracle", mean(score.closed_oracle)),
        ("gap closed by a placebo", mean(score.closed_placebo)),
        ("gap closed by a black box", mean(score.closed_black_box)),
        ("cases without an answer", format!("{} of {}", score.failed, score.cases)),
    ];
    let head = vec!["figure".to_owned(), "value (95 % interval)".to_owned()];
    std::iter::once(head).chain(rows.into_iter().map(|(name, value)| vec![name.to_owned(), value])).collect()
}

fn calibration(score: &Score) -> Cells {
    let head = ["said", "mean", "came true"].map(str::to_owned).to_vec();
    let rows = score.calibration.iter().map(|bin| {
        vec![format!("{}–{}", fixed(bin.from, 1), fixed(bin.to, 1)), fixed(bin.forecast, 3), share(bin.came_true)]
    });
    std::iter::once(head).chain(rows).collect()
}

fn cases(score: &Score) -> Cells {
    let head = ["case", "kind", "truth", "over the repeatability", "first", "second", "on the truth", "rank"]
        .map(str::to_owned)
        .to_vec();
    let said = |line: &CaseRow, k: usize| match line.scored.first.get(k) {
        Some((name, p)) if line.answered => format!("{name} {}", fixed(*p, 2)),
        _ => "–".to_owned(),
    };
    let each = |line: &CaseRow| {
        vec![
            line.name.clone(),
            line.kind.name().to_owned(),
            if line.truth.is_empty() { "–".to_owned() } else { line.truth.join(" + ") },
            match line.level {
                Some(level) => format!("{} ({})", trimmed(line.strength_over_floor, 1), level.name()),
                None => "–".to_owned(),
            },
            said(line, 0),
            said(line, 1),
            fixed(line.scored.probability, 2),
            if line.scored.rank.exact > RANKS { "–".to_owned() } else { line.scored.rank.exact.to_string() },
        ]
    };
    std::iter::once(head).chain(score.each.iter().map(each)).collect()
}

/// The score with its parts under headings.
fn parts(score: &Score) -> Vec<(&'static str, Cells)> {
    vec![
        ("In all", figures(score)),
        ("By kind", accuracies("kind", &score.by_kind)),
        ("By strength over the repeatability", accuracies("level", &score.by_level)),
        ("By effect", accuracies("effect", &score.by_effect)),
        ("Calibration", calibration(score)),
        ("Cases", cases(score)),
    ]
}

/// Aligned columns.
pub fn text(score: &Score) -> String {
    let mut out = String::new();
    for (heading, cells) in parts(score) {
        let columns = cells.iter().map(Vec::len).max().unwrap_or(0);
        let width = |k: usize| cells.iter().filter_map(|row| row.get(k)).map(|c| c.chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let _ = writeln!(out, "{heading}");
        for row in &cells {
            let line: Vec<String> = row.iter().zip(&widths).map(|(cell, w)| format!("{cell:<w$}", w = *w)).collect();
            let _ = writeln!(out, "  {}", line.join("  ").trim_end());
        }
        out.push('\n');
    }
    out.trim_end().to_owned() + "\n"
}

/// For the documentation.
pub fn markdown(score: &Score) -> String {
    let mut out = String::new();
    for (heading, cells) in parts(score) {
        let _ = writeln!(out, "## {heading}\n");
        for (k, row) in cells.iter().enumerate() {
            let _ = writeln!(out, "| {} |", row.join(" | "));
            if k == 0 {
                let _ = writeln!(out, "|{}", " --- |".repeat(row.len()));
            }
        }
        out.push('\n');
    }
    let levels: Vec<String> = StrengthLevel::ALL.iter().map(|l| l.name().to_owned()).collect();
    let _ = write!(
        out,
        "Shares have Wilson's intervals, means those of 2000 bootstrap samples. Levels are {}: under 3, 3 to 10 and \
         over 10 times the\n\
         distance of two replicate laps. An effect's rank is among all effects, no gap and unknown; both effects of a \
         pair must be\n\
         found, each ranked without the other. By group, effects that an answer says it cannot tell apart count as \
         one.\n",
        levels.join(", ")
    );
    out
}
