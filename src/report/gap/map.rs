//! Where the gap lies: on the track from above, along it channel by channel, and by kind of deviation.

use super::words::{band, percent, stretch};
use crate::base::number::{fixed, ticks, trimmed};
use crate::gap::{Axis, Diagnosis, GapPlace};
use crate::report::lap_track::{LapTrack, PartKind};
use crate::report::plot::{Layer, LayerOf, Plan, Rounded, Spot, plan, plan_place};
use crate::report::rows::{RowScale, row};
use maud::{Markup, html};
use std::collections::BTreeMap;

/// Pieces that the track is coloured in.
const PIECES: usize = 300;
/// Parts of the gap that are named one by one.
const NAMED: usize = 6;
/// Of the whole axis; what is longer belongs to no place.
const LOCAL: f64 = 0.6;

/// How long the track, or the longest run, is.
fn extent(diagnosis: &Diagnosis, track: Option<&LapTrack>) -> f64 {
    let seen = diagnosis.places.iter().map(|p| p.extent.ends().1).filter(|x| x.is_finite()).fold(0.0, f64::max);
    track.map_or(seen, |t| t.line.length)
}

/// Parts of the gap that belong to a place.
fn local(diagnosis: &Diagnosis, extent: f64) -> Vec<&GapPlace> {
    let somewhere = |p: &&GapPlace| {
        let length = p.extent.length();
        p.share > 0.0 && length > 0.0 && length <= LOCAL * extent
    };
    diagnosis.places.iter().filter(somewhere).collect()
}

/// Share of the gap per metre (or second) in each piece of the axis.
fn density(places: &[&GapPlace], extent: f64, pieces: usize) -> Vec<f64> {
    let step = extent / pieces as f64;
    let mut found = vec![0.0; pieces];
    for place in places {
        let ends = place.extent.ends();
        for (k, value) in found.iter_mut().enumerate() {
            let (from, to) = (k as f64 * step, (k + 1) as f64 * step);
            let common = (to.min(ends.1) - from.max(ends.0)).max(0.0);
            *value += place.share * common / (place.extent.length()) / step;
        }
    }
    found
}

/// All of it; nothing where no part of the gap is known.
pub fn section(diagnosis: &Diagnosis, track: Option<&LapTrack>) -> Markup {
    let extent = extent(diagnosis, track);
    let places = local(diagnosis, extent);
    let all: Vec<&GapPlace> = diagnosis.places.iter().filter(|p| p.share > 0.0).collect();
    html! {
        @if !places.is_empty() {
            @if track.is_some() { (plan_place()) }
            (strip(&places, extent, track, diagnosis.axis))
        }
        @if !all.is_empty() {
            (worst(&all, extent, track, diagnosis.axis))
            // In time there is one kind of deviation only.
            @if diagnosis.axis == Axis::Track { (table(&all)) }
        }
    }
}

/// Opacity of a density: its root, so that small parts can be seen.
fn opacity(density: f64, largest: f64) -> String {
    fixed((density / largest).clamp(0.0, 1.0).sqrt(), 2)
}

/// The track coloured by the gap, with the places that most of it belongs to; `None` where none is known.
pub fn plan_of(diagnosis: &Diagnosis, track: &LapTrack) -> Option<Plan> {
    let lap = track.line.length;
    let places = local(diagnosis, lap);
    if places.is_empty() {
        return None;
    }
    let mut plan = plan(track);
    plan.layers.push(Layer {
        name: "gap".to_owned(),
        label: "Share of the gap a metre of the track".to_owned(),
        unit: "%/m".to_owned(),
        of: LayerOf::Amounts(Rounded::new(density(&places, lap, PIECES).iter().map(|d| 100.0 * d).collect())),
    });
    let spot = |s: f64| Spot { s, name: track.part(s).map_or_else(String::new, |part| part.name.clone()) };
    plan.spots = spots(&places, lap).into_iter().map(spot).collect();
    Some(plan)
}

/// The colours' meaning.
fn key(largest: f64, axis: Axis) -> Markup {
    html! {
        p.note { "0 " i.gap-ramp {} " " (percent(largest)) " of the gap per " (if axis == Axis::Track { "metre" } else { "second" }) }
    }
}

/// Middles of the places that the list below numbers, the first of those that are near to each other.
fn spots(places: &[&GapPlace], lap: f64) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for place in places {
        let middle = place.extent.middle();
        let near = |other: &f64| {
            let apart = (middle - other).abs();
            apart.min(lap - apart) < 0.02 * lap
        };
        if !found.iter().any(near) {
            found.push(middle);
        }
    }
    found.truncate(3);
    found
}

/// Channels over the axis, the one with most of the gap first.
fn strip(places: &[&GapPlace], extent: f64, track: Option<&LapTrack>, axis: Axis) -> Markup {
    let mut channels: BTreeMap<&str, f64> = BTreeMap::new();
    places.iter().for_each(|p| *channels.entry(&p.channel).or_default() += p.share);
    let mut rows: Vec<(&str, f64)> = channels.into_iter().collect();
    rows.sort_by(|a, b| b.1.total_cmp(&a.1));
    let columns: Vec<Vec<f64>> = rows
        .iter()
        .map(|(channel, _)| {
            let own: Vec<&GapPlace> = places.iter().filter(|p| p.channel == *channel).copied().collect();
            density(&own, extent, PIECES)
        })
        .collect();
    let largest = columns.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
    let step = extent / PIECES as f64;
    let scale = RowScale { low: 0.0, high: extent };
    let numbers: Vec<(f64, String)> =
        ticks(0.0, extent, 8.0).into_iter().map(|t| (t, format!("{} {}", trimmed(t, 3), axis.unit()))).collect();
    let lines: Vec<f64> = numbers.iter().map(|(t, _)| *t).collect();
    let bent = || track.map_or(&[][..], |t| &t.parts).iter().filter(|p| p.kind != PartKind::Straight);
    let stretch = |(from, to, value): (usize, usize, f64)| {
        let (left, right) = (scale.at(from as f64 * step), (to - from) as f64 / PIECES as f64 * 100.0);
        let style = format!("left:{left}%;width:{}%;opacity:{}", fixed(right, 2), opacity(value, largest));
        html! { i.gap-fill style=(style) {} }
    };
    html! {
        figure {
            figcaption { b { "Channel by channel" } ", share of the gap over "
                (if axis == Axis::Track { "arc length, m" } else { "time, s" })
                @if track.is_some() { "; shaded above: curves, ramps and spirals" } }
            div.rows.strip data-along=(if axis == Axis::Track { "track" } else { "time" }) data-extent=(fixed(extent, 3)) {
                @if track.is_some() {
                    @let shades = html! {
                        @for part in bent() { (scale.span(&format!("part {}", part.kind.class()), part.from, part.to)) }
                    };
                    (row("parts", &"", &shades, &""))
                }
                @for ((channel, share), values) in rows.iter().zip(&columns) {
                    @let marks = html! { @for run in runs(values) { (stretch(run)) } (scale.grid(&lines)) };
                    (row("", channel, &marks, &percent(*share)))
                }
                (scale.ticks(&numbers))
            }
            (key(largest, axis))
        }
    }
}

/// Stretches of equal values over nothing: from, to, value.
fn runs(values: &[f64]) -> Vec<(usize, usize, f64)> {
    let mut found: Vec<(usize, usize, f64)> = Vec::new();
    for (k, value) in values.iter().enumerate().filter(|(_, v)| **v > 0.0) {
        match found.last_mut() {
            Some((_, to, same)) if *to == k && (*same - value).abs() <= 1e-9 * value => *to = k + 1,
            _ => found.push((k, k + 1, *value)),
        }
    }
    found
}

/// The largest parts, in words.
fn worst(places: &[&GapPlace], extent: f64, track: Option<&LapTrack>, axis: Axis) -> Markup {
    let whole = |p: &GapPlace| p.extent.length() > LOCAL * extent;
    let spots = track.map_or_else(Vec::new, |t| {
        spots(&places.iter().filter(|p| !whole(p)).copied().collect::<Vec<_>>(), t.line.length)
    });
    let number =
        |p: &GapPlace| spots.iter().position(|s| !whole(p) && p.extent.ends().0 <= *s && *s <= p.extent.ends().1);
    let part = |p: &GapPlace| track.and_then(|t| t.part(p.extent.middle())).map(|part| part.name.clone());
    html! {
        h3 { "Largest parts" }
        div.scroll { table {
            thead { tr {
                @if !spots.is_empty() { th {} }
                th { "share" } th { "channel" } th { "where" } th { "what differs" }
            } }
            tbody { @for p in places.iter().take(NAMED) {
                tr {
                    @if !spots.is_empty() { td { @if let Some(k) = number(p) { span.badge { (k + 1) } } } }
                    td.number { (percent(p.share)) }
                    td { (p.channel) }
                    td { @if whole(p) { @if axis == Axis::Track { "all along the track" } @else { "all the time" } }
                        @else { (stretch(p.extent.ends().0, p.extent.ends().1, axis))
                            @if let Some(name) = part(p) { ", " (name) } } }
                    td {
                        @if axis == Axis::Track { (p.band) @if !band(&p.band, axis).is_empty() { ": " } }
                        (band(&p.band, axis))
                    }
                }
            } }
        } }
    }
}

/// Shares by channel and kind of deviation.
fn table(places: &[&GapPlace]) -> Markup {
    const ORDER: [&str; 7] = ["track", "fluctuation", "distribution", "cart", "wheel", "motor", "drift"];
    let mut shares: BTreeMap<(&str, &str), f64> = BTreeMap::new();
    places.iter().for_each(|p| *shares.entry((&p.channel, &p.band)).or_default() += p.share);
    let rank = |band: &str| ORDER.iter().position(|b| *b == band).unwrap_or(ORDER.len());
    let mut bands: Vec<&str> = shares.keys().map(|(_, band)| *band).collect();
    bands.sort_by_key(|b| (rank(b), *b));
    bands.dedup();
    let total =
        |of: &dyn Fn(&(&str, &str)) -> bool| -> f64 { shares.iter().filter(|(k, _)| of(k)).map(|(_, x)| x).sum() };
    let mut channels: Vec<(&str, f64)> = shares.keys().map(|(c, _)| (*c, total(&|k| k.0 == *c))).collect();
    channels.dedup();
    channels.sort_by(|a, b| b.1.total_cmp(&a.1));
    let heat = |share: f64| {
        format!(
            "background: color-mix(in srgb, var(--gap) {} %, transparent)",
            fixed(55.0 * share.clamp(0.0, 1.0).sqrt(), 0)
        )
        .replace(" %,", "%,")
    };
    let rest = 1.0 - total(&|_| true);
    html! {
        h3 { "By channel and kind of deviation" }
        @if rest > 0.005 {
            p.quiet {
                "The " (places.len()) " largest parts are counted. Smaller ones hold the other " (percent(rest)) "."
            }
        }
        div.scroll { table.heat {
            thead { tr { th { "channel" } @for b in &bands { th.number { (b) } } th.number { "sum" } } }
            tbody {
                @for (channel, all) in &channels {
                    tr {
                        td { (channel) }
                        @for b in &bands {
                            @let share = shares.get(&(*channel, *b)).copied().unwrap_or(0.0);
                            @if share > 0.0 {
                                td.number style=(heat(share)) { (percent(share)) }
                            } @else {
                                td.number.quiet { "–" }
                            }
                        }
                        td.number { (percent(*all)) }
                    }
                }
                @if channels.len() > 1 {
                    tr.sum {
                        td { "sum" } @for b in &bands { td.number { (percent(total(&|k| k.1 == *b))) } }
                        td.number { (percent(total(&|_| true))) }
                    }
                }
            }
        } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::Extent;

    fn place(from_m: f64, to_m: f64, share: f64) -> GapPlace {
        GapPlace { channel: "steer_left".into(), extent: Extent::Track { from_m, to_m }, band: "track".into(), share }
    }

    #[test]
    fn densities_hold_the_whole_share() {
        let (a, b) = (place(2.5, 5.0, 0.5), place(4.0, 9.5, 0.25));
        let found = density(&[&a, &b], 10.0, 7);
        let sum: f64 = found.iter().map(|d| d * 10.0 / 7.0).sum();
        assert!((sum - 0.75).abs() < 1e-12 && found[0] == 0.0, "{found:?}");
        assert!((density(&[&a], 10.0, 4)[1] - 0.2).abs() < 1e-12);
    }

    #[test]
    fn equal_neighbours_are_one_stretch_and_near_places_one_spot() {
        assert_eq!(runs(&[0.0, 1.0, 1.0, 2.0, 0.0, 2.0]), [(1, 3, 1.0), (3, 4, 2.0), (5, 6, 2.0)]);
        let places = [place(0.0, 2.0, 0.5), place(98.5, 99.5, 0.3), place(50.0, 52.0, 0.2)];
        assert_eq!(spots(&places.iter().collect::<Vec<_>>(), 100.0), [1.0, 99.0, 51.0]);
        assert_eq!(spots(&places.iter().collect::<Vec<_>>(), 200.0), [1.0, 99.0, 51.0]);
        let near = [place(0.0, 2.0, 0.5), place(0.5, 2.5, 0.3)];
        assert_eq!(spots(&near.iter().collect::<Vec<_>>(), 100.0), [1.0]);
    }
}
