//! What a choice says of its result, for people, in JSON and as a table.

use crate::base::number::{fixed, normal, trimmed};
use crate::base::words::counted;
use crate::capacity::Mean;
use crate::choose::refused::{failures, limited, mean_words, simulated_words, words};
use crate::choose::{Candidate, Check, Chosen, Measure, Requirement, write};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Candidates that are told of, the cheapest first, and those of them that failed their checks.
const TOLD: usize = 10;
const FAILED: usize = 3;

/// As in `choice.json`.
#[derive(Serialize, JsonSchema)]
#[schemars(title = "lss choose")]
pub struct Found {
    layout: String,
    /// Candidates that were worked out, and those of them that do what is required.
    candidates: usize,
    feasible: usize,
    /// Tracks that they are on, those that are proven best for the layout's objective, and those that there are none of.
    tracks: usize,
    tracks_proven: usize,
    tracks_missing: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    choice: Option<Row>,
    /// The lines that say the choice.
    lines: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    check: Option<Checked>,
    /// Cheaper ones that failed their checks: in the simulation of the capacity, and in the dynamic model.
    failed_checks: Vec<FailedCheck>,
    /// The cheapest ones by closed form, without those that failed a check; the choice itself was checked, the others were not.
    cheapest: Vec<Row>,
    requirements: Vec<RequirementRow>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pareto: Option<Trade>,
}

#[derive(Serialize, JsonSchema)]
pub(super) struct Row {
    pub(super) cart: String,
    pub(super) cart_length_m: f64,
    pub(super) carts: usize,
    pub(super) left_over_mm: f64,
    pub(super) speed_m_s: f64,
    pub(super) motor: String,
    pub(super) motors: usize,
    /// Take-up and sensor, where they were free.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) take_up: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sensor: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) least_radius_m: Option<f64>,
    /// Numbers of equipment that were free.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) equipment: BTreeMap<String, usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) capacity_per_hour: Option<f64>,
    /// Simulated, with items at every induction at any time: a mean and half its interval of 95 %. Absent where no
    /// capacity is required, and where it was not simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) simulated_per_hour: Option<Mean>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) limited_by: Option<String>,
    pub(super) length_m: f64,
    pub(super) footprint_m2: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) polygon_action_mm: Option<f64>,
    pub(super) price_eur: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) energy_kwh_per_year: Option<f64>,
    pub(super) total_eur: f64,
    thrust_n: Forces,
}

/// Thrust of all motors together, N.
#[derive(Serialize, JsonSchema)]
struct Forces {
    rolling: f64,
    curves: f64,
    air: f64,
    climbs: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    starting: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stopping: Option<f64>,
    /// Of the motors that are not spare.
    available: f64,
}

#[derive(Serialize, JsonSchema)]
struct Checked {
    thrust_n: f64,
    speed_m_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    spare_speed_m_s: Option<f64>,
    parts: Vec<PartRow>,
    /// Largest force that a load cell of the sensor cart measures, where the sensor has a range; as `rated_n`.
    #[serde(skip_serializing_if = "Option::is_none")]
    load_cell: Option<PartRow>,
}

#[derive(Serialize, JsonSchema)]
struct PartRow {
    part: &'static str,
    peak_n: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    rated_n: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    life_years: Option<f64>,
}

#[derive(Serialize, JsonSchema)]
struct FailedCheck {
    choice: String,
    why: String,
}

#[derive(Serialize, JsonSchema)]
struct RequirementRow {
    requirement: &'static str,
    /// Candidates that fall short of it.
    missed_by: usize,
    /// What it adds to the least total.
    #[serde(skip_serializing_if = "Option::is_none")]
    costs_eur: Option<f64>,
}

/// Candidates that no other one beats.
#[derive(Serialize, JsonSchema)]
struct Trade {
    measures: Vec<Measure>,
    rows: Vec<TradeRow>,
}

#[derive(Serialize, JsonSchema)]
struct TradeRow {
    values: Vec<f64>,
    choice: String,
}

/// What a requirement is called.
pub fn name(requirement: Requirement) -> &'static str {
    match requirement {
        Requirement::Capacity => "capacity",
        Requirement::Closes => "chain closes",
        Requirement::Tension => "chain tension",
        Requirement::Starts => "start-up time",
        Requirement::Stops => "stopping time",
        Requirement::Spare => "spare motors",
        Requirement::Load => "load",
        Requirement::Room => "room for motors",
        Requirement::Motors => "motors",
    }
}

impl Row {
    pub(super) fn new(chosen: &Chosen, c: &Candidate) -> Self {
        let (cart, motor, track) = (chosen.cart(c), chosen.motor(c), chosen.track(c));
        let on = &chosen.fitted[c.fitted];
        let (rounded, resistance) = (|x: f64| normal((x * 1e3).round() / 1e3), &c.thrust.resistance);
        let spare = chosen.layout.choice.drive.spare;
        Row {
            cart: cart.name.clone(),
            cart_length_m: cart.length,
            carts: on.fit.map_or(0, |fit| fit.carts),
            left_over_mm: on.fit.map_or(0.0, |fit| rounded(fit.left_over * 1e3)),
            speed_m_s: c.speed,
            motor: motor.name.clone(),
            motors: c.motors,
            take_up: chosen.take_up(c).map(|take_up| take_up.written.clone()),
            sensor: chosen.sensor(c).map(|sensor| sensor.written.clone()),
            least_radius_m: track.radius,
            equipment: chosen.numbers(c).into_iter().map(|(name, count)| (name.to_owned(), count)).collect(),
            capacity_per_hour: c.capacity.as_ref().map(|bound| rounded(bound.throughput)),
            simulated_per_hour: chosen
                .takes(c)
                .map(|mean| Mean { value: rounded(mean.value), half_width: rounded(mean.half_width) }),
            limited_by: limited(chosen, c),
            length_m: rounded(track.compiled.length()),
            footprint_m2: rounded(track.compiled.footprint),
            polygon_action_mm: on.polygon_action.map(|x| rounded(x * 1e3)),
            price_eur: c.price,
            energy_kwh_per_year: chosen.layout.choice.energy.map(|_| rounded(c.energy / 3.6e6)),
            total_eur: rounded(c.total),
            thrust_n: Forces {
                rolling: rounded(resistance.rolling),
                curves: rounded(resistance.curves),
                air: rounded(resistance.air),
                climbs: rounded(resistance.climbs),
                starting: c.thrust.starting.map(rounded),
                stopping: c.thrust.stopping.map(rounded),
                available: c.motors.saturating_sub(spare) as f64 * motor.force,
            },
        }
    }
}

impl Checked {
    fn new(check: &Check) -> Self {
        let rounded = |x: f64| normal((x * 1e3).round() / 1e3);
        let part = |part: &crate::choose::Carried| PartRow {
            part: part.part,
            peak_n: rounded(part.peak),
            rated_n: part.rated,
            life_years: part.life.filter(|life| life.is_finite()).map(rounded),
        };
        Checked {
            thrust_n: rounded(check.thrust),
            speed_m_s: rounded(check.speed),
            spare_speed_m_s: check.spare_speed.map(rounded),
            parts: check.carried.iter().map(part).collect(),
            load_cell: check.measured.map(|(peak, range)| PartRow {
                part: "load cell",
                peak_n: rounded(peak),
                rated_n: Some(range),
                life_years: None,
            }),
        }
    }
}

/// What the checks of a candidate say: `passed`, or why it failed; `None` where it was not checked.
pub(super) fn outcome(chosen: &Chosen, k: usize) -> Option<String> {
    if let Some(short) = chosen.falls_short(&chosen.candidates[k]) {
        return Some(simulated_words(short));
    }
    let (_, found) = chosen.checked.iter().find(|(other, _)| *other == k)?;
    Some(match found {
        Err(why) => why.clone(),
        Ok(check) if check.passes() => "passed".to_owned(),
        Ok(check) => failures(check).join("; "),
    })
}

/// Candidates that failed a check, with why, in the order in which they were checked.
pub(super) fn failed(chosen: &Chosen) -> Vec<(String, String)> {
    let of = |k: &usize| &chosen.candidates[*k];
    let looked_at = chosen.short.iter().copied().chain(chosen.checked.iter().map(|(k, _)| *k));
    let looked_at = looked_at.filter(|k| Some(*k) != chosen.winner);
    let mut all: Vec<(usize, String)> = looked_at.filter_map(|k| Some((k, outcome(chosen, k)?))).collect();
    all.sort_by(|a, b| of(&a.0).total.total_cmp(&of(&b.0).total).then(a.0.cmp(&b.0)));
    all.into_iter().map(|(k, why)| (words(chosen, of(&k)), why)).collect()
}

impl Found {
    pub fn new(chosen: &Chosen, measures: &[Measure], trade: Option<&[(usize, Vec<f64>)]>) -> Self {
        let winner = chosen.winner.map(|k| &chosen.candidates[k]);
        let check = chosen.checked.iter().find(|(k, _)| Some(*k) == chosen.winner);
        Found {
            layout: chosen.layout.name.clone(),
            candidates: chosen.worked_out,
            feasible: chosen.feasible,
            tracks: chosen.tracks.len(),
            tracks_proven: chosen.tracks.iter().filter(|track| track.proven).count(),
            tracks_missing: chosen.untracked.len(),
            choice: winner.map(|c| Row::new(chosen, c)),
            lines: winner
                .and_then(|c| write::lines(chosen, c))
                .map_or_else(Vec::new, |lines| lines.all().into_iter().map(str::to_owned).collect()),
            check: check.and_then(|(_, found)| found.as_ref().ok()).map(Checked::new),
            failed_checks: failed(chosen).into_iter().map(|(choice, why)| FailedCheck { choice, why }).collect(),
            cheapest: chosen.cheapest().take(TOLD).map(|k| Row::new(chosen, &chosen.candidates[k])).collect(),
            requirements: chosen
                .costs
                .iter()
                .map(|(requirement, cost)| RequirementRow {
                    requirement: name(*requirement),
                    missed_by: chosen.missed_by(*requirement),
                    costs_eur: cost.filter(|cost| cost.is_finite()).map(|cost| normal((cost * 100.0).round() / 100.0)),
                })
                .collect(),
            pareto: trade.map(|rows| Trade {
                measures: measures.to_vec(),
                rows: rows
                    .iter()
                    .map(|(k, values)| TradeRow {
                        values: values.iter().map(|x| normal((x * 1e4).round() / 1e4)).collect(),
                        choice: words(chosen, &chosen.candidates[*k]),
                    })
                    .collect(),
            }),
        }
    }

    /// For people.
    pub fn text(&self, chosen: &Chosen) -> String {
        let mut out = format!("{}\n", self.layout);
        if let (Some(row), Some(winner)) = (&self.choice, chosen.winner) {
            out += &self.told(row, &chosen.candidates[winner], chosen);
        }
        self.others(&mut out, chosen);
        if let Some(trade) = &self.pareto {
            out += &trade.text();
        }
        if !self.lines.is_empty() {
            out += "  in the place of what is free:\n";
            for line in &self.lines {
                let _ = writeln!(out, "    {line}");
            }
        }
        out
    }

    fn told(&self, row: &Row, candidate: &Candidate, chosen: &Chosen) -> String {
        let mut out = format!("  {}\n", words(chosen, candidate));
        let _ = writeln!(
            out,
            "  {} carts, {} mm left over, track {} m, footprint {} m²",
            row.carts,
            fixed(row.left_over_mm, 1),
            fixed(row.length_m, 3),
            fixed(row.footprint_m2, 1)
        );
        if let (Some(capacity), Some(limit)) = (row.capacity_per_hour, &row.limited_by) {
            let required = chosen.layout.capacity.required.as_ref();
            let asked = required.map_or_else(String::new, |r| format!(" ({} required)", fixed(r.least.value, 0)));
            let _ = writeln!(out, "  at most {} items an hour{asked}, limited by {limit}", fixed(capacity, 0));
        }
        if let Some(simulated) = row.simulated_per_hour {
            let _ = writeln!(
                out,
                "  simulated {} items an hour, with items at every induction at any time",
                mean_words(simulated)
            );
        }
        let thrust = &row.thrust_n;
        let times = &chosen.layout.choice.drive;
        let mut parts = vec![format!(
            "{} N running (rolling {}, curves {}, air {}, climbs {})",
            fixed(candidate.thrust.resistance.most(), 0),
            fixed(thrust.rolling, 0),
            fixed(thrust.curves, 0),
            fixed(thrust.air, 0),
            fixed(thrust.climbs, 0)
        )];
        let timed = [(thrust.starting, &times.starts, "start"), (thrust.stopping, &times.stops, "stop")];
        for (force, time, what) in timed {
            if let (Some(force), Some(time)) = (force, time) {
                parts.push(format!("{} N to {what} in {} s", fixed(force, 0), trimmed(time.value, 3)));
            }
        }
        let spare = if times.spare > 0 { format!(" with {} out of order", times.spare) } else { String::new() };
        let _ = writeln!(out, "  thrust: {}; motors give {} N{spare}", parts.join(", "), fixed(thrust.available, 0));
        let mut price = format!("  price {} EUR", fixed(row.price_eur, 2));
        if let (Some(energy), Some(used)) = (row.energy_kwh_per_year, &chosen.layout.choice.energy) {
            let _ = write!(
                price,
                "; energy {} kWh and {} EUR a year; {} EUR over {} years",
                fixed(energy, 0),
                fixed(energy * 3.6e6 * used.price, 0),
                fixed(row.total_eur, 0),
                trimmed(used.years, 2)
            );
        }
        out += &price;
        out.push('\n');
        if let Some(check) = &self.check {
            out += &check.text();
        }
        out
    }

    fn others(&self, out: &mut String, chosen: &Chosen) {
        let _ = writeln!(
            out,
            "  {}, all worked out, on {}, {} of them proven best; {} {} what is required",
            counted(self.candidates, "candidate"),
            counted(self.tracks, "track"),
            self.tracks_proven,
            self.feasible,
            if self.feasible == 1 { "does" } else { "do" }
        );
        if self.tracks_missing > 0 {
            let _ = writeln!(
                out,
                "  {} more that {} asked for cannot be built",
                counted(self.tracks_missing, "track"),
                if self.tracks_missing == 1 { "was" } else { "were" }
            );
        }
        for failed in self.failed_checks.iter().take(FAILED) {
            let than = if chosen.winner.is_some() { "cheaper, but fails its check" } else { "fails its check" };
            let _ = writeln!(out, "  {than}: {}: {}", failed.choice, failed.why);
        }
        if self.failed_checks.len() > FAILED {
            let _ = writeln!(out, "  and {} more that fail their checks", self.failed_checks.len() - FAILED);
        }
        if let Some((winner, next)) = chosen.winner.zip(chosen.next_best()) {
            let next = &chosen.candidates[next];
            let more = next.total - chosen.candidates[winner].total;
            let _ = writeln!(
                out,
                "  next best by closed form, not checked, {} EUR more: {}",
                fixed(more, 2),
                words(chosen, next)
            );
        }
        for row in &self.requirements {
            let costs = match row.costs_eur {
                Some(costs) if chosen.winner.is_some() => format!(", costs {} EUR by closed form", fixed(costs, 2)),
                _ => String::new(),
            };
            if row.missed_by > 0 || row.costs_eur.is_some_and(|costs| costs > 0.005) {
                let missed = counted(row.missed_by, "candidate");
                let _ = writeln!(out, "  {}: missed by {missed}{costs}", row.requirement);
            }
        }
    }
}

impl Checked {
    fn text(&self) -> String {
        let part = |part: &PartRow| {
            let rated = part.rated_n.map_or_else(String::new, |rated| format!(" of {} N", fixed(rated, 0)));
            let life = part.life_years.map_or_else(String::new, |life| format!(", lives {}", years(life)));
            format!("{} {} N{rated}{life}", part.part, fixed(part.peak_n, 0))
        };
        let parts: Vec<String> = self.parts.iter().chain(&self.load_cell).map(part).collect();
        let spare = self
            .spare_speed_m_s
            .map_or_else(String::new, |speed| format!(", {} m/s with the spare motors out of order", fixed(speed, 3)));
        format!(
            "  simulated: thrust {} N, {} m/s{spare}\n    {}\n",
            fixed(self.thrust_n, 0),
            fixed(self.speed_m_s, 3),
            parts.join("; ")
        )
    }
}

/// `12 years`; beyond a thousand nobody counts.
fn years(life: f64) -> String {
    if life > 1000.0 { "over 1000 years".to_owned() } else { format!("{} years", trimmed(life, 1)) }
}

impl Trade {
    fn text(&self) -> String {
        let names: Vec<&str> = self.measures.iter().map(|m| m.words().0).collect();
        let mut out =
            format!("  {} that no other one beats in {}\n", counted(self.rows.len(), "choice"), names.join(", "));
        let heads = self.measures.iter().map(|m| format!("{:>20}", format!("{}, {}", m.words().0, m.words().1)));
        let _ = writeln!(out, "  {}", heads.collect::<String>());
        for row in &self.rows {
            let cells = row.values.iter().zip(&self.measures);
            let cells = cells.map(|(value, m)| format!("{:>20}", fixed(*value, m.words().2)));
            let _ = writeln!(out, "  {}  {}", cells.collect::<String>(), row.choice);
        }
        out
    }
}
