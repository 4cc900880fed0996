//! What a metre of track takes beside its pieces, where the price of all that is ordered is minimised.

use super::{Article, Goal, Layout, Objective};

impl Layout {
    /// Carts and joints for one pitch, EUR, each rounded to the cent as it is ordered.
    pub fn price_of_a_pitch(&self) -> f64 {
        ordered(&self.cart.article) + ordered(&self.cart.joint.article)
    }

    /// One support, EUR; 0 where the layout has none.
    pub fn price_of_a_support(&self) -> f64 {
        self.equipment.supports.map_or(0.0, |_| ordered(&self.catalog.support))
    }

    /// Chain and supports for a metre of track, EUR/m.
    pub fn price_of_a_metre(&self) -> f64 {
        let supports = self.equipment.supports.map_or(0.0, |every| self.price_of_a_support() / every.value);
        self.price_of_a_pitch() / self.cart.length + supports
    }

    /// Writes the terms of `optimise total_price`: the cost of track, equipment and conveyors, and each metre at what it
    /// takes of chain and supports. What else is ordered is the same for every track. To be called again with another
    /// cart.
    pub fn count_total_price(&mut self) {
        if self.objective.total_price {
            let metre = self.price_of_a_metre();
            let terms = std::iter::once((1.0, Goal::Cost)).chain((metre > 0.0).then_some((metre, Goal::Length)));
            self.objective = Objective { terms: terms.collect(), ..self.objective.clone() };
        }
    }

    /// How much less than its share by length another track's chain and supports may cost, EUR: a chain has a whole
    /// number of carts, within what `chain closes` allows or else half a pitch, and supports are counted up.
    pub fn rounding_of_total_price(&self) -> f64 {
        let closes = self.chain.closes_within.map_or(0.5 * self.cart.length, |within| within.value);
        self.price_of_a_pitch() / self.cart.length * closes
    }
}

fn ordered(article: &Article) -> f64 {
    article.price.map_or(0.0, |price| (price * 100.0).round() / 100.0)
}
