//! What a longer straight made room for, on shorter ones. How long a straight has to be for what finds no place is only
//! guessed where obstacles, walls or other equipment are in the way: all of it at once on one straight, though it may
//! stand on several, which a loop makes longer together. So the length is halved as long as that gains.

use super::Node;
use crate::geometry::Track;

/// Lengths of a straight are halved until they are so near, m.
const NEAR: f64 = 0.05;

/// Lengths of a straight between which the least is looked for that makes room for everything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halved {
    section: usize,
    /// Too short, m.
    low: f64,
    /// Enough, m.
    high: f64,
}

impl Node {
    /// A node with one of its straights made longer, whose length is halved where that makes enough room.
    pub fn halving(self, section: usize, from: f64) -> Node {
        let high = self.least(section);
        Node { halved: high.map(|high| Halved { section, low: from, high }), ..self }
    }

    /// Whether it has a straight that is shorter than was enough.
    pub fn is_halved(&self) -> bool {
        self.halved.is_some_and(|halved| self.least(halved.section) < Some(halved.high))
    }

    /// The least length of a straight, m.
    fn least(&self, section: usize) -> Option<f64> {
        self.straights.iter().find_map(|(of, low)| (*of == section).then_some(*low))
    }

    /// The node with a straight between what was too short and what was enough, once it is known whether this one had
    /// room for everything, and whether it is the best that is known.
    pub fn shorter(&self, track: &Track, whole: bool, better: bool) -> Option<Node> {
        let Halved { section, mut low, mut high } = self.halved?;
        let length = self.least(section)?;
        match (whole, self.is_halved()) {
            // A track may have made it longer than it had to be.
            (true, _) if better => high = length.min(track.straight(section).length),
            // Of one that was first tried nothing is halved where there is better.
            (true, _) | (false, false) => return None,
            (false, true) => low = length,
        }
        if high - low < NEAR {
            return None;
        }
        let middle = 0.5 * (low + high);
        let straights = self.straights.iter().map(|&(of, low)| (of, if of == section { middle } else { low }));
        let straights = straights.collect();
        Some(Node { straights, complete: false, halved: Some(Halved { section, low, high }), ..self.clone() })
    }
}
