//! `pareto.json` and its table: layouts that no other one found beats in two or three measures.

use crate::base::json;
use crate::base::number::{fixed, normal};
use crate::base::words::list;
use crate::chain_input::Track;
use crate::choose::{self, Measure};
use crate::compiled::Compiled;
use crate::geometry::Point;
use crate::model::{Layout, objective_text};
use crate::solve::{self, Counted};
use schemars::JsonSchema;
use serde::Serialize;

/// Layouts that no other one found beats, by the first measure, the best first.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(title = "lss pareto")]
pub struct Pareto {
    pub layout: String,
    pub measures: Vec<Measure>,
    /// The best value of each measure, and what is proven of it.
    pub ends: Vec<End>,
    /// Whether one layout is the best that was found in all measures.
    pub same_optimum: bool,
    pub layouts: Vec<Traded>,
    /// Tracks that were found, and layouts on them that do what is required.
    pub tracks: usize,
    pub candidates: usize,
    /// Whether the time limit ended the search of some.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub cut: bool,
    /// Outlines of the building, or of nothing, and of the obstacles, m: for the picture.
    #[serde(skip)]
    pub hall: Vec<Vec<Point>>,
}

/// How good the best layout in a measure is.
#[derive(Debug, Serialize, JsonSchema)]
pub struct End {
    pub measure: Measure,
    /// In the measure's unit: EUR, m², items an hour, mm, kWh a year, or m.
    pub value: f64,
    /// No layout on the grid has less; absent where nothing is proven of this measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower_bound: Option<f64>,
    /// No layout with the curves of the best one in their order has less, to about 1 %, whatever straights lie between them:
    /// of smoothness, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower_bound_same_curves: Option<f64>,
    pub proven: bool,
}

/// One of them.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Traded {
    /// In the order of `measures`, in their units.
    pub values: Vec<f64>,
    /// Of the plan.
    pub length_m: f64,
    /// Of its bill of elements, bought as cheaply as can be.
    pub price_eur: f64,
    pub element_count: usize,
    /// What its track is the best of, as far as is known, as a layout says it: `optimise cost + 120 * length`.
    pub objective: String,
    /// Whose radii it keeps, and whose vertices it began with, instead of those that are written: `shortest`, `cheapest`
    /// or `cheapest in all`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radii_of: Option<&'static str>,
    /// What a metre counted beside the price when this layout was sought; absent where price did not count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eur_per_metre: Option<f64>,
    /// Its components, where the layout leaves some open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<String>,
    /// The lines of a layout that say them, in the place of what it leaves open.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<String>,
    /// Whether it is proven that no layout on the grid is better for that objective.
    pub proven: bool,
    /// How far from it the best may be, as a share of what was minimised; absent where nothing is proven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
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

impl Traded {
    fn new(traded: &choose::pareto::Traded) -> Self {
        let (compiled, objective) = (&traded.compiled, &traded.objective);
        let vertex = |(corner, vertex): (&crate::geometry::Corner, &crate::model::Vertex)| TradedVertex {
            name: vertex.name.clone(),
            x_m: normal(corner.point.x),
            y_m: normal(corner.point.y),
            radius_m: normal(corner.radius),
        };
        let certificate = traded.certificate.as_ref();
        let bound = |length: bool| {
            certificate.filter(|c| (c.counted == Counted::Length) == length).map(|c| normal(c.lower_bound))
        };
        Traded {
            values: traded.values.iter().copied().map(normal).collect(),
            length_m: normal(compiled.track.length),
            price_eur: normal(compiled.bill.price),
            element_count: compiled.bill.count,
            objective: objective_text(objective),
            radii_of: traded.radii.map(|end| match end {
                solve::End::Length => "shortest",
                solve::End::TotalPrice => "cheapest in all",
                solve::End::Cost | solve::End::PolygonAction => "cheapest",
            }),
            eur_per_metre: objective.metre().map(normal),
            choice: traded.choice.clone(),
            lines: traded.lines.clone(),
            proven: certificate.is_some_and(|c| c.proven),
            gap: certificate.map(|c| normal(c.gap)),
            lower_bound_m: bound(true),
            lower_bound_eur: bound(false),
            outline: outline(compiled),
            vertices: compiled.track.corners.iter().zip(&compiled.layout.vertices).map(vertex).collect(),
        }
    }

    /// What its track is the best of, and how good it is: `proven`, `to 0.3 %`, or that nothing is.
    pub fn words(&self) -> (String, String) {
        let how = match (self.proven, self.gap) {
            (true, _) => "proven".to_owned(),
            (false, Some(gap)) => format!("to {} %", fixed(100.0 * gap, 3)),
            (false, None) => "best found".to_owned(),
        };
        let objective = self.objective.strip_prefix("optimise ").unwrap_or(&self.objective);
        let radii = match self.radii_of {
            Some(whose) => format!(", radii of the {whose}"),
            None if objective.starts_with("polygon_action within") => ", radii as written".to_owned(),
            None => String::new(),
        };
        (format!("{objective}{radii}"), how)
    }
}

impl End {
    fn new(measure: Measure, best: &choose::pareto::Best) -> Self {
        // A bound of the price holds before it is rounded to the cent.
        let proven = best.proven || best.bound.is_some_and(|bound| best.value - bound <= measure.step());
        End {
            measure,
            value: normal(best.value),
            lower_bound: best.bound.map(normal),
            lower_bound_same_curves: best.same_curves.map(normal),
            proven,
        }
    }

    /// What is known of it: `length 165.016 m, proven`.
    pub fn words(&self) -> String {
        let shown = |value: f64| Pareto::shown(self.measure, value);
        let how = match (self.proven, self.lower_bound, self.lower_bound_same_curves) {
            (true, ..) => "proven".to_owned(),
            (false, Some(bound), _) => format!("no layout has less than {}", shown(bound)),
            (false, None, Some(bound)) => {
                format!("the best that was found; with the same curves none has less than about {}", shown(bound))
            }
            (false, None, None) => "the best that was found".to_owned(),
        };
        format!("{} {}, {how}", self.measure.words().0, shown(self.value))
    }
}

impl Pareto {
    /// What was traded of a layout.
    pub fn new(layout: &Layout, found: &choose::Pareto) -> Self {
        let building = layout.building.iter().map(|b| b.polygon.points().to_vec()).next().unwrap_or_default();
        let obstacles = layout.obstacles.iter().map(|o| o.polygon.points().to_vec());
        Pareto {
            hall: std::iter::once(building).chain(obstacles).collect(),
            layout: layout.name.clone(),
            ends: found.measures.iter().zip(&found.ends).map(|(m, best)| End::new(*m, best)).collect(),
            measures: found.measures.clone(),
            same_optimum: found.layouts.len() == 1,
            layouts: found.layouts.iter().map(Traded::new).collect(),
            cut: found.cut,
            tracks: found.tracks,
            candidates: found.candidates,
        }
    }

    /// `pareto.json`
    pub fn file(&self) -> (String, Vec<u8>) {
        ("pareto.json".to_owned(), json::to_json(self))
    }

    /// `length against cost`
    pub fn title(&self) -> String {
        let names: Vec<&str> = self.measures.iter().map(|m| m.words().0).collect();
        match names[..] {
            [a, b] => format!("{a} against {b}"),
            _ => list(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>(), "and"),
        }
    }

    /// A value as it is shown: `165.01612 m`.
    pub fn shown(measure: Measure, value: f64) -> String {
        let (_, unit, decimals) = measure.words();
        // Lengths differ by less than is otherwise shown of them.
        let decimals = if measure == Measure::Length { 5 } else { decimals };
        format!("{} {unit}", fixed(value, decimals))
    }

    /// The table for people.
    pub fn text(&self) -> String {
        let mut out = format!("{}: {}\n", self.layout, self.title());
        if self.layouts.is_empty() {
            return out + "  no layout meets the constraints\n";
        }
        let heads: Vec<&str> = self.measures.iter().map(|m| m.words().0).collect();
        let row = |traded: &Traded| -> Vec<String> {
            self.measures.iter().zip(&traded.values).map(|(m, value)| Pareto::shown(*m, *value)).collect()
        };
        let rows: Vec<Vec<String>> = self.layouts.iter().map(row).collect();
        let wide = |i: usize| rows.iter().map(|row| row[i].chars().count()).chain([heads[i].len()]).max().unwrap_or(0);
        let cells = |cells: Vec<String>| {
            let padded = |(i, cell): (usize, String)| format!("  {}{cell}", " ".repeat(wide(i) - cell.chars().count()));
            cells.into_iter().enumerate().map(padded).collect::<String>()
        };
        let objective = self.layouts.iter().map(|t| t.words().0.chars().count()).max().unwrap_or(0).max(8);
        out += &format!("{}  optimise\n", cells(heads.iter().map(|head| (*head).to_owned()).collect()));
        for (traded, row) in self.layouts.iter().zip(rows.clone()) {
            let (what, how) = traded.words();
            let choice = traded.choice.as_ref().map_or_else(String::new, |choice| format!("  {choice}"));
            out += &format!("{}  {what:<objective$}  {how}{choice}\n", cells(row));
        }
        for end in &self.ends {
            out += &format!("  best {}\n", end.words());
        }
        if self.layouts.iter().any(|traded| traded.choice.is_some()) {
            out += "  components are chosen in closed form; `lss choose` checks a choice in simulations, too\n";
        }
        if self.cut {
            out += "  cut: time; these are the layouts so far, and more time may find better ones\n";
        }
        if self.same_optimum {
            out += "  one layout is the best found in all of these: there is nothing to trade\n";
        }
        out
    }
}
