//! `lap.html`: a simulated lap on one page, for judging it: the answer in words with the chain on the plan, then curves
//! that can be asked, then tables. It opens offline.

pub(super) mod curves;
mod hotspot;

pub use hotspot::{Hotspot, hotspots};

use super::lap_track::{LapTrack, PartKind, TrackPart};
use crate::base::number::{fixed, trimmed};
use crate::chain_input::Simulation;
use crate::report::plot::{Pictures, Spot, document, how, plan, plan_place};
use crate::signal::measures::{Statistics, TrackSection, by_section, statistics};
use crate::signal::position::{self, Position};
use crate::signal::{Channel, Run, SupportLoad, rainflow};
use maud::{Markup, html};

/// Slope of the S-N curve and number of cycles of the damage-equivalent loads.
const SLOPE: f64 = 3.0;
const CYCLES: f64 = 1e6;

/// Channels with their samples.
type Drawn<'a> = Vec<(Channel, &'a Vec<f64>)>;

/// The page of a run on the track of its simulation input.
pub fn page(simulation: &Simulation, run: &Run, supports: &[SupportLoad]) -> String {
    let track = LapTrack::new(simulation);
    let lap = track.line.length;
    let place = position::position(run, lap);
    let stations: Vec<f64> = place.as_ref().map_or_else(Vec::new, |p| p.s.iter().map(|s| s.rem_euclid(lap)).collect());
    let varies = |(channel, samples): &(Channel, &Vec<f64>)| {
        *channel != Channel::Trigger && statistics(samples).is_some_and(|s| s.max > s.min)
    };
    let drawn: Drawn = run.channels.iter().map(|(channel, samples)| (*channel, samples)).filter(varies).collect();
    let forces: Drawn = drawn.iter().filter(|(c, _)| c.is_force()).copied().collect();
    let spots = hotspots(simulation, run);
    let mut pictures = Pictures::new(&simulation.name);
    if let Some(place) = &place {
        let mut plan = plan(&track);
        plan.layers = forces.iter().map(|(c, _)| curves::layer(*c)).collect();
        plan.shown = forces.iter().position(|(c, _)| *c == Channel::JointXi).unwrap_or(0);
        plan.spots = spots.iter().map(|spot| Spot { s: spot.s, name: spot.to_string() }).collect();
        pictures.data.plan = Some(plan);
        pictures.data.replay = Some(curves::replay(simulation, run, place));
    }
    let body = html! {
        h1 { (simulation.name) }
        p.lead { (summary(simulation, run, &spots)) }
        @if stations.is_empty() {
            p.note { "The trigger never rises in this run, so that places on the track cannot be told: only spectra and \
                      statistics follow." }
        } @else {
            (plan_place())
            ol.places { @for (k, spot) in spots.iter().enumerate() {
                li { b { (k + 1) } a data-s=(fixed(spot.s, 2)) { (spot.to_string()) } }
            } }
            h2 #along { "Along the track" }
            (how())
            (other())
            (switches(&drawn))
            (legend())
            @for (channel, samples) in &drawn {
                figure id=(format!("channel-{}", channel.name())) {
                    figcaption { b { (channel.name()) } ", " (channel.unit()) " over m: " (channel.label()) }
                    (pictures.add(curves::along(&track, &stations, *channel, samples)))
                }
            }
        }
        h2 { "Spectra" }
        p { "Amplitude spectral density by Welch's method (1967), Hann windows \
             of " (curves::SEGMENT) " samples with half overlap. Dashed: cart passing "
            "v/L and its double; dotted: the turn of a running wheel v/(2πr), and the first ring mode of the chain \
             L√(K/m)/S." }
        @for (channel, samples) in &forces {
            figure {
                figcaption { b { (channel.name()) } ", N/√Hz over Hz" }
                (pictures.add(curves::spectrum(simulation, run, *channel, samples)))
            }
        }
        @if let Some(place) = &place { (orders(simulation, place, &forces, &mut pictures)) }
        @if !supports.is_empty() { (reactions(supports, &mut pictures)) }
        h2 { "Channels" }
        (table(run))
        @if !stations.is_empty() {
            h2 { "Section by section" }
            (sections(&track, &stations, run))
        }
        @if supports.is_empty() && simulation.supports_every_m.is_some() {
            p { "What the supports carry is added by " code { "lss simulate --supports" } "." }
        }
    };
    document(&format!("{}: a lap", simulation.name), "", &body, &pictures.data)
}

/// What the shades mean.
fn legend() -> Markup {
    html! {
        p.legend.note {
            span { i style="background: var(--curve)" {} "curve" }
            span { i style="background: var(--climb)" {} "ramp" }
            span { i style="background: var(--spiral)" {} "spiral" }
            span { i style="background: var(--motor)" {} "motor" }
            "Values are of cells of a thousandth of the lap, so that a peak stays."
        }
    }
}

/// Channels on and off.
fn switches(drawn: &Drawn) -> Markup {
    html! {
        div.channels role="group" aria-label="channels" { @for (channel, _) in drawn {
            button type="button" aria-pressed="true" data-shows=(format!("channel-{}", channel.name())) { (channel.name()) }
        } }
    }
}

/// Another lap over this one.
fn other() -> Markup {
    html! {
        p.note.how {
            label { "Lay another lap over this one, as B: its lap.html " input #other-page type="file" accept=".html"; }
            " " span #other-said {}
        }
    }
}

fn orders(simulation: &Simulation, place: &Position, forces: &Drawn, pictures: &mut Pictures) -> Markup {
    let shown = |c: &Channel| matches!(c, Channel::SteerLeft | Channel::JointXi);
    html! {
        h2 { "Orders" }
        p { "Amplitude over cycles a cart pitch: what cart passing makes stands at whole orders. Cycles a wheel \
             turn are these times 2πr/L, "
            (trimmed(std::f64::consts::TAU * simulation.running_wheel.radius_m / pitch(simulation), 4))
            " for a running wheel." }
        @for (channel, samples) in forces.iter().filter(|(c, _)| shown(c)) {
            figure {
                figcaption { b { (channel.name()) } ", N over cycles a cart pitch" }
                (pictures.add(curves::orders(simulation, place, *channel, samples)))
            }
        }
    }
}

fn reactions(supports: &[SupportLoad], pictures: &mut Pictures) -> Markup {
    html! {
        h2 { "Reactions of the supports" }
        p { "Least and largest load of each support over the lap, the track taken as simply supported spans. \
             Downwards and to the left are positive." }
        figure { figcaption { b { "vertical" } ", N over m" }
            (pictures.add(curves::supports("vertical", supports, |s| s.vertical))) }
        figure { figcaption { b { "lateral" } ", N over m" }
            (pictures.add(curves::supports("lateral", supports, |s| s.lateral))) }
        figure { figcaption { b { "longitudinal" } ", N over m" }
            (pictures.add(curves::supports("longitudinal", supports, |s| s.longitudinal))) }
        (worst(supports))
    }
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

/// Length of the centre line a cart, m.
fn pitch(simulation: &Simulation) -> f64 {
    simulation.chain.track_length_m / simulation.chain.carts.max(1) as f64
}

/// Curves, climbs and spirals with the forces on them.
fn sections(track: &LapTrack, stations: &[f64], run: &Run) -> Markup {
    let parts: Vec<&TrackPart> = track.parts.iter().filter(|part| part.kind != PartKind::Straight).collect();
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
