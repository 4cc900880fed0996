//! `pareto.json` and its table: length against cost.

use crate::base::json;
use crate::base::number::{fixed, normal};
use crate::chain_input::Track;
use crate::compiled::Compiled;
use crate::geometry::Point;
use crate::model::Layout;
use crate::solve::{Counted, Trade, objective};
use schemars::JsonSchema;
use serde::Serialize;

/// Layouts that no other one found beats in length and cost, from the shortest to the cheapest.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(title = "lss pareto")]
pub struct Pareto {
    pub layout: String,
    /// Whether one layout is both the shortest and the cheapest that was found.
    pub same_optimum: bool,
    pub layouts: Vec<Traded>,
    /// Outlines of the building, or of nothing, and of the obstacles, m: for the picture.
    #[serde(skip)]
    pub hall: Vec<Vec<Point>>,
}

/// One of them.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Traded {
    /// Of the plan.
    pub length_m: f64,
    /// Of its bill of elements, bought as cheaply as can be.
    pub price_eur: f64,
    pub element_count: usize,
    /// What a metre counted beside the price when this layout was sought; absent where only length did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eur_per_metre: Option<f64>,
    /// Whether it is proven that no layout on the grid is better then.
    pub proven: bool,
    /// How far from it the best may be, as a share of what was minimised.
    pub gap: f64,
    /// Bound of what was minimised: length, or price and what metres counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower_bound_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower_bound_eur: Option<f64>,
    pub vertices: Vec<TradedVertex>,
    /// Points of the centre line, m: for the picture.
    #[serde(skip)]
    pub outline: Vec<Point>,
}

/// Where a vertex is.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TradedVertex {
    pub name: String,
    pub x_m: f64,
    pub y_m: f64,
    pub radius_m: f64,
}

/// The centre line as points that its curves are seen by.
fn outline(compiled: &Compiled) -> Vec<Point> {
    const POINTS: usize = 600;
    let line = Track::new(compiled).centre_line();
    let at = |k: usize| line.at(line.length * k as f64 / POINTS as f64).position;
    (0..POINTS).map(at).map(|p| Point::new(p.x, p.y)).collect()
}

impl Pareto {
    /// What was traded of a layout.
    pub fn new(layout: &Layout, trades: &[Trade]) -> Self {
        let traded = |trade: &Trade| {
            let mut priced = layout.clone();
            priced.objective = objective(layout, Some(0.0));
            let compiled = Compiled::new(priced, trade.stages.clone());
            let vertex = |(corner, vertex): (&crate::geometry::Corner, &crate::model::Vertex)| TradedVertex {
                name: vertex.name.clone(),
                x_m: normal(corner.point.x),
                y_m: normal(corner.point.y),
                radius_m: normal(corner.radius),
            };
            let certificate = trade.certificate.as_ref();
            let bound = |length: bool| {
                certificate.filter(|c| (c.counted == Counted::Length) == length).map(|c| normal(c.lower_bound))
            };
            Traded {
                length_m: normal(trade.length),
                price_eur: normal(compiled.bill.price),
                element_count: compiled.bill.count,
                eur_per_metre: trade.metre.map(normal),
                proven: certificate.is_some_and(|c| c.proven),
                gap: certificate.map_or(1.0, |c| normal(c.gap)),
                lower_bound_m: bound(true),
                lower_bound_eur: bound(false),
                outline: outline(&compiled),
                vertices: compiled.track.corners.iter().zip(&layout.vertices).map(vertex).collect(),
            }
        };
        let building = layout.building.iter().map(|b| b.polygon.points().to_vec()).next().unwrap_or_default();
        let obstacles = layout.obstacles.iter().map(|o| o.polygon.points().to_vec());
        Pareto {
            hall: std::iter::once(building).chain(obstacles).collect(),
            layout: layout.name.clone(),
            same_optimum: trades.len() == 1,
            layouts: trades.iter().map(traded).collect(),
        }
    }

    /// `pareto.json`
    pub fn file(&self) -> (String, Vec<u8>) {
        ("pareto.json".to_owned(), json::to_json(self))
    }

    /// The table for people.
    pub fn text(&self) -> String {
        let mut out = format!("{}: length against cost\n", self.layout);
        if self.layouts.is_empty() {
            return out + "  no layout meets the constraints\n";
        }
        out += &format!("  {:>12}  {:>13}  {:>16}  best then\n", "length", "price", "a metre counts");
        for traded in &self.layouts {
            let counts = traded.eur_per_metre.map_or("all".to_owned(), |metre| format!("{} EUR", fixed(metre, 2)));
            let how = match traded.proven {
                true => "proven".to_owned(),
                false => format!("to {} %", fixed(100.0 * traded.gap, 3)),
            };
            let (length, price) =
                (format!("{} m", fixed(traded.length_m, 5)), format!("{} EUR", fixed(traded.price_eur, 2)));
            out += &format!("  {length:>12}  {price:>13}  {counts:>16}  {how}\n");
        }
        if self.same_optimum {
            out += "  the shortest layout is the cheapest one found: there is nothing to trade\n";
        }
        out
    }
}
