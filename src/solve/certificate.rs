//! What a search over the catalogue's grid has proven.

/// A bound that comes so close to the value is a proof, m: rows hold to as much. In EUR it is a tenth of a cent.
const PROVEN: (f64, f64) = (1e-6, 1e-3);

/// What a certificate speaks of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Counted {
    /// m
    Length,
    /// EUR: the price of the pieces before each is rounded to the cent, and so much for each metre, EUR/m.
    Price { metre: f64 },
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
    /// Wall time; never in an output file.
    pub seconds: f64,
    /// What the bound takes for granted, in words.
    pub assumed: Vec<String>,
}

impl Certificate {
    /// Of a layout of this value, m or EUR.
    pub fn new(counted: Counted, value: f64, lower_bound: f64, nodes: usize, assumed: Vec<String>) -> Self {
        // Before anything was searched it is known that no layout is shorter than nothing, or gets money back.
        let lower_bound = lower_bound.max(0.0).min(value);
        let enough = if counted == Counted::Length { PROVEN.0 } else { PROVEN.1 };
        let proven = value - lower_bound <= enough;
        let gap = if value > 0.0 { (value - lower_bound) / value } else { 0.0 };
        Certificate { counted, value, lower_bound, gap, proven, nodes, seconds: 0.0, assumed }
    }

    /// Of layouts of which some were not looked at.
    pub fn know_nothing(&mut self) {
        *self = Certificate {
            seconds: self.seconds,
            ..Self::new(self.counted, self.value, 0.0, self.nodes, std::mem::take(&mut self.assumed))
        };
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
        *self = Certificate { seconds, ..Certificate::new(self.counted, self.value, bound, nodes, assumed) };
    }
}
