//! `lap.html`: a simulated lap on one page, for judging it by eye. It stands on its own: no script, no font, no
//! network.

pub(super) mod chart;
mod hotspot;
pub(super) mod lap_track;
mod map;

pub use hotspot::{Hotspot, hotspots};

use crate::base::number::{fixed, trimmed};
use crate::chain_input::Simulation;
use crate::report::style::document;
use crate::signal::measures::{Statistics, TrackSection, by_section, statistics};
use crate::signal::order::order_spectrum;
use crate::signal::spectrum::welch;
use crate::signal::{Channel, Run, SupportLoad, position, rainflow};
use lap_track::LapTrack;
use maud::{Markup, html};

/// Slope of the S-N curve and number of cycles of the damage-equivalent loads.
const SLOPE: f64 = 3.0;
const CYCLES: f64 = 1e6;

/// Samples a spectrum's segment: 0.24 Hz a line at 500 Hz.
const SEGMENT: usize = 2048;

/// The page of a run on the track of its simulation input.
pub fn page(simulation: &Simulation, run: &Run, supports: &[SupportLoad]) -> String {
    let track = LapTrack::new(simulation);
    let lap = track.line.length;
    let place = position::position(run, lap);
    let stations: Vec<f64> = place.as_ref().map_or_else(Vec::new, |p| p.s.iter().map(|s| s.rem_euclid(lap)).collect());
    let drawn: Vec<(Channel, &Vec<f64>)> = run
        .channels
        .iter()
        .filter(|(channel, samples)| {
            let varies = statistics(samples).is_some_and(|s| s.max > s.min);
            **channel != Channel::Trigger && varies
        })
        .map(|(channel, samples)| (*channel, samples))
        .collect();
    let forces: Vec<(Channel, &Vec<f64>)> = drawn.iter().filter(|(c, _)| c.is_force()).copied().collect();
    let spots = hotspots(simulation, run);
    let body = html! {
        h1 { (simulation.name) }
        p.lead { (summary(simulation, run, &spots)) }
        @if stations.is_empty() {
            p.note { "The trigger never rises in this run, so that places on the track cannot be told: only statistics \
                      and spectra follow." }
        }
        @if !spots.is_empty() {
            h2 { "Hotspots" }
            ul { @for spot in &spots { li { (spot.to_string()) } } }
        }
        h2 { "Channels" }
        (table(run))
        @if !stations.is_empty() {
            h2 { "Top view" }
            (map::views(&track, &stations, &forces))
            h2 { "Along the track" }
            (chart::legend())
            @for (channel, samples) in &drawn {
                figure {
                    figcaption { b { (channel.name()) } ", " (channel.unit()) " — " (channel.label()) }
                    (chart::along(&track, &stations, samples))
                }
            }
        }
        h2 { "Spectra" }
        p { "Amplitude spectral density by Welch's method (1967), Hann windows \
             of " (SEGMENT) " samples with half overlap. Dashed: cart passing "
            "v/L and its double; dotted: the turn of a running wheel v/(2πr), and the first ring mode of the chain \
             L√(K/m)/S." }
        @for (channel, samples) in &forces {
            figure {
                figcaption { b { (channel.name()) } ", N/√Hz over Hz" }
                (chart::spectrum(&welch(samples, run.rate(), SEGMENT), &marks(simulation)))
            }
        }
        @if let Some(place) = &place {
            h2 { "Orders" }
            p { "Amplitude over cycles a cart pitch: what cart passing makes stands at whole orders. Cycles a wheel \
                 turn are these times 2πr/L, "
                (trimmed(std::f64::consts::TAU * simulation.running_wheel.radius_m / pitch(simulation), 4))
                " for a running wheel." }
            @let shown = |c: &Channel| matches!(c, Channel::SteerLeft | Channel::JointXi);
            @for (channel, samples) in forces.iter().filter(|(c, _)| shown(c)) {
                figure {
                    figcaption { b { (channel.name()) } ", N over cycles a cart pitch" }
                    (chart::orders(&order_spectrum(&place.s, samples, pitch(simulation)), ORDERS))
                }
            }
            h2 { "Section by section" }
            (sections(&track, &stations, run))
        }
        @if !supports.is_empty() {
            h2 { "Reactions of the supports" }
            p { "Least and largest load of each support over the lap, the track taken as simply supported spans. \
                 Downwards and to the left are positive." }
            figure { figcaption { b { "vertical" } ", N over m" } (chart::supports(&track, supports, |s| s.vertical)) }
            figure { figcaption { b { "lateral" } ", N over m" } (chart::supports(&track, supports, |s| s.lateral)) }
            figure {
                figcaption { b { "longitudinal" } ", N over m" } (chart::supports(&track, supports, |s| s.longitudinal))
            }
            (worst(supports))
        } @else if simulation.supports_every_m.is_some() {
            p { "What the supports carry is added by " code { "lss simulate --supports" } "." }
        }
    };
    document(&format!("{}: a lap", simulation.name), "", &body)
}

/// What the lap is like, in two sentences.
fn summary(simulation: &Simulation, run: &Run, spots: &[Hotspot]) -> String {
    let chain = &simulation.chain;
    let mut text = format!(
        "{} carts on {} m at {} m/s with a tension of {} N; {} s of the sensor cart, number {}.",
        chain.carts,
        trimmed(chain.track_length_m, 3),
        trimmed(chain.speed_m_s, 3),
        trimmed(chain.tension_n, 1),
        fixed(run.duration(), 1),
        run.sidecar.sensor_cart
    );
    if let Some(pull) = run.channels.get(&Channel::JointXi).and_then(|x| statistics(x)) {
        text += &format!(
            " The joint pulls with {} N in the mean and swings by {} N (standard deviation)",
            fixed(pull.mean, 0),
            fixed(pull.sd, 0)
        );
        text += match spots.first() {
            Some(spot) => format!("; the hardest steering is {spot}.", spot = spot.short()),
            None => ".".to_owned(),
        }
        .as_str();
    }
    text
}

fn table(run: &Run) -> Markup {
    html! {
        div.scroll { table {
            thead { tr {
                th { "channel" } th { "unit" } th { "mean" } th { "sd" } th { "min" } th { "max" }
                th { "damage-equivalent range" }
            } }
            tbody { @for (channel, samples) in &run.channels {
                @if let Some(s) = statistics(samples) {
                    tr {
                        td { (channel.name()) } td { (channel.unit()) }
                        td.number { (fixed(s.mean, 2)) } td.number { (fixed(s.sd, 2)) }
                        td.number { (fixed(s.min, 2)) } td.number { (fixed(s.max, 2)) }
                        td.number { @if channel.is_force() { (damage(samples)) } }
                    }
                }
            } }
        } }
        p.note { "Damage-equivalent range: the constant force range that does the same damage in " (CYCLES)
            " cycles, from rainflow counts (ASTM E1049) and Miner's rule with an S-N slope \
             of " (SLOPE) ", for this recording." }
    }
}

fn damage(samples: &[f64]) -> String {
    let load = rainflow::damage_equivalent(&rainflow::rainflow(samples), SLOPE, CYCLES);
    load.map_or_else(String::new, |load| fixed(load, 2))
}

/// Orders shown.
const ORDERS: f64 = 10.0;

/// Length of the centre line a cart, m.
fn pitch(simulation: &Simulation) -> f64 {
    simulation.chain.track_length_m / simulation.chain.carts.max(1) as f64
}

/// Curves, climbs and spirals with the forces on them.
fn sections(track: &LapTrack, stations: &[f64], run: &Run) -> Markup {
    let parts: Vec<&lap_track::TrackPart> =
        track.parts.iter().filter(|part| part.kind != lap_track::PartKind::Straight).collect();
    let bounds: Vec<TrackSection> =
        parts.iter().map(|p| TrackSection { name: p.name.clone(), from: p.from, to: p.to }).collect();
    let columns: Vec<(Channel, Vec<Option<Statistics>>)> =
        [Channel::SteerLeft, Channel::SteerRight, Channel::RunLeft, Channel::RunRight, Channel::JointXi]
            .into_iter()
            .filter_map(|c| run.channels.get(&c).map(|x| (c, by_section(stations, x, track.line.length, &bounds))))
            .collect();
    html! {
        div.scroll { table {
            thead { tr { th { "" } th { "s, m" } @for (channel, _) in &columns { th { (channel.name()) ", N" } } } }
            tbody { @for (k, part) in parts.iter().enumerate() {
                tr {
                    td { (part.name) } td.number { (fixed(part.from, 2)) " … " (fixed(part.to, 2)) }
                    @for (_, column) in &columns {
                        td.number {
                            @if let Some(s) = column.get(k).and_then(Option::as_ref) {
                                (fixed(s.mean, 0)) " (" (fixed(peak(s), 0)) ")"
                            }
                        }
                    }
                }
            } }
        } }
        p.note { "Mean and, in brackets, peak on each section: the largest by absolute value, with its sign." }
    }
}

/// The largest by absolute value, with its sign.
fn peak(s: &Statistics) -> f64 {
    if -s.min > s.max { s.min } else { s.max }
}

/// Frequencies worth a line in a spectrum: name, Hz, and whether it is of cart passing.
fn marks(simulation: &Simulation) -> Vec<(&'static str, f64, bool)> {
    let chain = &simulation.chain;
    let pitch = pitch(simulation);
    let passing = chain.speed_m_s / pitch;
    let wheel = chain.speed_m_s / (std::f64::consts::TAU * simulation.running_wheel.radius_m);
    let wave = pitch * (simulation.joint.axial.stiffness_n_per_m_n / simulation.cart.mass_kg).sqrt();
    let mut marks = vec![("cart", passing, true), ("2×", 2.0 * passing, true), ("wheel", wheel, false)];
    if simulation.joint.axial.exponent == 1.0 {
        marks.push(("ring", wave / chain.track_length_m, false));
    }
    marks
}

fn worst(supports: &[SupportLoad]) -> Markup {
    let mut order: Vec<&SupportLoad> = supports.iter().collect();
    order.sort_by(|a, b| b.vertical.1.total_cmp(&a.vertical.1));
    let range = |(low, high): (f64, f64)| format!("{} … {}", fixed(low, 0), fixed(high, 0));
    html! {
        div.scroll { table {
            thead { tr { th { "support at s, m" } th { "vertical, N" } th { "lateral, N" } th { "longitudinal, N" } } }
            tbody { @for support in order.iter().take(5) {
                tr {
                    td.number { (fixed(support.s, 2)) } td.number { (range(support.vertical)) }
                    td.number { (range(support.lateral)) } td.number { (range(support.longitudinal)) }
                }
            } }
        } }
        p.note { "The five with the largest vertical load." }
    }
}
