//! What a search over the catalogue's grid has proven.

use serde::Serialize;

/// A bound that comes so close to the value is a proof, m: rows hold to as much. In EUR it is a tenth of a cent.
const PROVEN: (f64, f64) = (1e-6, 1e-3);

/// By what share a layout may be below a bound as its rows hold to a tolerance.
const HELD: f64 = 1e-6;

/// What a certificate speaks of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Counted {
    /// m
    Length,
    /// EUR: the price of the pieces before each is rounded to the cent, and so much for each metre, EUR/m.
    Price { metre: f64 },
}

/// What is proven of one chain of the loop between fixed sections, or of the whole loop where it was searched as one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// `P3..P8`, from the first vertex that turns to the last; `loop` for the whole.
    pub chain: String,
    /// No layout is shorter (m) or cheaper (EUR) that has the other chains as they are.
    pub lower_bound: f64,
    pub nodes: usize,
    pub proven: bool,
}

/// No layout on the grid is shorter, or cheaper, than this, as far as was searched.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    pub counted: Counted,
    /// Of the layout, m or EUR.
    pub value: f64,
    /// m or EUR; holds in exact arithmetic.
    pub lower_bound: f64,
    /// (value − lower bound) / value
    pub gap: f64,
    /// Nothing is left between bound and value but the tolerance to which rows hold.
    pub proven: bool,
    pub nodes: usize,
    /// Chain by chain where fixed sections split the loop.
    pub parts: Vec<Part>,
    /// Wall time; never in an output file.
    pub seconds: f64,
    /// What the bound takes for granted, in words.
    pub assumed: Vec<String>,
    /// What only layouts within a budget were compared by, in words.
    pub budget: Option<String>,
    /// Whether EUR are those of all that is ordered.
    pub in_all: bool,
    /// What a proof may leave where rows hold to so much only, m or EUR.
    pub held: f64,
}

/// What may be left between value and bound of a proof.
fn enough(counted: Counted) -> f64 {
    if counted == Counted::Length { PROVEN.0 } else { PROVEN.1 }
}

impl Certificate {
    /// Of a layout of this value, m or EUR.
    pub fn new(counted: Counted, value: f64, lower_bound: f64, nodes: usize, assumed: Vec<String>) -> Self {
        // Before anything was searched it is known that no layout is shorter than nothing, or gets money back.
        let lower_bound = lower_bound.max(0.0).min(value);
        let proven = value - lower_bound <= enough(counted);
        let gap = if value > 0.0 { (value - lower_bound) / value } else { 0.0 };
        let whole = Part { chain: "loop".to_owned(), lower_bound, nodes, proven };
        let (parts, seconds, budget) = (vec![whole], 0.0, None);
        Certificate {
            counted,
            value,
            lower_bound,
            gap,
            proven,
            nodes,
            parts,
            seconds,
            assumed,
            budget,
            in_all: false,
            held: 0.0,
        }
    }

    /// The same where rows hold to so much only, m or EUR.
    #[must_use]
    pub fn held_to(self, held: f64) -> Self {
        Certificate { proven: self.proven || self.value - self.lower_bound <= held, held, ..self }
    }

    /// What it says of the price of all that is ordered: of this layout, and of others at least so much more than is
    /// counted, EUR.
    pub fn in_total(&mut self, total: f64, more: f64) {
        let bound = self.lower_bound + more;
        debug_assert!(bound <= total, "a bound of {bound} EUR for a layout of {total} EUR");
        let parts = std::mem::take(&mut self.parts);
        let (seconds, budget) = (self.seconds, self.budget.take());
        let assumed = std::mem::take(&mut self.assumed);
        let whole = Certificate::new(Counted::Price { metre: 0.0 }, total, bound, self.nodes, assumed);
        let moved = |part: Part| Part { lower_bound: (part.lower_bound + more).max(0.0).min(total), ..part };
        let parts = parts.into_iter().map(moved).collect();
        *self = Certificate { in_all: true, parts, seconds, budget, ..whole };
    }

    /// Chains by name, with how far each leaves the value from the best, and nodes; the whole where there are none.
    pub fn of_chains(&self, chains: impl Iterator<Item = (String, f64, usize)>) -> Vec<Part> {
        let part = |(chain, gap, nodes): (String, f64, usize)| {
            let lower_bound = (self.value - gap).max(0.0);
            Part { chain, lower_bound, nodes, proven: self.value - lower_bound <= enough(self.counted) }
        };
        let parts: Vec<Part> = chains.map(part).collect();
        if parts.is_empty() { self.parts.clone() } else { parts }
    }

    /// What is proven, for people: a line, and one for a budget.
    pub fn words(&self) -> Vec<String> {
        let nodes = if self.nodes == 1 { "1 node".to_owned() } else { format!("{} nodes", self.nodes) };
        let bound = self.lower_bound;
        let (best, least) = match self.counted {
            Counted::Length => ("shortest", format!("shorter than {bound:.6} m")),
            Counted::Price { metre } if metre > 0.0 => {
                ("best", format!("better than {bound:.3} EUR, a metre counted as {metre} EUR"))
            }
            Counted::Price { .. } if self.in_all => ("cheapest", format!("cheaper than {bound:.2} EUR in all")),
            Counted::Price { .. } => ("cheapest", format!("cheaper than {bound:.3} EUR")),
        };
        let these = if self.budget.is_some() {
            "no layout on this grid and within the budget"
        } else {
            "no layout on this grid"
        };
        let proof = if bound == 0.0 && !self.proven {
            format!("no bound was found for layouts on this grid ({nodes}); more time or --nodes may give one")
        } else if self.proven {
            format!("proven {best}: {these} is {least} ({nodes})")
        } else {
            format!("{these} is {least} (gap {:.3} %, {nodes})", 100.0 * self.gap)
        };
        let budget = self.budget.as_ref().map(|budget| format!("budget: {budget}"));
        std::iter::once(proof).chain(budget).collect()
    }

    /// Of layouts of which some were not looked at.
    pub fn know_nothing(&mut self) {
        *self = Certificate {
            seconds: self.seconds,
            ..Self::new(self.counted, self.value, 0.0, self.nodes, std::mem::take(&mut self.assumed))
        };
    }

    /// With what another search of the same layouts has proven, which found no better one.
    pub fn and(&mut self, other: Certificate) {
        let nodes = self.nodes + other.nodes;
        let seconds = self.seconds + other.seconds;
        let (bound, parts) = if other.lower_bound > self.lower_bound {
            (other.lower_bound, other.parts)
        } else {
            (self.lower_bound, std::mem::take(&mut self.parts))
        };
        let assumed = std::mem::take(&mut self.assumed);
        *self = Certificate {
            seconds,
            parts,
            ..Certificate::new(self.counted, self.value, bound, nodes, assumed).held_to(self.held)
        };
    }

    /// With a bound of another kind, where it is the better one, and what that takes for granted. One that the layout
    /// itself is below by more than rows are held to is none.
    pub fn raise(&mut self, bound: f64, assumed: &str) {
        let holds = bound <= self.value * (1.0 + HELD);
        debug_assert!(holds, "a bound of {bound} for a layout of {}", self.value);
        if holds && bound > self.lower_bound {
            let seconds = self.seconds;
            let mut words = std::mem::take(&mut self.assumed);
            words.push(assumed.to_owned());
            let parts = (self.parts.len() > 1).then(|| std::mem::take(&mut self.parts));
            *self = Certificate {
                seconds,
                ..Self::new(self.counted, self.value, bound, self.nodes, words).held_to(self.held)
            };
            self.parts = parts.unwrap_or_else(|| std::mem::take(&mut self.parts));
        }
    }

    /// What several searches prove together of the best of their layouts, which is this one's.
    pub fn combine(&mut self, all: &[Certificate]) {
        let bound = all.iter().map(|c| c.lower_bound).fold(f64::INFINITY, f64::min);
        let nodes = all.iter().map(|c| c.nodes).sum();
        let seconds = all.iter().map(|c| c.seconds).sum();
        let mut assumed = self.assumed.clone();
        for words in all.iter().flat_map(|c| &c.assumed) {
            if !assumed.contains(words) {
                assumed.push(words.clone());
            }
        }
        let parts = std::mem::take(&mut self.parts);
        *self = Certificate {
            seconds,
            parts,
            ..Certificate::new(self.counted, self.value, bound, nodes, assumed).held_to(self.held)
        };
    }
}
