//! What a capacity says of its result, for people and in JSON.

use crate::base::number::{duration, fixed};
use crate::capacity::explore::{Cause, Cost};
use crate::capacity::{Bounds, Mean, Measured, Settings, Sorter, limit_words, most_words};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

/// What was found, as in `capacity.json`.
#[derive(Serialize, JsonSchema)]
#[schemars(title = "lss capacity")]
pub struct Found<'a> {
    layout: &'a str,
    carriers: usize,
    /// m
    pitch_m: f64,
    speed_m_s: f64,
    carriers_per_hour: f64,
    /// Closed form, in the proportions in which items come, or in any where an induction always has items; with waves the mean
    /// over them.
    bound_per_hour: f64,
    limited_by: String,
    #[serde(skip)]
    most: &'static str,
    /// Closed form in any proportions; absent where `bound_per_hour` is that.
    #[serde(skip_serializing_if = "Option::is_none")]
    any_proportions: Option<AnyProportions>,
    /// The waves until they repeat; absent where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    waves: Vec<WaveRow<'a>>,
    required_per_hour: Option<f64>,
    hours: f64,
    replications: usize,
    seed: u64,
    /// What stops, failures and waves take from it with items at every induction at any time; absent where it has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    costs: Vec<CostRow>,
    /// With items at every induction at any time.
    always_fed: Simulated<'a>,
    /// With the items that the layout says come; absent where it says nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    as_fed: Option<Simulated<'a>>,
}

/// What replications showed.
#[derive(Serialize, JsonSchema)]
struct Simulated<'a> {
    per_hour: Mean,
    warm_up_s: f64,
    time_on_sorter_s: Mean,
    /// Laps in vain an item.
    unread: f64,
    /// At chutes that were full, down, and closed between two waves.
    refused: f64,
    #[serde(default, skip_serializing_if = "is_zero")]
    down: f64,
    #[serde(default, skip_serializing_if = "is_zero")]
    closed: f64,
    misplaced: f64,
    /// Items an hour in each wave; absent where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    waves_per_hour: Vec<f64>,
    inductions: Vec<InductionRow<'a>>,
    chutes: Vec<ChuteRow<'a>>,
}

/// The most however items come.
#[derive(Serialize, JsonSchema)]
struct AnyProportions {
    bound_per_hour: f64,
    limited_by: String,
    #[serde(skip)]
    most: &'static str,
}

#[derive(Serialize, JsonSchema)]
struct InductionRow<'a> {
    name: &'a str,
    s_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    comes_per_hour: Option<f64>,
    per_hour: f64,
    waits_s: f64,
    /// Items that wait at the end.
    queue: f64,
    /// Carriers in use before and behind it.
    used_before: f64,
    used_behind: f64,
    /// Share of time in which it works; absent where it does not fail.
    #[serde(skip_serializing_if = "Option::is_none")]
    available: Option<f64>,
}

#[derive(Serialize, JsonSchema)]
struct ChuteRow<'a> {
    name: &'a str,
    s_m: f64,
    per_hour: f64,
    /// Share of the items that came and found it full.
    refused: f64,
    /// Share of those that found it down; absent where it does not fail.
    #[serde(skip_serializing_if = "Option::is_none")]
    down: Option<f64>,
}

#[derive(Serialize, JsonSchema)]
struct WaveRow<'a> {
    /// Absent where all waves are alike.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<&'a str>,
    /// Closed form, changeover and all.
    bound_per_hour: f64,
    limited_by: String,
    /// With so many an hour no chute becomes full before the next wave; absent where chutes are never full.
    #[serde(skip_serializing_if = "Option::is_none")]
    fits_per_hour: Option<f64>,
    /// The chute with the largest share, and that share of the wave's items; where shares are drawn, the mean of the largest.
    busiest: &'a str,
    busiest_share: f64,
}

#[derive(Serialize, JsonSchema)]
struct CostRow {
    cause: &'static str,
    /// What fails.
    #[serde(skip_serializing_if = "Option::is_none")]
    of: Option<String>,
    /// Items an hour that the sorter would take more without it.
    per_hour: Mean,
    #[serde(skip)]
    words: String,
}

impl CostRow {
    fn new(cost: &Cost) -> Self {
        let (cause, of) = match &cost.cause {
            Cause::Stops => ("stops", None),
            Cause::Failures(name) => ("failures", Some(name.clone())),
            Cause::Changeover => ("changeover", None),
            Cause::Shares => ("shares", None),
        };
        CostRow { cause, of, per_hour: cost.per_hour, words: cause_words(&cost.cause) }
    }
}

/// What costs throughput, in words.
pub(super) fn cause_words(cause: &Cause) -> String {
    match cause {
        Cause::Stops => "stops of the sorter".to_owned(),
        Cause::Failures(name) => format!("failures of {name}"),
        Cause::Changeover => "changeovers between waves".to_owned(),
        Cause::Shares => "shares that differ from wave to wave".to_owned(),
    }
}

fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

impl<'a> Simulated<'a> {
    fn new(sorter: &'a Sorter, measured: &Measured) -> Self {
        let inductions = sorter.inductions.iter().enumerate().map(|(i, induction)| InductionRow {
            name: &induction.name,
            s_m: induction.s,
            comes_per_hour: induction.demand,
            per_hour: measured.inductions[i].0,
            waits_s: measured.inductions[i].1,
            queue: measured.queues[i],
            used_before: measured.used[i].0,
            used_behind: measured.used[i].1,
            available: induction.fails.as_ref().map(|_| measured.available[i]),
        });
        let chutes = sorter.chutes.iter().enumerate().map(|(c, chute)| ChuteRow {
            name: &chute.name,
            s_m: chute.s,
            per_hour: measured.chutes[c].0,
            refused: measured.chutes[c].1,
            down: chute.fails.as_ref().map(|_| measured.chutes_down[c]),
        });
        Simulated {
            per_hour: measured.throughput,
            warm_up_s: measured.warm_up,
            time_on_sorter_s: measured.time,
            unread: measured.unread,
            refused: measured.refused,
            down: measured.down,
            closed: measured.closed,
            misplaced: measured.misplaced,
            waves_per_hour: measured.waves.clone(),
            inductions: inductions.collect(),
            chutes: chutes.collect(),
        }
    }

    fn text(&self, how: &str, found: &Found) -> String {
        let Mean { value, half_width } = self.per_hour;
        let mut out = format!(
            "  simulated, {how}: {} ± {} items an hour (95 %, {} × {} h, the first {} left out)\n",
            fixed(value, 0),
            fixed(half_width, 0),
            found.replications,
            found.hours,
            duration(self.warm_up_s)
        );
        let _ = writeln!(
            out,
            "    {} s from coming to being given out; laps in vain an item: {} unread, {} refused{}; {} % given out elsewhere",
            fixed(self.time_on_sorter_s.value, 1),
            fixed(self.unread, 3),
            fixed(self.refused, 3),
            self.other_laps(),
            fixed(100.0 * self.misplaced, 2)
        );
        for row in &self.inductions {
            let waits = match row.comes_per_hour {
                Some(comes) if row.queue > 5.0 && row.queue > 0.01 * comes * found.hours => {
                    format!(
                        ", {} wait at the end: it does not keep up with {} an hour",
                        fixed(row.queue, 0),
                        fixed(comes, 0)
                    )
                }
                Some(_) => format!(", items wait {} s", fixed(row.waits_s, 1)),
                None => String::new(),
            };
            let works =
                row.available.map_or_else(String::new, |a| format!(", works {} % of the time", fixed(100.0 * a, 1)));
            let _ = writeln!(
                out,
                "    induction {}: {} an hour{waits}{works}; carriers in use {} % before it, {} % behind",
                row.name,
                fixed(row.per_hour, 0),
                fixed(100.0 * row.used_before, 0),
                fixed(100.0 * row.used_behind, 0)
            );
        }
        let mut full: Vec<&ChuteRow> = self.chutes.iter().filter(|chute| chute.refused > 0.005).collect();
        full.sort_by(|a, b| b.refused.total_cmp(&a.refused));
        for chute in full.iter().take(5) {
            let share = fixed(100.0 * chute.refused, 1);
            let _ = writeln!(out, "    chute {} is full for {share} % of its items", chute.name);
        }
        if full.len() > 5 {
            let _ = writeln!(out, "    and {} more chutes", full.len() - 5);
        }
        if self.waves_per_hour.len() > 1 {
            let each = found.waves.iter().zip(&self.waves_per_hour);
            let each: Vec<String> =
                each.map(|(w, n)| format!("{} {}", w.name.unwrap_or("all"), fixed(*n, 0))).collect();
            let _ = writeln!(out, "    an hour by wave: {}", each.join(", "));
        }
        out
    }

    /// Laps in vain for reasons that not every sorter has.
    fn other_laps(&self) -> String {
        let mut out = String::new();
        for (laps, why) in [(self.down, "at chutes that were down"), (self.closed, "in changeovers")] {
            if laps > 0.0 {
                let _ = write!(out, ", {} {why}", fixed(laps, 3));
            }
        }
        out
    }
}

impl<'a> Found<'a> {
    pub fn new(
        layout: &'a str,
        sorter: &'a Sorter,
        bounds: &Bounds,
        required: Option<f64>,
        (fed, always): (Option<&Measured>, &Measured),
        costs: &[Cost],
        settings: &Settings,
    ) -> Self {
        let mut always_fed = Simulated::new(sorter, always);
        // Nobody waits where there always is an item.
        always_fed.inductions.iter_mut().for_each(|row| row.comes_per_hour = None);
        let bound = bounds.own();
        let any_proportions = bounds.as_fed.as_ref().map(|_| AnyProportions {
            bound_per_hour: bounds.any.throughput,
            limited_by: limit_words(sorter, bounds.any.limit),
            most: most_words(sorter, &bounds.any),
        });
        let each = sorter.waves.as_ref().map_or(&[][..], |waves| &waves.each);
        let waves = bound.waves.iter().enumerate().map(|(k, wave)| WaveRow {
            name: each.get(k).map(|wave| wave.name.as_str()),
            bound_per_hour: wave.throughput,
            limited_by: limit_words(sorter, wave.limit),
            fits_per_hour: wave.fits.is_finite().then_some(wave.fits),
            busiest: &sorter.chutes[wave.busiest].name,
            busiest_share: wave.share,
        });
        Found {
            layout,
            carriers: sorter.carriers,
            pitch_m: sorter.pitch,
            speed_m_s: sorter.speed,
            carriers_per_hour: sorter.carriers_per_hour(),
            bound_per_hour: bound.throughput,
            limited_by: limit_words(sorter, bound.limit),
            most: most_words(sorter, bound),
            any_proportions,
            waves: waves.collect(),
            required_per_hour: required,
            hours: settings.hours,
            replications: settings.replications,
            seed: settings.seed,
            costs: costs.iter().map(CostRow::new).collect(),
            always_fed,
            as_fed: fed.map(|fed| Simulated::new(sorter, fed)),
        }
    }

    /// For people.
    pub fn text(&self) -> String {
        let mut out = format!(
            "{}\n  {} carriers at {} m/s: {} an hour pass a place\n  closed form: {} {} items an hour{}, limited by {}\n",
            self.layout,
            self.carriers,
            self.speed_m_s,
            fixed(self.carriers_per_hour, 0),
            self.most,
            fixed(self.bound_per_hour, 0),
            if self.any_proportions.is_some() { " in the proportions in which they come" } else { "" },
            self.limited_by
        );
        if let Some(any) = &self.any_proportions {
            let most = fixed(any.bound_per_hour, 0);
            let _ = writeln!(out, "    in any: {} {most}, limited by {}", any.most, any.limited_by);
        }
        for wave in self.waves.iter().filter(|_| self.waves.len() > 1) {
            let _ = writeln!(
                out,
                "    wave {}: {} {}; {} % of its items go to {}{}",
                wave.name.unwrap_or_default(),
                self.most,
                fixed(wave.bound_per_hour, 0),
                fixed(100.0 * wave.busiest_share, 1),
                wave.busiest,
                wave.fits_per_hour
                    .map_or_else(String::new, |fits| format!("; a chute is full with {}", fixed(fits, 0)))
            );
        }
        if let Some(fed) = &self.as_fed {
            let comes: f64 = fed.inductions.iter().filter_map(|row| row.comes_per_hour).sum();
            out += &fed.text(&format!("with the {} an hour that come", fixed(comes, 0)), self);
        }
        out += &self.always_fed.text("with items at every induction at any time", self);
        for cost in &self.costs {
            let Mean { value, half_width } = cost.per_hour;
            let _ = writeln!(
                out,
                "    without {}: {} ± {} an hour more",
                cost.words,
                fixed(value, 0),
                fixed(half_width, 0)
            );
        }
        out
    }
}
