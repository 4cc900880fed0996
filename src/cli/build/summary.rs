//! What a build says of its result, for people and in JSON.

use super::routed::{RouteSummary, Routed};
use crate::base::words::list;
use crate::compiled::Compiled;
use crate::compiled::order::{self, Total};
use crate::emit::pareto::Pareto;
use crate::kinematics::Fit;
use crate::model::Layout;
use crate::solve::{self, Certificate, Counted, Part};
use crate::source::shown;
use serde::Serialize;
use std::path::Path;

/// The summary in JSON.
#[derive(Serialize)]
pub struct Summary<'a> {
    /// The layout's file, and the folder of its outputs, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<String>,
    layout: &'a str,
    stages: Vec<StageSummary<'a>>,
    length_m: f64,
    /// Whether the layout has heights, so that this is along the slope.
    #[serde(skip)]
    raised: bool,
    footprint_m2: f64,
    element_count: usize,
    closure_m: f64,
    closure_rad: f64,
    price_eur: f64,
    /// Elements and everything beside them that has a price.
    total_eur: f64,
    mass_kg: f64,
    feasible: bool,
    /// What ended the search before it was done.
    #[serde(skip_serializing_if = "Option::is_none")]
    cut: Option<solve::Cut>,
    certificate: Option<CertificateSummary<'a>>,
    /// The same for people.
    #[serde(skip)]
    proven: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    route: Option<RouteSummary<'a>>,
    chain: Option<ChainSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    equipment: Option<EquipmentSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pareto: Option<&'a Pareto>,
    /// The price of the whole for people.
    #[serde(skip)]
    total: Total,
}

/// What is proven of the last stage's layout.
#[derive(Serialize)]
struct CertificateSummary<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    lower_bound_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lower_bound_eur: Option<f64>,
    /// Before the price of each piece is rounded to the cent.
    #[serde(skip_serializing_if = "Option::is_none")]
    value_eur: Option<f64>,
    /// What each metre counts beside the price.
    #[serde(skip_serializing_if = "Option::is_none")]
    eur_per_metre: Option<f64>,
    gap: f64,
    proven: bool,
    nodes: usize,
    seconds: f64,
    parts: &'a [Part],
    assumed: &'a [String],
    /// What only layouts within a budget were compared by.
    #[serde(skip_serializing_if = "Option::is_none")]
    budget: Option<&'a str>,
}

/// How a whole number of carts fits.
#[derive(Serialize)]
struct ChainSummary {
    carts: usize,
    left_over_mm: f64,
    take_up_mm: f64,
}

/// Equipment of declared kinds, with the conveyors that feed it.
#[derive(Serialize)]
struct EquipmentSummary {
    count: usize,
    missing: usize,
    price_eur: f64,
    conveyors_m: f64,
    conveyors_eur: f64,
    /// No places on this track need cheaper conveyors.
    conveyors_lower_bound_eur: f64,
    /// With the track's elements, where that is what was minimised.
    #[serde(skip)]
    with_track: Option<f64>,
}

impl EquipmentSummary {
    fn of(compiled: &Compiled) -> Option<Self> {
        let found = &compiled.placement;
        (!compiled.layout.equipment.declared.is_empty()).then(|| EquipmentSummary {
            count: found.placed.len(),
            missing: found.missing.iter().map(|(_, n)| n).sum(),
            price_eur: found.equipment,
            conveyors_m: found.placed.iter().filter_map(|p| p.conveyor).sum(),
            conveyors_eur: found.conveyors,
            conveyors_lower_bound_eur: found.bound,
            with_track: compiled.stages.last().and_then(|last| {
                let certificate = last.certificate.as_ref()?;
                let counts = certificate.counted == (Counted::Price { metre: 0.0 }) && !certificate.in_all;
                counts.then(|| compiled.bill.price + found.price())
            }),
        })
    }

    fn text(&self) -> String {
        let pieces = if self.count == 1 { "piece" } else { "pieces" };
        let mut out = format!("  {} {pieces} of equipment, {:.2} EUR", self.count, self.price_eur);
        if self.conveyors_m > 0.0 {
            out += &format!("; {:.2} m of conveyors, {:.2} EUR", self.conveyors_m, self.conveyors_eur);
            out += &match self.conveyors_eur - self.conveyors_lower_bound_eur <= 0.005 {
                true => ", the least on this track".to_owned(),
                false => format!(", no less than {:.2} EUR on this track", self.conveyors_lower_bound_eur),
            };
        }
        if self.missing > 0 {
            out += &format!("; NO ROOM FOR {} MORE", self.missing);
        }
        if let Some(price) = self.with_track {
            out += &format!("; with the track {price:.2} EUR");
        }
        out + "\n"
    }
}

/// Parts without a price that are named.
const UNPRICED: usize = 8;

/// What the whole costs, where more than the track's elements has a price.
fn total_text(total: &Total) -> String {
    if total.groups.is_empty() {
        return String::new();
    }
    let beside = total.groups.iter().map(|(group, price)| format!("{} {price:.2}", group.name()));
    let mut out = format!("  {:.2} EUR in all: elements {:.2}", total.all, total.elements);
    for part in beside {
        out += &format!(", {part}");
    }
    if !total.unpriced.is_empty() {
        let more = total.unpriced.len().saturating_sub(UNPRICED);
        let mut told: Vec<String> = total.unpriced.iter().take(UNPRICED).cloned().collect();
        told.extend((more > 0).then(|| format!("{more} more, which the bill lists")));
        out += &format!("; without a price: {}", list(&told, "and"));
    }
    out + "\n"
}

#[derive(Serialize)]
struct StageSummary<'a> {
    name: &'a str,
    length_m: f64,
    max_violation_m: f64,
    iterations: usize,
    #[serde(skip_serializing_if = "crate::base::number::is_one")]
    starts: usize,
    seconds: f64,
    status: solve::Status,
}

impl<'a> Summary<'a> {
    pub fn new(compiled: &'a Compiled, pareto: Option<&'a Pareto>, routed: Option<&'a Routed>) -> Self {
        let stage = |s: &'a solve::Stage| StageSummary {
            name: s.name,
            length_m: s.length,
            max_violation_m: s.max_violation,
            iterations: s.iterations,
            starts: s.starts,
            seconds: s.seconds,
            status: s.status,
        };
        let total = order::total(compiled);
        let proven = compiled.stages.last().and_then(|s| s.certificate.as_ref());
        Summary {
            file: None,
            output: None,
            layout: &compiled.layout.name,
            stages: compiled.stages.iter().map(stage).collect(),
            length_m: compiled.length(),
            raised: compiled.raised(),
            footprint_m2: compiled.footprint,
            element_count: compiled.bill.count,
            closure_m: compiled.sequence.closure,
            closure_rad: compiled.sequence.closure_heading,
            price_eur: compiled.bill.price,
            total_eur: total.all,
            mass_kg: compiled.bill.mass,
            feasible: !compiled.failed(),
            cut: compiled.stages.last().and_then(|s| s.cut),
            certificate: proven.map(certificate),
            proven: proven.map(Certificate::words).unwrap_or_default(),
            route: routed.map(Routed::summary),
            chain: compiled.chain.map(|fit| chain(fit, &compiled.layout)),
            equipment: EquipmentSummary::of(compiled),
            pareto,
            total,
        }
    }

    /// The same of a file whose outputs go to a folder.
    #[must_use]
    pub fn of(self, file: &Path, output: Option<&Path>) -> Self {
        let path = |path: &Path| path.to_string_lossy().into_owned();
        Summary { file: Some(path(file)), output: output.map(path), ..self }
    }

    /// The summary for people.
    pub fn text(&self, output: Option<&Path>) -> String {
        let mut out = format!("{}\n", self.layout);
        for stage in &self.stages {
            let state = stage.status.words(self.cut.is_some());
            let starts = if stage.starts > 1 { format!(" from {} starts", stage.starts) } else { String::new() };
            out += &format!(
                "  {:<8} {:>12.5} m  {state}{starts}, violation {:.1e}, {} iterations, {:.3} s\n",
                stage.name, stage.length_m, stage.max_violation_m, stage.iterations, stage.seconds
            );
        }
        if self.cut == Some(solve::Cut::Time) {
            out += "  cut: time; this is the best layout so far, and more time may find a better one or prove more\n";
        }
        for line in &self.proven {
            out += &format!("  {line}\n");
        }
        if let Some(route) = &self.route {
            out += &route.text();
        }
        if let Some(chain) = &self.chain {
            let beyond = if chain.left_over_mm.abs() > chain.take_up_mm + 0.01 {
                format!(", beyond the take-up of {} mm", chain.take_up_mm)
            } else {
                String::new()
            };
            out += &format!("  {} carts, {:.1} mm left over{beyond}\n", chain.carts, chain.left_over_mm);
        }
        out += &format!(
            "  {} elements, {:.2} EUR, {:.1} kg, footprint {:.2} m², closes to {:.1e} m\n",
            self.element_count, self.price_eur, self.mass_kg, self.footprint_m2, self.closure_m
        );
        out += &self.equipment.as_ref().map_or_else(String::new, EquipmentSummary::text);
        out += &total_text(&self.total);
        if self.raised {
            out += &format!("  {:.5} m along the slope; stages count the plan\n", self.length_m);
        }
        if let Some(folder) = output {
            out += &format!("  written to {}\n", shown(folder));
        }
        out
    }
}

fn certificate(c: &Certificate) -> CertificateSummary<'_> {
    let price = match c.counted {
        Counted::Length => None,
        Counted::Price { metre } => Some(metre),
    };
    CertificateSummary {
        lower_bound_m: price.is_none().then_some(c.lower_bound),
        lower_bound_eur: price.map(|_| c.lower_bound),
        value_eur: price.map(|_| c.value),
        eur_per_metre: price.filter(|metre| *metre > 0.0),
        gap: c.gap,
        proven: c.proven,
        nodes: c.nodes,
        seconds: c.seconds,
        parts: &c.parts,
        assumed: &c.assumed,
        budget: c.budget.as_deref(),
    }
}

fn chain(fit: Fit, layout: &Layout) -> ChainSummary {
    let millimetres = |metres: f64| (metres * 1e6).round() / 1e3 + 0.0;
    ChainSummary {
        carts: fit.carts,
        left_over_mm: millimetres(fit.left_over),
        take_up_mm: millimetres(layout.take_up_travel()),
    }
}
