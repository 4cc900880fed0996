//! What a simulation of capacity knows of a sorter: carriers, where items come and go, and what goes wrong.

/// A sorter with its items.
#[derive(Clone, Debug, PartialEq)]
pub struct Sorter {
    /// Carriers of the chain, one a cart.
    pub carriers: usize,
    /// Distance between two carriers, m.
    pub pitch: f64,
    /// Of the chain, m/s.
    pub speed: f64,
    pub inductions: Vec<Induction>,
    pub chutes: Vec<Chute>,
    /// Where items are read, arc length, m; without any they are known when they come.
    pub scanners: Vec<f64>,
    pub items: Items,
    pub stops: Option<Stops>,
}

impl Sorter {
    /// Carriers that pass a place in an hour: v / pitch (Johnson and Meller 2002).
    pub fn carriers_per_hour(&self) -> f64 {
        3600.0 * self.speed / self.pitch
    }

    /// Length of the chain, m.
    pub fn length(&self) -> f64 {
        self.pitch * self.carriers as f64
    }

    /// How the items are spread over the inductions: as they come, and alike where they always do.
    pub fn proportions(&self) -> Vec<f64> {
        let known: Vec<f64> = self.inductions.iter().filter_map(|i| i.demand).collect();
        let alike = if known.is_empty() { 1.0 } else { known.iter().sum::<f64>() / known.len() as f64 };
        self.inductions.iter().map(|i| i.demand.unwrap_or(alike)).collect()
    }

    /// The same with items at every induction at any time.
    pub fn always_fed(&self) -> Sorter {
        let mut sorter = self.clone();
        sorter.inductions.iter_mut().for_each(|i| i.demand = None);
        sorter
    }
}

/// Where items come onto the sorter.
#[derive(Clone, Debug, PartialEq)]
pub struct Induction {
    pub name: String,
    /// Arc length, m.
    pub s: f64,
    /// Items an hour that come, at random (Poisson); `None` where there always is one.
    pub demand: Option<f64>,
    /// Most items an hour that it can put on carriers; infinite where only carriers limit it.
    pub most: f64,
    /// Share of free carriers that it uses while there are items.
    pub efficiency: f64,
}

/// Where items leave it.
#[derive(Clone, Debug, PartialEq)]
pub struct Chute {
    /// `row_a 3`
    pub name: String,
    /// Arc length, m.
    pub s: f64,
    /// Share of all items that go there; the shares count in relation to each other.
    pub share: f64,
    /// Items that it holds, and seconds that each takes to be taken away; `None` where it is never full.
    pub storage: Option<(usize, f64)>,
}

/// What all items have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Items {
    /// Share of items that lie on two carriers.
    pub double: f64,
    /// Share of readings that fail.
    pub no_read: f64,
    /// After so many laps an item is given out at the next chute, whatever it was to.
    pub most_laps: usize,
}

impl Default for Items {
    fn default() -> Self {
        Items { double: 0.0, no_read: 0.0, most_laps: usize::MAX }
    }
}

/// Stops of the whole sorter, both times exponential (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops {
    /// Mean time of running between two stops.
    pub between: f64,
    /// Mean duration of a stop.
    pub duration: f64,
}
