//! How a search ended, and each of its parts.

/// How a search ended.
pub struct Found {
    /// The best layout's variables, if any was found or given.
    pub variables: Option<Vec<f64>>,
    /// In the tariff's units: m, where length is minimised.
    pub value: f64,
    /// Rigorous, in the same units.
    pub bound: f64,
    pub nodes: usize,
    /// Of chains that were searched apart; none where the whole was.
    pub parts: Vec<Chain>,
}

/// How the search of one chain of a loop ended.
#[derive(Clone, Copy, Debug)]
pub struct Chain {
    /// Its vertices by stage, from the first that turns on; beyond the last stage they go on at the first.
    pub from: usize,
    pub to: usize,
    /// How far the loop may be from the best, as far as this chain is concerned, in the tariff's units.
    pub gap: f64,
    pub nodes: usize,
}
