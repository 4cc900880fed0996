//! What a simulation of capacity knows of a sorter: carriers, where items come and go, and what goes wrong.

use crate::base::trig;

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
    /// Where items are read; without any they are known when they come.
    pub scanners: Vec<Scanner>,
    pub items: Items,
    pub stops: Option<Stops>,
    pub waves: Option<Waves>,
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

    /// Time of a lap, s.
    pub fn lap(&self) -> f64 {
        self.length() / self.speed
    }

    /// Shares of the chutes in a wave of the cycle, before any are drawn: what it says, else the chutes' own.
    pub fn shares(&self, wave: usize) -> Vec<f64> {
        let said = self.waves.as_ref().and_then(|waves| waves.each.get(wave));
        said.map_or_else(|| self.chutes.iter().map(|c| c.share).collect(), |wave| wave.shares.clone())
    }

    /// Most items an hour of an induction: no more than carriers that pass while it works, if it fails.
    pub fn most_of(&self, induction: &Induction) -> f64 {
        let carriers = self.carriers_per_hour() / (1.0 + self.items.double);
        induction.fails.as_ref().map_or(induction.most, |fails| induction.most.min(carriers) * fails.available())
    }

    /// Most items an hour that go into a chute; `None` where it is never full.
    pub fn most_into(&self, chute: &Chute) -> Option<f64> {
        let (count, seconds) = chute.storage?;
        Some(match &self.waves {
            None => 3600.0 / seconds,
            Some(waves) => (count as f64 + (waves.every - waves.changeover) / seconds) * 3600.0 / waves.every,
        })
    }

    /// In which proportions items come to the inductions; `None` where one always has items, so that they may be any.
    pub fn proportions(&self) -> Option<Vec<f64>> {
        self.inductions.iter().map(|i| i.demand).collect()
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
    /// What the chutes' shares are multiplied with for its items, one a chute; `None` where its items are as all others.
    pub to: Option<Vec<f64>>,
    pub fails: Option<Failures>,
}

impl Induction {
    /// Shares of the chutes of its items, in relation to each other, where those of all items are these.
    pub fn shares(&self, all: &[f64]) -> Vec<f64> {
        match &self.to {
            None => all.to_vec(),
            Some(to) => all.iter().zip(to).map(|(share, factor)| share * factor).collect(),
        }
    }
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
    /// Items that it holds, and seconds that each takes to be taken away, infinite where only a change of waves empties
    /// it; `None` where it is never full.
    pub storage: Option<(usize, f64)>,
    pub fails: Option<Failures>,
}

/// Where items are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Scanner {
    /// Arc length, m.
    pub s: f64,
    pub fails: Option<Failures>,
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

/// Failures of an induction, a chute or a scanner, both times exponential (s), whether the sorter runs or stops.
#[derive(Clone, Debug, PartialEq)]
pub struct Failures {
    /// Of the induction, the row of chutes, or all scanners: what is told together.
    pub name: String,
    /// Mean time from a repair to the next failure.
    pub between: f64,
    /// Mean time of a repair.
    pub duration: f64,
}

impl Failures {
    /// Share of time in which it works: b / (b + d) (Barlow and Proschan 1965).
    pub fn available(&self) -> f64 {
        self.between / (self.between + self.duration)
    }

    /// The probability that it is down so much later (s) than it was: that of a Markov process with two states.
    pub fn still_down(&self, later: f64) -> f64 {
        let rate = 1.0 / self.between + 1.0 / self.duration;
        let available = self.available();
        1.0 - available + available * trig::exp(-rate * later)
    }

    /// Laps that an item makes before it meets the chute at work, in the mean: it meets it down with probability 1 - A, and
    /// after every such lap with [`Failures::still_down`]; no more than `most`.
    pub fn laps(&self, lap: f64, most: usize) -> f64 {
        let again = self.still_down(lap);
        let first = 1.0 - self.available();
        if most == usize::MAX {
            first / (1.0 - again)
        } else {
            first * (1.0 - trig::pow(again, most as f64)) / (1.0 - again)
        }
    }
}

/// Waves of items one behind the other, each of which goes to the chutes in other shares.
#[derive(Clone, Debug, PartialEq)]
pub struct Waves {
    /// From the begin of one to the begin of the next, s.
    pub every: f64,
    /// At the begin of each: chutes are emptied and take nothing, s.
    pub changeover: f64,
    /// Coefficient of variation of what a chute's share is multiplied with, drawn anew in each wave; 0 where none is.
    pub spread: f64,
    /// In turn, again and again; none where the chutes' own shares hold in all.
    pub each: Vec<Wave>,
}

impl Waves {
    /// Waves until they repeat.
    pub fn count(&self) -> usize {
        self.each.len().max(1)
    }

    /// Time until they repeat, s.
    pub fn cycle(&self) -> f64 {
        self.every * self.count() as f64
    }
}

/// Where the items of a wave go.
#[derive(Clone, Debug, PartialEq)]
pub struct Wave {
    pub name: String,
    /// One a chute, in relation to each other; 0 where none go.
    pub shares: Vec<f64>,
}
