//! What `lss build` does and says of a layout that asks for a route.

use crate::base::number::trimmed;
use crate::cli::MessageFormat;
use crate::cli::limits;
use crate::cli::progress::Solving;
use crate::compiled::{Compiled, order};
use crate::diagnostic::Diagnostic;
use crate::model::Layout;
use crate::route::{self, Summary};
use crate::solve::Options;
use crate::source::SourceMap;
use serde::Serialize;

/// The layout that was found, solved, with its text and what is to be told of it.
pub struct Routed {
    pub compiled: Compiled,
    /// `layout.lss`
    pub text: Option<String>,
    summary: Summary,
}

/// The route in the summary of a build.
#[derive(Serialize)]
pub struct RouteSummary<'a> {
    vertices: usize,
    sections: &'a [String],
    orders: usize,
    tried: usize,
    /// Of any loop through the sections.
    lower_bound_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    lower_bound_eur: Option<f64>,
    gap: f64,
    assumed: [&'static str; 2],
}

/// What the bound of a route is about.
const ASSUMED: [&str; 2] = [
    "the loop is flat, passes every section once, in an allowed order and way",
    "it keeps its distance from building and obstacles, and nowhere bends tighter than the smallest radius",
];

impl Routed {
    pub fn find(
        sources: &SourceMap,
        layout: &Layout,
        options: &Options,
        format: MessageFormat,
    ) -> Result<Routed, Vec<Diagnostic>> {
        let line = Solving::new(format);
        let found = route::find(layout, options, &|progress| line.show(progress));
        line.finish();
        Ok(Routed::new(sources, layout, found?))
    }

    /// What was found for a layout.
    pub fn new(sources: &SourceMap, layout: &Layout, found: route::Found) -> Routed {
        let route::Found { layout: with_vertices, stages, summary } = found;
        let compiled = Compiled::new(with_vertices, stages);
        let text = route::text(sources, layout, &compiled.layout, &compiled.track.corners);
        Routed { compiled, text, summary }
    }

    pub fn summary(&self) -> RouteSummary<'_> {
        let (mut value, mut price) = (self.summary.value, self.summary.cheapest);
        if self.compiled.layout.objective.total_price {
            // How often another loop turns is not known: what chords cut is a share of its length.
            let more = self.compiled.beyond_cost(0.0);
            value = order::total(&self.compiled).all;
            let share = 1.0 - self.compiled.layout.share_cut_by_chords();
            price = price.map(|price| (share * price + more).clamp(0.0, value));
        }
        let bound = price.unwrap_or(self.summary.shortest);
        RouteSummary {
            vertices: self.compiled.layout.vertices.len(),
            sections: &self.summary.order,
            orders: self.summary.rounds,
            tried: self.summary.tried,
            lower_bound_m: self.summary.shortest,
            lower_bound_eur: price,
            gap: ((value - bound) / value).max(0.0),
            assumed: ASSUMED,
        }
    }
}

impl RouteSummary<'_> {
    pub fn text(&self) -> String {
        let plural = |n: usize, one: &str, many: &str| if n == 1 { format!("1 {one}") } else { format!("{n} {many}") };
        let least = match self.lower_bound_eur {
            Some(price) => format!("worth less than {price:.2} EUR"),
            None => format!("shorter than {} m", trimmed(self.lower_bound_m, 3)),
        };
        format!(
            "  {} through {}; best of {} in {}\n  no loop through these sections, whatever its curves, is {least} (gap {:.2} %)\n",
            plural(self.vertices, "vertex", "vertices"),
            self.sections.join(", "),
            plural(self.tried, "loop", "loops"),
            plural(self.orders, "order", "orders"),
            100.0 * self.gap
        )
    }
}

/// The options that the search for a route is run with.
pub fn options(options: Options) -> Options {
    Options { perturb: None, threads: limits::threads(), ..options }
}
