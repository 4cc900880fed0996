//! What a layout takes in closed form, beside what it is asked to.

use super::Compiled;
use crate::base::number::fixed;
use crate::capacity::{Bounds, limit_words, most_words};

/// The capacity of a layout in closed form.
#[derive(Clone, Debug, PartialEq)]
pub struct Takes {
    /// Items an hour.
    pub most: f64,
    /// `at most 9216 items an hour`
    pub words: String,
    /// What limits it: `carriers behind induction west, of which 9216 pass an hour`.
    pub limit: String,
    /// What the layout requires, items an hour.
    pub required: Option<f64>,
}

impl Takes {
    /// Whether that is as much as is required.
    pub fn is_enough(&self) -> bool {
        self.required.is_none_or(|required| self.most >= required)
    }
}

impl Compiled {
    /// `None` where the layout is no sorter, or where nothing limits what it takes.
    pub fn takes(&self) -> Option<Takes> {
        let sorter = self.sorter()?;
        let bounds = Bounds::of(&sorter)?;
        let own = bounds.own();
        let most = own.throughput;
        most.is_finite().then(|| Takes {
            most,
            words: format!("{} {} items an hour", most_words(&sorter, own), fixed(most, 0)),
            limit: limit_words(&sorter, own.limit),
            required: self.layout.capacity.required.as_ref().map(|required| required.least.value),
        })
    }

    /// Price of track, equipment and conveyors, EUR: what `optimise cost` counts. Chain, motors, sensors and supports are not
    /// in it.
    pub fn price_with_equipment(&self) -> f64 {
        ((self.bill.price + self.placement.price()) * 100.0).round() / 100.0
    }
}
