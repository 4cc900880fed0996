//! What longer straights made room for, on shorter ones. How long a straight has to be for what finds no place is only
//! guessed where obstacles, walls or other equipment are in the way: all of it at once on one straight, though it may
//! stand on several, which a loop makes longer together. So lengths are halved as long as there is room for everything.

use super::Node;

/// Lengths of a straight are halved until they are so near, m.
const NEAR: f64 = 0.05;

/// Straights of which the least lengths are looked for that make room for everything, one after another.
#[derive(Clone, Debug, PartialEq)]
pub struct Halved {
    /// The one that is halved now, and between which lengths: too short and enough, m.
    section: usize,
    low: f64,
    high: f64,
    /// Those after it, with a length that is too short, m.
    next: Vec<(usize, f64)>,
    /// No layout with what is too short is better, and none with what was too short of all.
    bound: f64,
    first: f64,
}

impl Node {
    /// A node with straights made longer, whose lengths are halved where that makes enough room; `from` are these
    /// straights with the lengths before, m.
    pub fn halving(self, from: &[(usize, f64)]) -> Node {
        let halved = from.split_first().and_then(|(&(section, low), next)| {
            let (high, next, bound) = (self.least(section)?, next.to_vec(), self.bound);
            Some(Halved { section, low, high, next, bound, first: bound })
        });
        Node { halved, ..self }
    }

    /// Whether it has a straight that is shorter than was enough.
    pub fn is_halved(&self) -> bool {
        self.halved.as_ref().is_some_and(|halved| self.least(halved.section) < Some(halved.high))
    }

    /// The least length of a straight, m.
    fn least(&self, section: usize) -> Option<f64> {
        self.straights.iter().find_map(|(of, low)| (*of == section).then_some(*low))
    }

    /// The node with a straight between what was too short and what was enough, once it is known whether this one had
    /// room for everything. Where it had none and is itself no better than what is known (`least`), longer ones are not
    /// either.
    pub fn shorter(&self, whole: bool, least: f64) -> Option<Node> {
        let Halved { section, mut low, mut high, mut next, mut bound, first } = self.halved.clone()?;
        let length = self.least(section)?;
        match (whole, self.is_halved()) {
            (true, _) => high = length,
            (false, true) if self.bound < least => (low, bound) = (length, self.bound),
            (false, _) => return None,
        }
        let mut straights = self.straights.clone();
        let mut set = |section: usize, length: f64| {
            straights.iter_mut().filter(|(of, _)| *of == section).for_each(|(_, low)| *low = length);
        };
        let mut section = section;
        while high - low < NEAR {
            set(section, high);
            let (following, short) = (!next.is_empty()).then(|| next.remove(0))?;
            (section, low, high, bound) = (following, short, self.least(following)?, first);
        }
        set(section, 0.5 * (low + high));
        let halved = Some(Halved { section, low, high, next, bound, first });
        Some(Node { straights, complete: false, bound, halved, ..self.clone() })
    }
}
