//! Statements that only one of two checked layouts has.

use super::{Change, Line};
use crate::model::{Layout, print};
use std::collections::BTreeMap;

/// What went, in the order of the first, then what came, in that of the second.
pub fn changed(before: &Layout, after: &Layout) -> Vec<Line> {
    // What a choice was made among is no change of the layout: its `choose` lines say that it was made.
    let chosen = before.choice.is_open() != after.choice.is_open();
    let told = |layout: &Layout| {
        let mut lines = statements(&print(layout), &layout.name);
        let own = [format!("cart {}", layout.cart.name), format!("motor {}", layout.drive.motor.name)];
        let other =
            |block: &str| (block.starts_with("cart ") || block.starts_with("motor ")) && own.iter().all(|o| o != block);
        lines.retain(|(within, _)| !(chosen && other(within.split(" / ").next().unwrap_or(within))));
        lines
    };
    let [first, second] = [before, after];
    let [mut before, mut after] = [first, second].map(told);
    // What follows from a line that only one has is no line of its own.
    let implied = |other: &Layout| {
        let known: Vec<String> = other.obstacles.iter().map(|own| format!("pass {} ", own.name)).collect();
        move |(within, text): &(String, String)| {
            let passes = text.starts_with("pass ") && known.iter().all(|pass| !text.starts_with(pass.as_str()));
            within.is_empty() && (passes || text == "motors 0 evenly")
        }
    };
    let (in_first, in_second) = (implied(second), implied(first));
    before.retain(|line| !in_first(line));
    after.retain(|line| !in_second(line));
    let [before, after] = [in_one(&before, &after), in_one(&after, &before)];
    let only = |own: &[(String, String)], other: &[(String, String)], change: Change| -> Vec<Line> {
        let mut known: BTreeMap<&(String, String), usize> = BTreeMap::new();
        other.iter().for_each(|line| *known.entry(line).or_default() += 1);
        let mut is_known = |line: &(String, String)| match known.get_mut(line) {
            Some(count) if *count > 0 => {
                *count -= 1;
                true
            }
            _ => false,
        };
        let lines = own.iter().filter(|line| !is_known(line));
        lines.map(|(within, text)| Line { change, within: within.clone(), text: text.clone() }).collect()
    };
    let mut out = only(&before, &after, Change::Removed);
    out.extend(only(&after, &before, Change::Added));
    out
}

/// Statements of a block at most that stands in one line.
const SHORT: usize = 8;

/// A declaration that the other does not have at all stands in one line, if it is short: `take_up spring { … }`.
fn in_one(own: &[(String, String)], other: &[(String, String)]) -> Vec<(String, String)> {
    let mut out: Vec<(String, String)> = Vec::new();
    for block in own.chunk_by(|a, b| a.0 == b.0) {
        let within = &block[0].0;
        let is_whole = !within.is_empty() && !within.contains(" / ") && block.len() <= SHORT;
        let is_new = other.iter().all(|(there, _)| there.split(" / ").next() != Some(within));
        let is_split = own.iter().filter(|(there, _)| there.split(" / ").next() == Some(within)).count() > block.len();
        if is_whole && is_new && !is_split {
            let statements: Vec<&str> = block.iter().map(|(_, text)| text.trim_end_matches(';')).collect();
            out.push((String::new(), format!("{within} {{ {} }}", statements.join("; "))));
        } else {
            out.extend(block.iter().cloned());
        }
    }
    out
}

/// Each statement with the blocks around it.
fn statements(text: &str, layout: &str) -> Vec<(String, String)> {
    let own = format!("layout {layout}");
    let mut within: Vec<&str> = Vec::new();
    let mut out = Vec::new();
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
        if line == "}" {
            within.pop();
        } else {
            let blocks: Vec<&str> = within.iter().copied().filter(|block| *block != own).collect();
            let head = line.strip_suffix('{').map(str::trim_end);
            // What a layout is called is told by itself; a block that holds something is told by that.
            if head.is_none() {
                out.push((blocks.join(" / "), line.to_owned()));
            }
            within.extend(head);
        }
    }
    out
}
