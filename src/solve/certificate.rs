//! What a search over the catalogue's grid has proven.

/// A bound that comes so close to the length is a proof, m: rows hold to as much.
const PROVEN: f64 = 1e-6;

/// No layout on the grid is shorter than this, as far as was searched.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// m; holds in exact arithmetic.
    pub lower_bound: f64,
    /// (length − lower bound) / length
    pub gap: f64,
    /// Nothing is left between bound and length but the tolerance to which rows hold.
    pub proven: bool,
    pub nodes: usize,
    /// Wall time; never in an output file.
    pub seconds: f64,
    /// What the bound takes for granted, in words.
    pub assumed: Vec<String>,
}

impl Certificate {
    /// Of a layout of this length, m.
    pub fn new(length: f64, lower_bound: f64, nodes: usize, assumed: Vec<String>) -> Self {
        // Before anything was searched it is known that no layout is shorter than nothing.
        let lower_bound = lower_bound.max(0.0).min(length);
        let proven = length - lower_bound <= PROVEN;
        let gap = if length > 0.0 { (length - lower_bound) / length } else { 0.0 };
        Certificate { lower_bound, gap, proven, nodes, seconds: 0.0, assumed }
    }

    /// What several searches prove together of the best of their layouts.
    pub fn combine(&mut self, all: &[Certificate], length: f64) {
        let bound = all.iter().map(|c| c.lower_bound).fold(f64::INFINITY, f64::min);
        let nodes = all.iter().map(|c| c.nodes).sum();
        let seconds = all.iter().map(|c| c.seconds).sum();
        let mut assumed = self.assumed.clone();
        for words in all.iter().flat_map(|c| &c.assumed) {
            if !assumed.contains(words) {
                assumed.push(words.clone());
            }
        }
        *self = Certificate { seconds, ..Certificate::new(length, bound, nodes, assumed) };
    }
}
