//! What a page's pictures show, as the one block of JSON that the page's script reads. Numbers are rounded to what can
//! be seen and read off, and curves have a bounded number of points, so that pages stay small.

use crate::base::number::normal;
use crate::base::trig;
use serde::{Serialize, Serializer};

/// Everything of a page.
#[derive(Default, Serialize)]
pub struct PageData {
    /// Title of the run or page, by which another page names it when it is laid over its curves.
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<Plan>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub replay: Option<Replay>,
    pub plots: Vec<Plot>,
}

/// Numbers as a page writes them: rounded to a step of a thousandth to a ten-thousandth of their range; lost ones are
/// `null`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rounded(Vec<f64>);

impl Rounded {
    /// To a thousandth of the range that they span together, or up to ten times finer.
    pub fn new(values: Vec<f64>) -> Self {
        let finite = || values.iter().copied().filter(|x| x.is_finite());
        let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        let range = if high > low { high - low } else { high.abs().max(low.abs()) };
        let decimals = if range > 0.0 && range.is_finite() { (3.0 - trig::log10(range).floor()).max(0.0) } else { 3.0 };
        Rounded::to(values, decimals.min(12.0) as i32)
    }

    /// To so many decimals.
    pub fn to(mut values: Vec<f64>, decimals: i32) -> Self {
        let parts = trig::pow(10.0, f64::from(decimals));
        values.iter_mut().for_each(|x| *x = normal((*x * parts).round() / parts));
        Rounded(values)
    }
}

impl Serialize for Rounded {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // Whole numbers without `.0`, which is a third of a short number.
        serializer.collect_seq(self.0.iter().map(|x| match *x {
            x if !x.is_finite() => Digits::Lost(None),
            x if x.fract() == 0.0 && x.abs() < 1e15 => Digits::Whole(x as i64),
            x => Digits::Broken(x),
        }))
    }
}

#[derive(Serialize)]
#[serde(untagged)]
enum Digits {
    Lost(Option<f64>),
    Whole(i64),
    Broken(f64),
}

/// Where the values of a plot belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Arc length of the track, m: plots and plan have one cursor.
    Track,
    /// s
    Time,
    /// Hz, logarithmic.
    Frequency,
    /// Hz, even.
    LinearFrequency,
    /// Cycles a cart pitch.
    Order,
    /// What the plot alone has.
    Own,
}

/// A system of axes with its curves. It is drawn into the element that [`super::place`] makes.
#[derive(Serialize)]
pub struct Plot {
    pub id: String,
    pub axis: Axis,
    /// Unit of the horizontal axis.
    pub x_unit: String,
    /// Unit of the values.
    pub unit: String,
    /// Whether values are shown on a logarithmic axis.
    pub logarithmic: bool,
    pub x: Rounded,
    pub curves: Vec<Curve>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<Mark>,
    /// Stretches behind the curves: from, to, class.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shades: Vec<Shade>,
    /// px
    pub height: u32,
}

/// Height of a plot, px.
pub const HEIGHT: u32 = 170;

impl Plot {
    /// Without curves and marks.
    pub fn new(id: impl Into<String>, axis: Axis, unit: impl Into<String>, x: Rounded) -> Self {
        let x_unit = match axis {
            Axis::Track => "m",
            Axis::Time => "s",
            Axis::Frequency | Axis::LinearFrequency => "Hz",
            Axis::Order | Axis::Own => "",
        };
        Plot {
            id: id.into(),
            axis,
            x_unit: x_unit.to_owned(),
            unit: unit.into(),
            logarithmic: false,
            x,
            curves: Vec::new(),
            marks: Vec::new(),
            shades: Vec::new(),
            height: HEIGHT,
        }
    }
}

/// A curve or a band of a plot.
#[derive(Serialize)]
pub struct Curve {
    pub name: String,
    /// A variable of the style sheet: `trace`.
    pub colour: String,
    #[serde(flatten)]
    pub values: Values,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub dashed: bool,
    /// Hidden until it is turned on.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub hidden: bool,
    /// What each dot is, told with its value.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub named: Vec<String>,
}

/// Of a line, or of the edges of a band.
#[derive(Serialize)]
#[serde(untagged)]
pub enum Values {
    Line { y: Rounded },
    Band { low: Rounded, high: Rounded },
    Dots { dots: Rounded },
}

/// A line of values of many sizes, as a logarithmic axis shows them: four significant digits each.
pub fn relative(values: Vec<f64>) -> Values {
    let digits = |x: f64| {
        if x == 0.0 || !x.is_finite() {
            return x;
        }
        let parts = trig::pow(10.0, 3.0 - trig::log10(x.abs()).floor());
        (x * parts).round() / parts
    };
    Values::Line { y: Rounded(values.into_iter().map(digits).collect()) }
}

impl Curve {
    pub fn line(name: impl Into<String>, colour: &str, y: Vec<f64>) -> Self {
        Curve {
            name: name.into(),
            colour: colour.to_owned(),
            values: Values::Line { y: Rounded::new(y) },
            dashed: false,
            hidden: false,
            named: Vec::new(),
        }
    }

    pub fn named(self, named: Vec<String>) -> Self {
        Curve { named, ..self }
    }

    pub fn dashed(self) -> Self {
        Curve { dashed: true, ..self }
    }

    pub fn hidden(self, hidden: bool) -> Self {
        Curve { hidden, ..self }
    }

    pub fn dots(name: impl Into<String>, colour: &str, y: Vec<f64>) -> Self {
        Curve { values: Values::Dots { dots: Rounded::new(y) }, ..Curve::line(name, colour, Vec::new()) }
    }

    pub fn band(name: impl Into<String>, colour: &str, low: Vec<f64>, high: Vec<f64>) -> Self {
        let values = Values::Band { low: Rounded::new(low), high: Rounded::new(high) };
        Curve { values, ..Curve::line(name, colour, Vec::new()) }
    }
}

/// A line across the plot with a name.
#[derive(Serialize)]
pub struct Mark {
    pub x: f64,
    pub name: String,
    pub dotted: bool,
}

/// A stretch of the horizontal axis in a colour of the style sheet.
#[derive(Serialize)]
pub struct Shade {
    pub from: f64,
    pub to: f64,
    pub colour: String,
}

/// The track in the hall.
#[derive(Serialize)]
pub struct Plan {
    pub lap_m: f64,
    /// Coordinates of the centre line at equal steps of arc length from 0, m; the lap closes behind the last.
    pub x: Rounded,
    pub y: Rounded,
    /// Empty where the track has no heights.
    pub z: Rounded,
    pub parts: Vec<Part>,
    /// Arc lengths where motors begin and end, m.
    pub motors: Vec<Rounded>,
    /// What the track can be coloured by.
    pub layers: Vec<Layer>,
    /// The layer that is shown first.
    pub shown: usize,
    pub spots: Vec<Spot>,
}

/// A stretch of the track with its name.
#[derive(Serialize)]
pub struct Part {
    pub from: f64,
    pub to: f64,
    pub kind: &'static str,
    pub name: String,
}

/// What the plan may be coloured by.
#[derive(Serialize)]
pub struct Layer {
    pub name: String,
    pub label: String,
    pub unit: String,
    #[serde(flatten)]
    pub of: LayerOf,
}

/// Where a layer's values come from.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LayerOf {
    /// The cells of a plot along the track, of which the reader chooses peak, largest, least or mean.
    Plot(String),
    /// Amounts, 0 being nothing, over pieces of equal length, of which the first begins at 0.
    Amounts(Rounded),
}

/// A numbered place of the track.
#[derive(Serialize)]
pub struct Spot {
    pub s: f64,
    pub name: String,
}

/// The chain over time.
#[derive(Serialize)]
pub struct Replay {
    pub carts: usize,
    /// Number of the cart with the sensors, from 1.
    pub sensor_cart: usize,
    /// Length of the centre line a cart, m.
    pub pitch_m: f64,
    /// Times, s, and arc length travelled by the front joint of the cart with the sensors, m: straight in between.
    pub time: Rounded,
    pub s: Rounded,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_to_what_can_be_seen_and_lost_ones_are_null() {
        let json = |x: Vec<f64>| serde_json::to_string(&Rounded::new(x)).expect("JSON");
        assert_eq!(json(vec![1000.0 / 3.0, 0.0, f64::NAN, -1e-9]), "[333.3,0,null,0]");
        assert_eq!(json(vec![1e-5, 3.123_456_789e-5]), "[0.00001,0.00003123]");
        assert_eq!(json(vec![5.0, 5.0]), "[5,5]");
        assert_eq!(json(Vec::new()), "[]");
    }
}
