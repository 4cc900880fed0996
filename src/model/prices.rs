//! What a catalogue's stocks cost.

use super::Catalog;

impl Catalog {
    /// What a metre of straight costs at least, EUR/m: its metre, and its share of the longest piece there is.
    pub fn least_of_a_metre(&self) -> f64 {
        let stock = &self.straight;
        let longest = stock.stock.iter().copied().chain(stock.cut.map(|c| c.high)).fold(0.0, f64::max);
        stock.price.per_metre + if longest > 0.0 { stock.price.per_piece / longest } else { 0.0 }
    }

    /// Stocks that cost nothing: `straight`, `curve`.
    pub fn unpriced(&self) -> impl Iterator<Item = &'static str> {
        let curve = self.curve.price;
        let prices = [("straight", self.least_of_a_metre()), ("curve", curve.per_metre + curve.per_piece)];
        prices.into_iter().filter_map(|(stock, price)| (price <= 0.0).then_some(stock))
    }
}
