//! Where the gap lies: on the track from above, along it channel by channel, and by kind of deviation.

use super::words::{band, percent, stretch};
use crate::base::number::{fixed, ticks, trimmed};
use crate::emit::paper::{PaperPoint, Projection};
use crate::gap::{Axis, Diagnosis, GapPlace};
use crate::geometry::Point;
use crate::report::lap::chart::coordinates;
use crate::report::lap::lap_track::{LapTrack, PartKind};
use maud::{Markup, html};
use std::collections::BTreeMap;

/// Pieces that the track is coloured in.
const PIECES: usize = 300;
/// Parts of the gap that are named one by one.
const NAMED: usize = 6;
/// Of the whole axis; what is longer belongs to no place.
const LOCAL: f64 = 0.6;

const WIDTH: f64 = 1100.0;

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
            @if let Some(track) = track { (view(track, &places)) }
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

fn view(track: &LapTrack, places: &[&GapPlace]) -> Markup {
    let lap = track.line.length;
    let values = density(places, lap, PIECES);
    let largest = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let margin = 40.0;
    let (low, high, scale) = track.fit(PaperPoint::new(WIDTH - 2.0 * margin, 420.0));
    // In the middle where the track is higher than wide.
    let left = 0.5 * (WIDTH - (high.x - low.x) * scale);
    let height = (high.y - low.y) * scale + 2.0 * margin + 26.0;
    let (floor, paper) = (Point::new(low.x, high.y), PaperPoint::new(left, margin));
    let projection = Projection { floor, paper, scale };
    let place = |s: f64| projection.at(track.at(s));
    let point = |s: f64| coordinates(place(s));
    let whole: Vec<String> = (0..=PIECES).map(|k| point(lap * k as f64 / PIECES as f64)).collect();
    let stretch = |from: usize, to: usize| {
        let halves = (2 * from..=2 * to).map(|k| point(lap * k as f64 / (2 * PIECES) as f64));
        format!("M{}", halves.collect::<Vec<_>>().join("L"))
    };
    let start = place(0.0);
    // Beside the track, on the side away from the middle.
    let middle = PaperPoint::new(0.5 * WIDTH, margin + 0.5 * (high.y - low.y) * scale);
    let beside = |s: f64, by: f64| {
        let (p, along) = (place(s), place(s + 0.1) - place(s - 0.1));
        let length = along.dot(along).sqrt().max(1e-9);
        let outward = p - middle;
        let away = if outward.x * along.y - outward.y * along.x >= 0.0 { by } else { -by };
        PaperPoint::new(p.x + away * along.y / length, p.y - away * along.x / length)
    };
    html! {
        svg viewBox=(format!("0 0 {WIDTH} {}", fixed(height, 0))) role="img" {
            path.track d=(format!("M{}Z", whole.join("L"))) {}
            @for (from, to, value) in runs(&values) {
                path.gap d=(stretch(from, to)) stroke-opacity=(opacity(value, largest)) {}
            }
            circle cx=(fixed(start.x, 1)) cy=(fixed(start.y, 1)) r="5" fill="none" stroke="currentColor" {}
            @let label = beside(0.0, 20.0);
            text.number-label x=(fixed(label.x, 1)) y=(fixed(label.y + 4.0, 1)) text-anchor="middle" { "s = 0" }
            @for (k, spot) in spots(places, lap).into_iter().enumerate() {
                @let p = beside(spot, 20.0);
                circle.badge cx=(fixed(p.x, 1)) cy=(fixed(p.y, 1)) r="9" {}
                text.badge-text x=(fixed(p.x, 1)) y=(fixed(p.y + 4.0, 1)) text-anchor="middle" { (k + 1) }
            }
            (key(margin, height - 20.0, largest, Axis::Track))
        }
    }
}

/// The colours' meaning.
fn key(x: f64, y: f64, largest: f64, axis: Axis) -> Markup {
    html! {
        @for k in 0..32 {
            @let share = f64::from(k) / 31.0;
            rect.gap-fill x=(fixed(x + f64::from(k) * 5.0, 1)) y=(fixed(y, 1)) width="5" height="10"
                fill-opacity=(opacity(share, 1.0)) {}
        }
        text.number-label x=(fixed(x + 168.0, 1)) y=(fixed(y + 9.0, 1)) {
            "0 … " (percent(largest)) " of the gap per " (if axis == Axis::Track { "metre" } else { "second" })
        }
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
    const LEFT: f64 = 150.0;
    const RIGHT: f64 = 70.0;
    const ROW: f64 = 22.0;
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
    let x = |s: f64| LEFT + s / extent * (WIDTH - LEFT - RIGHT);
    let top = 14.0;
    let bottom = top + ROW * rows.len() as f64;
    let height = bottom + 48.0;
    let step = extent / PIECES as f64;
    html! {
        figure {
            figcaption { b { "Channel by channel" } ", share of the gap over "
                (if axis == Axis::Track { "arc length, m" } else { "time, s" })
                @if track.is_some() { "; shaded above: curves, ramps and spirals" } }
            svg viewBox=(format!("0 0 {WIDTH} {}", fixed(height, 0))) role="img" {
                @for part in track.map_or(&[][..], |t| &t.parts).iter().filter(|p| p.kind != PartKind::Straight) {
                    rect class=(part.kind.class()) x=(fixed(x(part.from), 1)) y="0"
                        width=(fixed(x(part.to) - x(part.from), 1)) height="8" {}
                }
                @for (k, ((channel, share), values)) in rows.iter().zip(&columns).enumerate() {
                    @let y = top + ROW * k as f64;
                    text.name x=(LEFT - 10.0) y=(fixed(y + 13.0, 1)) text-anchor="end" { (channel) }
                    rect.row x=(LEFT) y=(fixed(y, 1)) width=(WIDTH - LEFT - RIGHT) height=(ROW - 4.0) {}
                    @for (from, to, value) in runs(values) {
                        rect.gap-fill x=(fixed(x(from as f64 * step), 1)) y=(fixed(y, 1))
                            width=(fixed(x((to - from) as f64 * step) - LEFT, 1))
                            height=(ROW - 4.0) fill-opacity=(opacity(value, largest)) {}
                    }
                    text.value x=(WIDTH - RIGHT + 8.0) y=(fixed(y + 13.0, 1)) { (percent(*share)) }
                }
                @for t in ticks(0.0, extent, 12.0) {
                    line.axis x1=(fixed(x(t), 1)) x2=(fixed(x(t), 1)) y1=(top) y2=(fixed(bottom, 1)) {}
                    text.tick x=(fixed(x(t), 1)) y=(fixed(bottom + 12.0, 1)) text-anchor="middle" {
                        (trimmed(t, 3)) " " (axis.unit())
                    }
                }
                (key(LEFT, bottom + 28.0, largest, axis))
            }
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
