//! `bom.json` and `bom.csv`: the bill of elements.

use super::OwnNumbers;
use crate::base::json;
use crate::base::number::{fixed, normal, trimmed};
use crate::compiled::Compiled;
use crate::compiled::order::{self, OrderLine};
use crate::elements::{BillLine, Part};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The bill of elements of a layout: what has to be ordered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "lss bill of elements")]
#[serde(deny_unknown_fields)]
pub struct Bom {
    /// The layout's name.
    pub layout: String,
    /// The catalogue that the articles are from.
    pub catalog: String,
    /// Straights by length, then curves, vertical curves and spirals by radius and angle.
    pub articles: Vec<Article>,
    /// Number of pieces in all.
    pub count: usize,
    /// Price in all, EUR.
    pub price_eur: f64,
    /// Mass in all, kg.
    pub mass_kg: f64,
    /// Price of the pieces and of everything `beside` that has one, EUR.
    #[serde(default)]
    pub total_eur: f64,
    /// What is ordered beside the track: carts, joints, motors, sensors, supports, stations. Of the sums above only in
    /// `total_eur`.
    #[serde(default)]
    pub beside: Vec<Beside>,
}

/// A component that is ordered beside the track.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Beside {
    /// `chain`, `drive`, `sensors`, `supports` or `stations`.
    pub group: String,
    /// Article number; absent where its declaration has none.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub article: Option<String>,
    /// Own article number, of `--articles`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub own_number: Option<String>,
    /// In words.
    pub description: String,
    /// Number of pieces.
    pub count: usize,
    /// Price of a piece, EUR; absent where its declaration has none, as the next one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub unit_price_eur: Option<f64>,
    /// Price of all pieces, EUR.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub price_eur: Option<f64>,
    /// Mass of a piece, kg; absent where its declaration has none, as the next one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub unit_mass_kg: Option<f64>,
    /// Mass of all pieces, kg.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub mass_kg: Option<f64>,
}

/// One article.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Article {
    /// Article number; a piece that the catalogue lacks begins with `X-`.
    pub article: String,
    /// Own article number, of `--articles`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub own_number: Option<String>,
    /// In words.
    pub description: String,
    /// Length of the centre line of a piece, m.
    pub length_m: f64,
    /// Whether the piece is cut to its length; absent for others than straights.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub cut: Option<bool>,
    /// Radius of the centre line, m; absent for straights.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub radius_m: Option<f64>,
    /// Turn, deg; absent for straights. Positive for curves: a left curve turned end for end is a right one. A vertical
    /// curve's is the change of its slope angle, positive for a sag and negative for a crest; a spiral's is positive
    /// where it rises to the left.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub turn_deg: Option<f64>,
    /// Rise of a spiral, m; absent for the others.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub rise_m: Option<f64>,
    /// Number of pieces.
    pub count: usize,
    /// Price of a piece, EUR.
    pub unit_price_eur: f64,
    /// Price of all pieces, EUR.
    pub price_eur: f64,
    /// Mass of a piece, kg.
    pub unit_mass_kg: f64,
    /// Mass of all pieces, kg.
    pub mass_kg: f64,
    /// Whether the catalogue has it. What it lacks is priced by its rates, as an estimate.
    pub in_catalog: bool,
}

impl Bom {
    pub fn new(compiled: &Compiled, own: &OwnNumbers) -> Self {
        let bill = &compiled.bill;
        Bom {
            layout: compiled.layout.name.clone(),
            catalog: compiled.layout.catalog.name.clone(),
            articles: bill.lines.iter().map(|line| Article::new(line, own)).collect(),
            count: bill.count,
            price_eur: normal(bill.price),
            mass_kg: normal(bill.mass),
            total_eur: normal(order::total(compiled).all),
            beside: order::lines(compiled).iter().map(|line| Beside::new(line, own)).collect(),
        }
    }
}

impl Beside {
    fn new(line: &OrderLine, own: &OwnNumbers) -> Self {
        Beside {
            group: line.group.name().to_owned(),
            article: line.article.clone(),
            own_number: line.article.as_deref().and_then(|article| own.of(article)).map(str::to_owned),
            description: line.description.clone(),
            count: line.count,
            unit_price_eur: line.unit_price,
            price_eur: line.price(),
            unit_mass_kg: line.unit_mass,
            mass_kg: line.mass(),
        }
    }
}

impl Article {
    fn new(line: &BillLine, own: &OwnNumbers) -> Self {
        let micrometre = |length: f64| (length * 1e6).round() / 1e6;
        let degrees = |turn: f64| (turn.to_degrees() * 1e4).round() / 1e4;
        let (cut, radius_m, turn_deg, rise_m) = match line.part {
            Part::Straight { cut, .. } => (Some(cut), None, None, None),
            Part::Curve { radius, turn } | Part::Vertical { radius, turn } => {
                (None, Some(micrometre(radius)), Some(degrees(turn)), None)
            }
            Part::Spiral { radius, turn, rise } => {
                (None, Some(micrometre(radius)), Some(degrees(turn)), Some(micrometre(rise)))
            }
        };
        Article {
            article: line.article.clone(),
            own_number: own.of(&line.article).map(str::to_owned),
            description: line.description.clone(),
            length_m: micrometre(line.part.length()),
            cut,
            radius_m,
            turn_deg,
            rise_m,
            count: line.count,
            unit_price_eur: line.unit_price,
            price_eur: line.price,
            unit_mass_kg: line.unit_mass,
            mass_kg: line.mass,
            in_catalog: line.in_catalog,
        }
    }
}

/// `bom.json`
pub fn json(compiled: &Compiled, own: &OwnNumbers) -> Vec<u8> {
    json::to_json(&Bom::new(compiled, own))
}

/// `bom.csv`: a row an article of the track, with a last column of own numbers where there are any, without a row of totals, so that a spreadsheet's own sums are right.
pub fn csv(compiled: &Compiled, own: &OwnNumbers) -> Vec<u8> {
    let header = [
        "article",
        "description",
        "count",
        "length_m",
        "unit_price_eur",
        "price_eur",
        "unit_mass_kg",
        "mass_kg",
        "in_catalog",
    ];
    let mut writer = csv::Writer::from_writer(Vec::new());
    let rows = compiled.bill.lines.iter().map(|line| {
        let own = own.of(&line.article).unwrap_or_default().to_owned();
        let row = [
            line.article.clone(),
            line.description.clone(),
            line.count.to_string(),
            trimmed(line.part.length(), 6),
            fixed(line.unit_price, 2),
            fixed(line.price, 2),
            fixed(line.unit_mass, 3),
            fixed(line.mass, 3),
            line.in_catalog.to_string(),
        ];
        (row, own)
    });
    for (row, number) in std::iter::once((header.map(str::to_owned), "own_number".to_owned())).chain(rows) {
        let row = row.into_iter().chain((!own.is_empty()).then_some(number));
        // Rows are equally long and a vector takes every byte: nothing can fail.
        let written = writer.write_record(row);
        debug_assert!(written.is_ok(), "{written:?}");
    }
    writer.into_inner().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use crate::compiled::fixture::compile;
    use crate::emit::OwnNumbers;
    use crate::model::fixture;

    #[test]
    fn a_table_for_a_spreadsheet() {
        let text = String::from_utf8(super::csv(&compile(fixture::rectangle(20.0, 10.5, 4.0)), &OwnNumbers::default()))
            .unwrap();
        insta::assert_snapshot!(text, @r#"
        article,description,count,length_m,unit_price_eur,price_eur,unit_mass_kg,mass_kg,in_catalog
        ST-2500,straight cut to 2500 mm,2,2.5,315.00,630.00,52.000,104.000,true
        ST-3000,"straight, 3000 mm",8,3,340.00,2720.00,62.000,496.000,true
        CU-4000-45,"curve, radius 4000 mm, 45°",8,3.141593,688.32,5506.56,81.540,652.320,true
        "#);
    }

    #[test]
    fn a_bill_for_machines() {
        let text = String::from_utf8(super::json(&compile(fixture::rectangle(20.0, 8.0, 4.0)), &OwnNumbers::default()))
            .unwrap();
        insta::assert_snapshot!(text);
    }
}
