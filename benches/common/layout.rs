//! A layout from its text, for all benches.

use lss::model::Layout;
use lss::semantics::analyse;
use lss::source::{Loader, SourceMap};

pub fn layout(text: &str) -> Layout {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("bench.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    analysis.chosen().ok().flatten().unwrap_or_else(|| panic!("{:?}", analysis.diagnostics)).clone()
}
