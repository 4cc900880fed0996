//! The curves of a lap: channels along the track, spectra, orders, loads of supports.

use super::pitch;
use crate::chain_input::Simulation;
use crate::report::lap_track::LapTrack;
use crate::report::plot::{Axis, Curve, Layer, LayerOf, Mark, Plot, Replay, Rounded, cells};
use crate::signal::order::order_spectrum;
use crate::signal::position::Position;
use crate::signal::spectrum::{Spectrum, welch};
use crate::signal::{Channel, Run, SupportLoad};
use std::collections::BTreeSet;

/// Cells along the track in which samples are gathered.
const CELLS: usize = 1000;

/// Samples a spectrum's segment: 0.24 Hz a line at 500 Hz.
pub const SEGMENT: usize = 2048;

/// Frequencies that are shown, Hz.
const FROM_HZ: f64 = 0.2;
const TO_HZ: f64 = 120.0;

/// Orders shown.
const ORDERS: f64 = 10.0;

/// Knots of the travelled distance: between edges of the trigger it is straight in time.
const KNOTS: usize = 400;

/// A channel over arc length: least, largest and mean in each cell.
pub fn along(track: &LapTrack, stations: &[f64], channel: Channel, samples: &[f64]) -> Plot {
    let lap = track.line.length;
    let found = cells(stations, samples, lap, CELLS);
    let mut plot = Plot::new(along_id(channel), Axis::Track, channel.unit(), Rounded::to(found.x, 2));
    plot.curves.push(Curve::band("least to largest", "fill", found.low, found.high));
    plot.curves.push(Curve::line("mean", "trace", found.mean));
    plot
}

/// What the plan is coloured by: the cells of [`along`].
pub fn layer(channel: Channel) -> Layer {
    Layer {
        name: channel.name().to_owned(),
        label: capital(channel.label()),
        unit: channel.unit().to_owned(),
        of: LayerOf::Plot(along_id(channel)),
    }
}

fn along_id(channel: Channel) -> String {
    format!("along-{}", channel.name())
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Root of the power spectral density on logarithmic axes.
pub fn spectrum(simulation: &Simulation, run: &Run, channel: Channel, samples: &[f64]) -> Plot {
    let found = welch(samples, run.rate(), SEGMENT);
    // Far below the largest is only noise of rounding.
    let largest = found.points().skip(1).map(|p| p.1).fold(0.0, f64::max);
    let shown = |(f, p): &(f64, f64)| (FROM_HZ..=TO_HZ).contains(f) && *p > 1e-12 * largest;
    let (x, y) = found.points().filter(shown).map(|(f, p)| (f, p.sqrt())).unzip();
    let mut plot = Plot::new(format!("spectrum-{}", channel.name()), Axis::Frequency, "N/√Hz", Rounded::to(x, 3));
    plot.logarithmic = true;
    plot.curves.push(Curve { values: crate::report::plot::relative(y), ..Curve::line("density", "trace", Vec::new()) });
    plot.marks = marks(simulation);
    plot
}

/// Amplitudes over cycles a cart pitch.
pub fn orders(simulation: &Simulation, place: &Position, channel: Channel, samples: &[f64]) -> Plot {
    let found: Spectrum = order_spectrum(&place.s, samples, pitch(simulation));
    let (x, y) = found.points().skip(1).take_while(|(order, _)| *order <= ORDERS).unzip();
    let mut plot = Plot::new(format!("orders-{}", channel.name()), Axis::Order, "N", Rounded::to(x, 4));
    plot.curves.push(Curve::line("amplitude", "trace", y));
    plot
}

/// Frequencies worth a line in a spectrum.
fn marks(simulation: &Simulation) -> Vec<Mark> {
    let chain = &simulation.chain;
    let pitch = pitch(simulation);
    let passing = chain.speed_m_s / pitch;
    let wheel = chain.speed_m_s / (std::f64::consts::TAU * simulation.running_wheel.radius_m);
    let wave = pitch * (simulation.joint.axial.stiffness_n_per_m_n / simulation.cart.mass_kg).sqrt();
    let mark = |name: &str, x: f64, dotted| Mark { x: (1e4 * x).round() / 1e4, name: name.to_owned(), dotted };
    let mut marks = vec![mark("cart", passing, false), mark("2×", 2.0 * passing, false), mark("wheel", wheel, true)];
    if simulation.joint.axial.exponent == 1.0 {
        marks.push(mark("ring", wave / chain.track_length_m, true));
    }
    marks
}

/// Least and largest load of each support in one direction.
pub fn supports(name: &str, loads: &[SupportLoad], of: impl Fn(&SupportLoad) -> (f64, f64)) -> Plot {
    let x = Rounded::to(loads.iter().map(|s| s.s).collect(), 3);
    let mut plot = Plot::new(format!("supports-{name}"), Axis::Track, "N", x);
    let (low, high) = loads.iter().map(of).unzip();
    plot.curves.push(Curve::band("least to largest", "fill", low, high));
    plot
}

/// The chain over the time of the run.
pub fn replay(simulation: &Simulation, run: &Run, place: &Position) -> Replay {
    let step = (run.time.len() / KNOTS).max(1);
    let last = run.time.len().saturating_sub(1);
    let beside = 1.0 / run.rate();
    let at_edges = place.edges.iter().flat_map(|edge| {
        let from = run.time.partition_point(|t| *t < edge - beside);
        (from..run.time.len()).take_while(move |k| run.time[*k] <= edge + beside)
    });
    let knots: BTreeSet<usize> = (0..run.time.len()).step_by(step).chain([last]).chain(at_edges).collect();
    let (time, s) = knots.iter().filter_map(|k| Some((*run.time.get(*k)?, *place.s.get(*k)?))).unzip();
    Replay {
        carts: simulation.chain.carts,
        sensor_cart: run.sidecar.sensor_cart,
        pitch_m: (1e6 * pitch(simulation)).round() / 1e6,
        time: Rounded::to(time, 3),
        s: Rounded::to(s, 3),
    }
}
