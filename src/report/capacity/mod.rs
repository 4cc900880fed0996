//! `capacity.html`: how many items an hour a sorter takes, where its carriers run empty, which chutes are full, and what
//! another speed or fewer inductions would give.

mod found;

pub use found::Found;
use found::cause_words;

use super::lap_track::LapTrack;
use super::plot::{Axis, Curve, Layer, LayerOf, Mark, Pictures, Plot, Rounded, document, how, plan, plan_place};
use crate::base::number::fixed;
use crate::capacity::explore::{Changed, Cost, used_along, used_at};
use crate::capacity::{Bounds, Measured, Sorter, limit_words, most_words};
use crate::chain_input::Track;
use maud::{Markup, html};

/// What the page is made of.
pub struct CapacityPage<'a> {
    pub layout: &'a str,
    pub track: &'a Track,
    pub sorter: &'a Sorter,
    pub bounds: &'a Bounds,
    /// Items an hour that the layout requires.
    pub required: Option<f64>,
    /// With items at every induction at any time.
    pub always: &'a Measured,
    /// With the items that the layout says come.
    pub fed: Option<&'a Measured>,
    pub costs: &'a [Cost],
    pub by_speed: &'a [Changed],
    pub by_inductions: &'a [Changed],
}

/// Pieces of the lap that carriers in use are shown of.
const PIECES: usize = 400;

/// The page of a sorter's capacity.
pub fn page(of: &CapacityPage) -> String {
    let mut pictures = Pictures::new(of.layout);
    let shown = of.fed.unwrap_or(of.always);
    let track = LapTrack::without_motors(of.track);
    let along = used_along(of.sorter, shown);
    let mut map = plan(&track);
    let share = |k: usize| 100.0 * used_at(&along, (k as f64 + 0.5) * map.lap_m / PIECES as f64);
    let amounts: Vec<f64> = (0..PIECES).map(share).collect();
    map.layers = vec![Layer {
        name: "used".to_owned(),
        label: "carriers in use".to_owned(),
        unit: "%".to_owned(),
        of: LayerOf::Amounts(Rounded::to(amounts, 1)),
    }];
    let lap = map.lap_m;
    pictures.data.plan = Some(map);
    let body = html! {
        p.kicker.note { "Capacity · " (of.layout) }
        h1 { (headline(of)) }
        p.lead { (lead(of)) }
        (plan_place())
        figure {
            figcaption { b { "Carriers in use" } ", % of those that pass, along the track, m; lines are inductions" }
            (pictures.add(used(of.sorter, &along, lap)))
        }
        (how())
        h2 { "Inductions" }
        (inductions(of.sorter, shown))
        h2 { "Chutes" }
        (chutes(of, shown, &mut pictures))
        (down(of.sorter, shown))
        @if !of.bounds.own().waves.is_empty() {
            h2 { "Waves" }
            (waves(of, shown))
        }
        @if !of.costs.is_empty() {
            h2 { "What it costs" }
            (costs(of))
        }
        @if of.by_speed.len() > 1 {
            h2 { "Another speed" }
            figure {
                figcaption { b { "Items an hour" } " over the speed, m/s, with items at every induction at any time" }
                (pictures.add(curve("speed", "m/s", of.by_speed, of.required)))
            }
        }
        @if of.by_inductions.len() > 1 {
            h2 { "Fewer inductions" }
            figure {
                figcaption { b { "Items an hour" } " with the first inductions in driving order only" }
                (pictures.add(curve("inductions", "", of.by_inductions, of.required)))
            }
        }
    };
    document(&format!("{}: capacity", of.layout), "", &body, &pictures.data)
}

fn headline(of: &CapacityPage) -> String {
    let found = fixed(of.always.throughput.value, 0);
    match of.required {
        Some(least) if of.always.throughput.value < least => {
            format!("{found} items an hour: {} fewer than required", fixed(least - of.always.throughput.value, 0))
        }
        Some(least) => format!("{found} items an hour, {} are required", fixed(least, 0)),
        None => format!("{found} items an hour"),
    }
}

fn lead(of: &CapacityPage) -> String {
    let Measured { throughput, time, warm_up, .. } = of.always;
    let any = &of.bounds.any;
    let mut text = format!(
        "Simulated with items at every induction at any time: {} ± {} (95 %), the first {} min left out. {} {}, \
         limited by {}.",
        fixed(throughput.value, 0),
        fixed(throughput.half_width, 0),
        fixed(warm_up / 60.0, 0),
        if any.is_strict(of.sorter) { "No way of feeding takes more than" } else { "The closed form says about" },
        fixed(any.throughput, 0),
        limit_words(of.sorter, any.limit)
    );
    if let Some(as_fed) = &of.bounds.as_fed {
        let limit =
            if as_fed.limit == any.limit { "the same".to_owned() } else { limit_words(of.sorter, as_fed.limit) };
        text += &format!(
            " In the proportions in which items come it is {} {}, limited by {limit}.",
            most_words(of.sorter, as_fed),
            fixed(as_fed.throughput, 0),
        );
    }
    if let Some(fed) = of.fed {
        let comes: f64 = of.sorter.inductions.iter().filter_map(|i| i.demand).sum();
        text += &format!(
            " Of the {} that come, {} ± {} are given out, {} s after they came in the mean; the pictures show this.",
            fixed(comes, 0),
            fixed(fed.throughput.value, 0),
            fixed(fed.throughput.half_width, 0),
            fixed(fed.time.value, 0)
        );
    } else {
        text += &format!(" An item is on the sorter for {} s in the mean.", fixed(time.value, 0));
    }
    text
}

fn used(sorter: &Sorter, along: &[(f64, f64)], lap: f64) -> Plot {
    // Steps: a value before and one behind each change.
    let mut x = vec![0.0];
    let mut y = vec![100.0 * used_at(along, 0.0)];
    for (s, share) in along.iter().filter(|(s, _)| *s > 0.0 && *s < lap) {
        y.extend([y.last().copied().unwrap_or(0.0), 100.0 * share]);
        x.extend([*s, s + 1e-3]);
    }
    y.push(y.last().copied().unwrap_or(0.0));
    x.push(lap);
    let mut plot = Plot::new("used", Axis::Track, "%", Rounded::to(x, 3));
    plot.curves.push(Curve::line("carriers in use", "trace", y));
    plot.marks = sorter.inductions.iter().map(|i| Mark { x: i.s, name: i.name.clone(), dotted: true }).collect();
    plot
}

fn inductions(sorter: &Sorter, measured: &Measured) -> Markup {
    let fails = sorter.inductions.iter().any(|i| i.fails.is_some());
    html! {
        div.scroll { table {
            thead { tr { th { "induction" } th { "s, m" } th { "comes an hour" } th { "put on an hour" } th { "items wait, s" } th { "wait at the end" }
                th { "in use before" } th { "behind" }
                @if fails { th { "works" } } } }
            tbody { @for (i, induction) in sorter.inductions.iter().enumerate() { tr {
                td { (induction.name) } td.number { (fixed(induction.s, 2)) }
                td.number { @if let Some(comes) = induction.demand { (fixed(comes, 0)) } @else { "always" } }
                td.number { (fixed(measured.inductions[i].0, 0)) } td.number { (fixed(measured.inductions[i].1, 1)) }
                td.number { (fixed(measured.queues[i], 0)) }
                td.number { (fixed(100.0 * measured.used[i].0, 1)) " %" } td.number { (fixed(100.0 * measured.used[i].1, 1)) " %" }
                @if fails { td.number { @if induction.fails.is_some() { (fixed(100.0 * measured.available[i], 2)) " %" } @else { "always" } } }
            } } }
        } }
    }
}

fn waves(of: &CapacityPage, measured: &Measured) -> Markup {
    let Some(waves) = &of.sorter.waves else { return html! {} };
    let drawn = waves.spread > 0.0;
    html! {
        p {
            "A wave lasts " (fixed(waves.every / 60.0, 1)) " min, of which chutes are closed for " (fixed(waves.changeover / 60.0, 1)) " min"
            @if drawn { "; the share of each chute is multiplied with a number of mean 1 and coefficient of variation " (fixed(100.0 * waves.spread, 0)) " %, drawn anew in each wave" }
            ". An item made " (fixed(measured.closed, 3)) " laps in the mean because chutes were closed."
        }
        div.scroll { table {
            thead { tr { th { "wave" } th { "busiest chute" } th { @if drawn { "largest share, mean" } @else { "its share" } } th { "a chute is full with, an hour" } th { "closed form, an hour" }
                th { "given out an hour" } th { "limited by" } } }
            tbody { @for (k, wave) in of.bounds.own().waves.iter().enumerate() { tr {
                td { (waves.each.get(k).map_or("all", |wave| &wave.name)) }
                td { (of.sorter.chutes[wave.busiest].name) }
                td.number { (fixed(100.0 * wave.share, 1)) " %" }
                td.number { @if wave.fits.is_finite() { (fixed(wave.fits, 0)) } @else { "never" } } td.number { (fixed(wave.throughput, 0)) }
                td.number { (fixed(measured.waves[k], 0)) } td { (limit_words(of.sorter, wave.limit)) }
            } } }
        } }
    }
}

fn costs(of: &CapacityPage) -> Markup {
    html! {
        p { "Items an hour that the sorter would take more without each of them, with items at every induction at any time: the same items, simulated without it." }
        div.scroll { table {
            thead { tr { th { "cause" } th { "items an hour" } th { "± (95 %)" } } }
            tbody { @for cost in of.costs { tr {
                td { (cause_words(&cost.cause)) } td.number { (fixed(cost.per_hour.value, 0)) } td.number { (fixed(cost.per_hour.half_width, 0)) }
            } } }
        } }
    }
}

/// Chutes that fail: how many of their items found them down.
fn down(sorter: &Sorter, measured: &Measured) -> Markup {
    let failing: Vec<usize> = (0..sorter.chutes.len()).filter(|c| sorter.chutes[*c].fails.is_some()).collect();
    let worst = failing.iter().max_by(|a, b| measured.chutes_down[**a].total_cmp(&measured.chutes_down[**b]));
    html! { @if let Some(c) = worst {
        p {
            (failing.len()) " chutes fail: an item made " (fixed(measured.down, 3)) " laps in the mean because its chute was down; most often down is "
            (sorter.chutes[*c].name) ", for " (fixed(100.0 * measured.chutes_down[*c], 1)) " % of its items."
        }
    } }
}

fn chutes(of: &CapacityPage, measured: &Measured, pictures: &mut Pictures) -> Markup {
    let sorter = of.sorter;
    if sorter.chutes.iter().all(|chute| chute.storage.is_none()) {
        return html! { p.note { "The layout says of no chute how much it holds: none is ever full." } };
    }
    let mut order: Vec<usize> = (0..sorter.chutes.len()).collect();
    order.sort_by(|a, b| sorter.chutes[*a].s.total_cmp(&sorter.chutes[*b].s));
    let s: Vec<f64> = order.iter().map(|c| sorter.chutes[*c].s).collect();
    let refused: Vec<f64> = order.iter().map(|c| 100.0 * measured.chutes[*c].1).collect();
    let full = refused.iter().filter(|share| **share > 0.5).count();
    if full == 0 {
        return html! { p { "No chute is full for more than one item in 200." } };
    }
    let mut plot = Plot::new("refused", Axis::Track, "%", Rounded::to(s, 3));
    plot.curves.push(Curve::dots("refused", "trace", refused));
    let most = order.iter().max_by(|a, b| measured.chutes[**a].1.total_cmp(&measured.chutes[**b].1));
    html! {
        p {
            (full) " of " (order.len()) " chutes are full for more than one item in 200"
            @if let Some(c) = most { "; the worst is " (sorter.chutes[*c].name) ", for " (fixed(100.0 * measured.chutes[*c].1, 1)) " %" } "."
        }
        figure {
            figcaption { b { "Items that found their chute full" } ", %, along the track, m: one dot a chute" }
            (pictures.add(plot))
        }
    }
}

fn curve(id: &str, unit: &str, changed: &[Changed], required: Option<f64>) -> Plot {
    let of = |what: fn(&Changed) -> f64| changed.iter().map(what).collect::<Vec<f64>>();
    let mut plot = Plot::new(id, Axis::Own, "items/h", Rounded::to(of(|c| c.of), 3));
    plot.x_unit = unit.to_owned();
    plot.height = 260;
    plot.curves.push(Curve::line("closed form", "soft", of(|c| c.bound)).dashed());
    plot.curves.push(Curve::line("simulated", "trace", of(|c| c.simulated.value)));
    plot.curves.push(Curve::dots("each", "trace", of(|c| c.simulated.value)));
    if let Some(least) = required {
        plot.curves.push(Curve::line("required", "c1", vec![least; changed.len()]).dashed());
    }
    plot
}
