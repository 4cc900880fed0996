//! What a metre of track takes beside its pieces, where the price of all that is ordered is minimised.

use super::{Article, Goal, Layout, Objective};
use crate::base::trig;
use crate::geometry::Track;

/// Of chords in an arc, times the square of their length over its radius: what the expansion for small angles lacks,
/// at least up to chords as long as the diameter.
const ABOVE: f64 = 0.3;
/// The pitch at which a chain closes is up to half a cart in all longer than its carts, and differs a little from phase
/// to phase.
const MARGIN: f64 = 1.1;

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

    /// What `chain closes` lets a whole number of carts leave over, or else half a pitch, m.
    pub fn most_left_over(&self) -> f64 {
        self.chain.closes_within.map_or(0.5 * self.cart.length, |within| within.value)
    }

    /// By how much a chain of chords is shorter than a track with these vertices, turning as they do, m, at most.
    ///
    /// Of a curvature κ a chord of length c cuts ½ ∬ κ(s) κ(t) K(|s − t|) ds dt, where ∫ K = c²/12: no more than
    /// c²/24 times the largest curvature for each radian that the track turns (expansion of arc − chord for small
    /// angles; what it lacks is in [`ABOVE`]).
    pub fn most_cut_by_chords(&self) -> f64 {
        let corners = self.corners();
        let turns: Vec<f64> = Track::new(&corners).fillets.iter().map(|fillet| fillet.turn).collect();
        let (around, most) = (turns.iter().sum::<f64>(), self.turns.value.high);
        let back = turns.iter().filter(|turn| **turn * around < 0.0).count() as f64;
        let level = (around.abs() + 2.0 * back * most).min(turns.len() as f64 * most);
        // Four bends to a climb.
        let bends = if self.levels.is_empty() { 0.0 } else { 4.0 * turns.len() as f64 * trig::atan(self.steepest()) };
        (level + bends) * self.cut_by_chords()
    }

    /// The same for each metre of any track, as a share of it.
    pub fn share_cut_by_chords(&self) -> f64 {
        self.largest_curvature() * self.cut_by_chords()
    }

    /// The same for a radian, m.
    fn cut_by_chords(&self) -> f64 {
        let (cart, curvature) = (self.cart.length, self.largest_curvature());
        let beyond = cart * curvature;
        MARGIN * (1.0 + ABOVE * beyond * beyond) * cart * cart * curvature / 24.0
    }

    /// 1/m, of curves in plan and of climbs.
    fn largest_curvature(&self) -> f64 {
        let least = |radii: &mut dyn Iterator<Item = f64>| radii.fold(f64::INFINITY, f64::min);
        let plan = least(&mut self.vertices.iter().map(|v| v.radius.value).chain([self.radii.value.low]));
        let stock = self.catalog.vertical.iter().flat_map(|stock| stock.radii.iter().copied());
        let climb = least(&mut stock.chain(self.ramps.iter().filter_map(|ramp| ramp.radius)));
        let climb = if self.levels.is_empty() { 0.0 } else { 1.0 / climb.max(1e-3) };
        let plan = 1.0 / plan.max(1e-3);
        (plan * plan + climb * climb).sqrt()
    }

    /// The largest slope that a climb may have.
    fn steepest(&self) -> f64 {
        let stock =
            [self.catalog.vertical.as_ref().map(|v| v.steepest), self.catalog.spiral.as_ref().map(|s| s.steepest)];
        stock.into_iter().flatten().fold(0.0, f64::max)
    }
}

fn ordered(article: &Article) -> f64 {
    article.price.map_or(0.0, |price| (price * 100.0).round() / 100.0)
}
