//! What a challenge's key holds, what is public of it, and what an answer says.

use crate::gap::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What was done to a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CaseKind {
    /// One effect of the machine.
    One,
    /// Two of them.
    Pair,
    /// Nothing.
    None,
    /// Something that no effect of the library is.
    Unknown,
    /// A sensor's effect.
    Sensor,
}

impl CaseKind {
    pub const ALL: [CaseKind; 5] = [CaseKind::One, CaseKind::Pair, CaseKind::Sensor, CaseKind::None, CaseKind::Unknown];

    pub fn name(self) -> &'static str {
        match self {
            CaseKind::One => "one effect",
            CaseKind::Pair => "pair",
            CaseKind::None => "no gap",
            CaseKind::Unknown => "unknown",
            CaseKind::Sensor => "sensor",
        }
    }

    /// Whether it has effects that can be named.
    pub fn nameable(self) -> bool {
        matches!(self, CaseKind::One | CaseKind::Pair | CaseKind::Sensor)
    }
}

/// Strength over the repeatability.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StrengthLevel {
    /// Under 3 times the repeatability.
    Weak,
    /// 3 to 10 times.
    Medium,
    /// Over 10 times.
    Strong,
}

impl StrengthLevel {
    pub const ALL: [StrengthLevel; 3] = [StrengthLevel::Weak, StrengthLevel::Medium, StrengthLevel::Strong];

    pub fn of(strength_over_floor: f64) -> Self {
        match strength_over_floor {
            x if x < 3.0 => StrengthLevel::Weak,
            x if x <= 10.0 => StrengthLevel::Medium,
            _ => StrengthLevel::Strong,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            StrengthLevel::Weak => "weak",
            StrengthLevel::Medium => "medium",
            StrengthLevel::Strong => "strong",
        }
    }
}

/// An effect that was put in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// As the library names it; of an unknown effect, words for it.
    pub effect: String,
    /// In SI units, as the library defines them; only those that mean the same in both.
    pub strengths: BTreeMap<String, f64>,
    /// What says the place, as the library does.
    pub fixed: BTreeMap<String, f64>,
    /// Stretch of the track on which it acts, m.
    pub place: Option<(f64, f64)>,
}

/// A case of the key.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    pub name: String,
    pub kind: CaseKind,
    pub truth: Vec<Truth>,
    /// What the effects do to the two-cart means over the repeatability: two replicate laps' root mean square distance,
    /// in the channel in which that is most. 0 without effects.
    pub strength_over_floor: f64,
    pub level: Option<StrengthLevel>,
    /// Gap closed by the true effect at its true strength, with the true nuisances.
    pub oracle: Option<f64>,
    /// Layout, and how its runs were integrated, in words.
    pub about: String,
}

/// What the sealed file holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Key {
    pub seed: u64,
    pub cases: Vec<Case>,
}

/// `challenge.json`: what everybody may know.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Facts {
    /// SHA-256 of salt and key.
    pub key_sha256: String,
    /// Names of the cases, each a folder with a campaign.
    pub cases: Vec<String>,
    /// How many in a hundred are of each kind, in words.
    pub mix: String,
}

/// What of a `gap.json` is scored. What another program left out counts as not said.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Answer {
    pub verdict: Option<Verdict>,
    pub effects: Vec<Named>,
    #[serde(rename = "where")]
    pub places: Vec<GapPart>,
    pub unknown_probability: Option<f64>,
    pub none_probability: Option<f64>,
    pub gap_closed: Option<f64>,
    pub gap_closed_black_box: Option<f64>,
}

/// An effect of an answer.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Named {
    pub name: String,
    pub group: String,
    pub probability: Option<f64>,
    pub strength: BTreeMap<String, StrengthInterval>,
    pub gap_closed: Option<f64>,
    pub gap_closed_placebo: Option<f64>,
    pub fixed: BTreeMap<String, f64>,
}

/// A strength of an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct StrengthInterval {
    pub value: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// A part of the gap in an answer.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct GapPart {
    pub from_m: Option<f64>,
    pub to_m: Option<f64>,
    pub share: Option<f64>,
}

impl Answer {
    /// A probability of an effect; 0 where nothing is said of it.
    pub fn probability(&self, effect: &str) -> f64 {
        self.find(effect).map_or(0.0, Named::chance)
    }

    pub fn find(&self, effect: &str) -> Option<&Named> {
        self.effects.iter().find(|e| e.name == effect)
    }
}

impl Named {
    pub fn chance(&self) -> f64 {
        self.probability.filter(|p| p.is_finite()).map_or(0.0, |p| p.clamp(0.0, 1.0))
    }
}
