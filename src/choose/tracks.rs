//! The tracks that a choice is made on: one for each least radius and each number of equipment, and where the chain has to
//! close one for each length of cart and each travel of a take-up. Each is the best of the layout's own objective, with its
//! own proof.

use super::drive::Lap;
use super::settings::{Tell, Told};
use crate::base::parallel;
use crate::compiled::Compiled;
use crate::model::{Cart, Goal, Layout, Objective, Stands};
use crate::solve::{self, End, Options, Stage, Trade};

/// A track.
#[derive(Clone, Debug)]
pub struct Track {
    /// Least radius that was chosen, m; `None` where the layout's own holds.
    pub radius: Option<f64>,
    /// Length of cart that it closes for, m; `None` where any may be tried on it.
    pub length: Option<f64>,
    /// What its chain may leave over, m; `None` where the layout's own holds.
    pub left_over: Option<f64>,
    /// Numbers of equipment, one for each that is free.
    pub counts: Vec<usize>,
    /// What it is the best of, as far as is known.
    pub objective: Objective,
    /// The end of a trade whose radii it keeps.
    pub radii: Option<End>,
    pub compiled: Compiled,
    pub lap: Lap,
    /// Whether no track is better for that objective.
    pub proven: bool,
}

/// A track that there is not.
#[derive(Clone, Debug)]
pub struct NoTrack {
    /// The layout that was asked for, and how far its solve came.
    pub layout: Box<Layout>,
    pub stages: Vec<Stage>,
}

/// Carts that may be chosen: the layout's own where it leaves none open.
pub fn carts(layout: &Layout) -> Vec<&Cart> {
    match layout.choice.carts.is_empty() {
        true => vec![&layout.cart],
        false => layout.choice.carts.iter().map(|cart| &cart.item).collect(),
    }
}

/// What a track is asked for with.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// Least radius, m.
    radius: Option<f64>,
    /// Length of cart, m.
    length: Option<f64>,
    /// What the chain may leave over, m.
    left_over: Option<f64>,
    /// Numbers of equipment.
    counts: Vec<usize>,
}

/// All that are asked for, in the order of radii, lengths, what is left over, and numbers; for each length of cart where
/// that matters, beside where the chain has to close.
pub fn asked(layout: &Layout, by_cart: bool) -> Vec<Asked> {
    let radii: Vec<Option<f64>> = match layout.choice.radii.is_empty() {
        true => vec![None],
        false => layout.choice.radii.iter().copied().map(Some).collect(),
    };
    let mut lengths: Vec<Option<f64>> = vec![None];
    if (by_cart || layout.chain.closes_within.is_some()) && !layout.choice.carts.is_empty() {
        lengths = carts(layout).iter().map(|cart| Some(cart.length)).collect();
        lengths.sort_by(|a, b| a.unwrap_or(0.0).total_cmp(&b.unwrap_or(0.0)));
        lengths.dedup();
    }
    let numbers = layout.choice.counts.iter().fold(vec![Vec::new()], |all: Vec<Vec<usize>>, free| {
        let with = |known: &Vec<usize>, count: usize| known.iter().copied().chain([count]).collect();
        all.iter().flat_map(|known| free.counts.iter().map(move |count| with(known, *count))).collect()
    });
    // A take-up of more travel lets the track be another one, where it is not built as it is written.
    let mut slacks: Vec<Option<f64>> = vec![None];
    let moves = !layout.objective.terms.is_empty();
    if let Some(within) = layout.chain.closes_within.as_ref().filter(|_| moves) {
        slacks = layout.choice.take_ups.iter().map(|free| Some(free.item.travel.min(within.value))).collect();
        if slacks.is_empty() {
            slacks.push(Some(layout.take_up_travel().min(within.value)));
        }
        slacks.sort_by(|a, b| a.unwrap_or(0.0).total_cmp(&b.unwrap_or(0.0)));
        slacks.dedup();
    }
    let mut all = Vec::new();
    for radius in radii {
        for length in &lengths {
            for left_over in &slacks {
                let one = Asked { radius, length: *length, left_over: *left_over, counts: Vec::new() };
                all.extend(numbers.iter().map(|counts| Asked { counts: counts.clone(), ..one.clone() }));
            }
        }
    }
    all
}

/// Solves all tracks that are asked for, each for the layout's own objective.
pub fn tracks(layout: &Layout, options: &Options, told: Tell) -> (Vec<Track>, Vec<NoTrack>) {
    let asked = asked(layout, false);
    let alone = Options { threads: if asked.len() > 1 { 1 } else { options.threads }, ..*options };
    let solved = parallel::map(&asked, options.threads, |asked| {
        let layout = variant(layout, asked);
        let stages = solve::solve(&layout, &alone, &|_| ());
        told(Told::Track);
        let objective = layout.objective.clone();
        Track::new(asked, Compiled::new(layout, stages), (objective, None))
    });
    let (mut found, mut none) = (Vec::new(), Vec::new());
    for track in solved {
        match track {
            Ok(track) => found.push(track),
            Err(no) => none.push(no),
        }
    }
    (found, none)
}

/// Tracks that trade length, cost, total price and polygon action, of each that is asked for: between the first ends, and the
/// best of each of the second ones alone.
pub fn traded(
    layout: &Layout,
    (ends, alone): (&[End], &[End]),
    by_cart: bool,
    options: &Options,
    watch: solve::Tell,
) -> Vec<Track> {
    let asked = asked(layout, by_cart);
    let own = Options { threads: if asked.len() > 1 { 1 } else { options.threads }, ..*options };
    let found = parallel::map(&asked, options.threads, |asked| {
        let layout = variant(layout, asked);
        let trades = solve::pareto(&layout, ends, alone, &own, watch);
        let track = |trade: Trade| {
            let counts = trade.objective.weight(Goal::Cost).is_some();
            // Whatever it is the best of, its pieces are bought for the least money.
            let bought = if counts { trade.objective.clone() } else { solve::objective(&layout, End::Cost) };
            let compiled = Compiled::new(Layout { objective: bought, ..layout.clone() }, trade.stages);
            Track::new(asked, compiled, (trade.objective, trade.radii)).ok()
        };
        trades.into_iter().filter_map(track).collect::<Vec<_>>()
    });
    found.into_iter().flatten().collect()
}

impl Track {
    /// A track that was asked for so; none where the layout is not feasible, climbs where it may not, has a chain that does
    /// not close as it has to, or no room for its equipment.
    fn new(asked: &Asked, compiled: Compiled, (objective, radii): (Objective, Option<End>)) -> Result<Self, NoTrack> {
        let unbuildable = compiled.heights.iter().any(crate::diagnostic::Diagnostic::is_error);
        let within = compiled.layout.chain.closes_within.map(|within| within.value);
        let closes = within.is_none_or(|within| compiled.chain.is_some_and(|fit| fit.is_within(within)));
        if compiled.failed() || unbuildable || !closes || !compiled.placement.is_whole() {
            return Err(NoTrack { layout: Box::new(compiled.layout), stages: compiled.stages });
        }
        Ok(Track {
            radius: asked.radius,
            length: asked.length,
            left_over: asked.left_over,
            counts: asked.counts.clone(),
            objective,
            radii,
            lap: Lap::new(&compiled.space.line),
            proven: compiled.stages.last().and_then(|s| s.certificate.as_ref()).is_some_and(|c| c.proven),
            compiled,
        })
    }
}

/// The layout as it is asked for.
fn variant(layout: &Layout, asked: &Asked) -> Layout {
    let mut variant = layout.clone();
    if let Some((within, left_over)) = variant.chain.closes_within.as_mut().zip(asked.left_over) {
        within.value = left_over;
    }
    if let Some(radius) = asked.radius {
        variant.radii.value.low = radius;
    }
    if let Some(length) = asked.length {
        let near = carts(layout).into_iter().find(|cart| cart.length == length);
        if let Some(cart) = near {
            variant.chain.tension = layout.tension_with(cart);
            variant.cart = cart.clone();
            variant.count_total_price();
        }
    }
    for (free, number) in layout.choice.counts.iter().zip(&asked.counts) {
        for &index in &free.declared {
            if let Stands::Free { count, .. } = &mut variant.equipment.declared[index].stands {
                *count = *number;
            }
        }
    }
    // Rows of motors are chosen anew: the old ones keep no room.
    if !layout.choice.motors.is_empty() {
        variant.equipment.motors = crate::model::Motors::Evenly { count: 0 };
    }
    variant
}
