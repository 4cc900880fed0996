//! The tuned constants of a diagnosis in one place. Each has a unit, what it does, and its origin: a study that it was
//! measured in, a source that it is derived from, or a reason for which it was chosen. Numbers that follow from
//! mathematics, sizes of arrays and facts of a format stand where they are used.
//!
//! `docs/gap-settings.md` is made from [`Settings::table`].

/// A struct of constants, each written once: what it does, its name, kind, value, unit and origin.
macro_rules! settings {
    (
        $(#[doc = $group:literal])+
        $struct:ident as $path:literal {
            $(
                $(#[doc = $about:literal])+
                $field:ident: $kind:ty = $value:expr, $unit:literal, $origin:ident($why:literal);
            )+
        }
    ) => {
        $(#[doc = $group])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $struct {
            $(
                $(#[doc = $about])+
                #[doc = concat!(" Unit: ", $unit, ".")]
                pub $field: $kind,
            )+
        }

        impl Default for $struct {
            fn default() -> Self {
                $struct { $($field: $value),+ }
            }
        }

        impl $struct {
            /// Each of them.
            pub(super) fn table(&self) -> Vec<$crate::gap::settings::Setting> {
                use $crate::gap::settings::{Origin, Setting, Shown};
                vec![$(Setting {
                    group: $path,
                    name: stringify!($field),
                    value: self.$field.shown(),
                    unit: $unit,
                    about: concat!($($about),+).trim(),
                    origin: Origin::$origin($why),
                }),+]
            }
        }
    };
}

mod chain;
mod outside;
mod reporting;
mod scoring;
mod search;

pub use chain::{Ensembles, ForceSlopes, Impacts};
pub use outside::{Fitting, ModelError, Noise, OutsideComparison, Processes, Windows};
pub use reporting::{Checks, Intervals, Reporting};
pub use scoring::{Likelihood, Observations, Significance};
pub use search::{GaussNewton, RandomEffects, Refitting, Relinearisation, SHARES, Screening, Selection, SensorFits};

use crate::base::number::shortest;
use std::ops::{Range, RangeInclusive};

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A study, by its command or its record.
    Measured(&'static str),
    /// An equation or a source.
    Derived(&'static str),
    /// Nothing of both: the reason.
    Chosen(&'static str),
}

impl Origin {
    /// `measured`, `derived` or `chosen`.
    pub fn name(self) -> &'static str {
        match self {
            Origin::Measured(_) => "measured",
            Origin::Derived(_) => "derived",
            Origin::Chosen(_) => "chosen",
        }
    }

    /// The study, the source or the reason.
    pub fn why(self) -> &'static str {
        let (Origin::Measured(why) | Origin::Derived(why) | Origin::Chosen(why)) = self;
        why
    }
}

/// A constant as a table has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The field of [`Settings`] that it stands in.
    pub group: &'static str,
    pub name: &'static str,
    pub value: String,
    /// SI; a dash for what has none.
    pub unit: &'static str,
    /// What it does.
    pub about: &'static str,
    pub origin: Origin,
}

/// All tuned constants of a diagnosis; the default has the values that it was tested with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    pub checks: Checks,
    pub observations: Observations,
    pub screening: Screening,
    pub relinearisation: Relinearisation,
    pub sensor_fits: SensorFits,
    pub selection: Selection,
    pub refitting: Refitting,
    pub gauss_newton: GaussNewton,
    pub random_effects: RandomEffects,
    pub likelihood: Likelihood,
    pub significance: Significance,
    pub intervals: Intervals,
    pub reporting: Reporting,
    pub chain: Chain,
    pub outside: Outside,
}

/// Of the chain of carts as a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chain {
    pub ensembles: Ensembles,
    pub impacts: Impacts,
    pub force_slopes: ForceSlopes,
}

/// Of other programs as models.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outside {
    pub windows: Windows,
    pub noise: Noise,
    pub model_error: ModelError,
    pub fitting: Fitting,
    pub comparison: OutsideComparison,
    pub processes: Processes,
}

impl Settings {
    /// All of them, in the order of the steps of a diagnosis.
    pub fn table(&self) -> Vec<Setting> {
        let Settings { checks, observations, screening, relinearisation, sensor_fits, selection, refitting, .. } = self;
        let Settings {
            gauss_newton,
            random_effects,
            likelihood,
            significance,
            intervals,
            reporting,
            chain,
            outside,
            ..
        } = self;
        [
            checks.table(),
            observations.table(),
            screening.table(),
            relinearisation.table(),
            sensor_fits.table(),
            selection.table(),
            refitting.table(),
            gauss_newton.table(),
            random_effects.table(),
            likelihood.table(),
            significance.table(),
            intervals.table(),
            reporting.table(),
            chain.ensembles.table(),
            chain.impacts.table(),
            chain.force_slopes.table(),
            outside.windows.table(),
            outside.noise.table(),
            outside.model_error.table(),
            outside.fitting.table(),
            outside.comparison.table(),
            outside.processes.table(),
        ]
        .concat()
    }
}

/// A value in words.
trait Shown {
    fn shown(&self) -> String;
}

impl Shown for f64 {
    fn shown(&self) -> String {
        shortest(*self)
    }
}

impl Shown for usize {
    fn shown(&self) -> String {
        self.to_string()
    }
}

impl Shown for Range<f64> {
    fn shown(&self) -> String {
        format!("{} to {}", shortest(self.start), shortest(self.end))
    }
}

impl Shown for RangeInclusive<f64> {
    fn shown(&self) -> String {
        format!("{} to {}", shortest(*self.start()), shortest(*self.end()))
    }
}

impl<const N: usize> Shown for [f64; N] {
    fn shown(&self) -> String {
        self.map(shortest).join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn each_constant_has_a_name_of_its_own_a_unit_a_purpose_and_an_origin() {
        let table = Settings::default().table();
        let names: BTreeSet<(&str, &str)> = table.iter().map(|s| (s.group, s.name)).collect();
        assert_eq!(names.len(), table.len());
        for Setting { group, name, value, unit, about, origin } in &table {
            let told = [value, *unit, *about, origin.why()].iter().all(|text| !text.trim().is_empty());
            assert!(told && about.ends_with('.'), "{group}.{name}");
            assert!(!about.contains('|') && !origin.why().contains('|'), "{group}.{name} breaks the table");
        }
    }
}
