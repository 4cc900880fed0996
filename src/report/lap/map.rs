//! The track from above, coloured by what a channel measured there.

use super::chart::coordinates;
use super::lap_track::LapTrack;
use crate::base::number::{fixed, trimmed};
use crate::emit::paper::{PaperPoint, Projection};
use crate::geometry::Point;
use crate::signal::Channel;
use maud::{Markup, html};

/// Pieces that the track is coloured in.
const PIECES: usize = 300;

/// Viridis (van der Walt and Smith 2015) at nine places: even to the eye, and readable with any colour vision.
const VIRIDIS: [[f64; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 44.0, 122.0],
    [59.0, 81.0, 139.0],
    [44.0, 113.0, 142.0],
    [33.0, 144.0, 141.0],
    [39.0, 173.0, 129.0],
    [92.0, 200.0, 99.0],
    [170.0, 220.0, 50.0],
    [253.0, 231.0, 37.0],
];

/// The colour at a share in [0, 1].
fn colour(share: f64) -> String {
    let at = share.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let k = (at as usize).min(VIRIDIS.len() - 2);
    let mix = |c: usize| (VIRIDIS[k][c] + (VIRIDIS[k + 1][c] - VIRIDIS[k][c]) * (at - k as f64)).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// A picture for each channel, one shown at a time; the pull of the joint first.
pub fn views(track: &LapTrack, stations: &[f64], forces: &[(Channel, &Vec<f64>)]) -> Markup {
    let shown = forces.iter().position(|(c, _)| *c == Channel::JointXi).unwrap_or(0);
    let rules: String =
        (0..forces.len()).map(|k| format!("#view-{k}:checked ~ .view-{k} {{ display: block; }} ")).collect();
    html! {
        div.views {
            style { (maud::PreEscaped(rules)) }
            @for (k, (channel, _)) in forces.iter().enumerate() {
                input type="radio" name="view" id=(format!("view-{k}")) checked[k == shown];
                label for=(format!("view-{k}")) { (channel.name()) }
            }
            @for (k, (channel, samples)) in forces.iter().enumerate() {
                div class=(format!("view view-{k}")) { (view(track, stations, *channel, samples)) }
            }
        }
    }
}

/// Of each piece, the value farthest from the channel's mean: a peak is not averaged away.
fn pieces(track: &LapTrack, stations: &[f64], samples: &[f64]) -> Vec<Option<f64>> {
    let lap = track.line.length;
    let mut found: Vec<Option<f64>> = vec![None; PIECES];
    let mean = samples.iter().filter(|x| x.is_finite()).sum::<f64>() / samples.len().max(1) as f64;
    for (s, x) in stations.iter().zip(samples).filter(|(_, x)| x.is_finite()) {
        let piece = ((s / lap * PIECES as f64) as usize).min(PIECES - 1);
        let best = found[piece].get_or_insert(*x);
        if (x - mean).abs() > (*best - mean).abs() {
            *best = *x;
        }
    }
    found
}

fn view(track: &LapTrack, stations: &[f64], channel: Channel, samples: &[f64]) -> Markup {
    let values = pieces(track, stations, samples);
    let low = values.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
    let lap = track.line.length;
    let (width, margin) = (1100.0, 40.0);
    let (low_corner, high_corner, scale) = track.fit(PaperPoint::new(width - 2.0 * margin, 520.0));
    let height = (high_corner.y - low_corner.y) * scale + 2.0 * margin + 30.0;
    let (floor, paper) = (Point::new(low_corner.x, high_corner.y), PaperPoint::new(margin, margin));
    let projection = Projection { floor, paper, scale };
    let point = |s: f64| coordinates(projection.at(track.at(s)));
    // A little over the end, so that no seam shows.
    let path = |k: usize| {
        let (from, to) = (k as f64 / PIECES as f64 * lap, (k as f64 + 1.05) / PIECES as f64 * lap);
        format!("M{}L{}L{}", point(from), point(0.5 * (from + to)), point(to))
    };
    let share = |x: f64| if high > low { (x - low) / (high - low) } else { 0.5 };
    let start = projection.at(track.at(0.0));
    html! {
        svg viewBox=(format!("0 0 {width} {}", fixed(height, 0))) role="img" {
            @for (k, value) in values.iter().enumerate() {
                @if let Some(value) = value {
                    path d=(path(k)) fill="none" stroke=(colour(share(*value))) stroke-width="7" {}
                }
            }
            circle cx=(fixed(start.x, 1)) cy=(fixed(start.y, 1)) r="5" fill="none" stroke="currentColor" {}
            text.number-label x=(fixed(start.x + 8.0, 1)) y=(fixed(start.y - 9.0, 1)) { "s = 0" }
            @for k in 0..64 {
                rect x=(fixed(margin + f64::from(k) * 4.0, 1)) y=(fixed(height - 26.0, 1)) width="4.5" height="10"
                    fill=(colour(f64::from(k) / 63.0)) {}
            }
            text.number-label x=(margin) y=(fixed(height - 4.0, 1)) { (trimmed(low, 0)) }
            text.number-label x=(margin + 256.0) y=(fixed(height - 4.0, 1)) text-anchor="end" {
                (trimmed(high, 0)) " " (channel.unit())
            }
        }
    }
}
