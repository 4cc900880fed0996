//! Fits as a terminal shows them.

use crate::base::number::fixed;
use crate::identify::Parameter;
use crate::identify::groups::{RunGroup, quartiles};
use crate::identify::reports::LawReport;
use crate::identify::study::RunFit;
use crate::report::identification::digits;
use std::fmt::Write;

/// Runs up to this many are shown one by one.
const ONE_BY_ONE: usize = 3;

/// All laws.
pub fn text(laws: &[LawReport], groups: &[RunGroup]) -> String {
    let mut out = String::new();
    for law in laws {
        let carried = law.runs.values().find_map(|f| f.carried_from).is_some();
        let note = if carried { ", carried over through χ where no bound was met" } else { "" };
        if law.runs.is_empty() {
            let _ = writeln!(out, "{}: no run could be fitted\n", law.law);
            continue;
        }
        let _ = writeln!(out, "{}: objective {}{note}", law.law, fixed(law.objective, 3));
        if law.runs.len() <= ONE_BY_ONE {
            law.runs.values().for_each(|fit| out.push_str(&run(fit)));
        } else {
            groups.iter().for_each(|group| out.push_str(&summary(law, group)));
        }
        for (name, estimate) in &law.shared {
            let _ = writeln!(
                out,
                "  shared {name:<26}{:>11}  {} to {}",
                digits(estimate.value),
                digits(estimate.low),
                digits(estimate.high)
            );
        }
        out.push('\n');
    }
    out
}

fn run(fit: &RunFit) -> String {
    let mut out = String::new();
    let _ = writeln!(
        out,
        "  {}: objective {}, {} laps, {} simulations",
        fit.run,
        fixed(fit.objective, 3),
        fixed(fit.laps, 2),
        fit.simulations
    );
    let _ = writeln!(out, "    {:<26}{:>11}  90 % interval", "parameter", "value");
    for p in Parameter::ALL {
        let Some(e) = fit.parameters.get(p.name()) else { continue };
        let interval = if e.fitted { format!("{} to {}", digits(e.low), digits(e.high)) } else { "not fitted".into() };
        let mut notes = Vec::new();
        if e.at_bound {
            notes.push("at its bound".to_owned());
        }
        if let (Some(chi), Some(real)) = (fit.damping.get(p.name()), fit.achieved.get(p.name())) {
            notes.push(format!("damping {}, achieves {}", fixed(*chi, 3), fixed(*real, 3)));
        }
        let unit = if p.unit().is_empty() { String::new() } else { format!("{} ", p.unit()) };
        let line = format!("    {:<26}{:>11}  {interval:<24}{unit}{}", p.name(), digits(e.value), notes.join(", "));
        let _ = writeln!(out, "{}", line.trim_end());
    }
    if !fit.nrmsd.is_empty() {
        let all: Vec<String> = fit.nrmsd.iter().map(|(c, x)| format!("{c} {}", fixed(100.0 * x, 1))).collect();
        let _ = writeln!(out, "    NRMSD of a simulated lap, %: {}", all.join(", "));
    }
    if !fit.misfits.is_empty() {
        let all: Vec<String> = fit.misfits.iter().map(|(c, x)| format!("{c} ({})", fixed(*x, 1))).collect();
        let _ = writeln!(out, "    over twice the repeatability: {}", all.join("; "));
    }
    for line in &fit.identifiability {
        let _ = writeln!(out, "    {line}");
    }
    out
}

/// Median, quartiles and bounds met over the runs of a group.
fn summary(law: &LawReport, group: &RunGroup) -> String {
    let fits: Vec<&RunFit> = law.of(group).collect();
    if fits.is_empty() {
        return String::new();
    }
    let bad = fits.iter().filter(|fit| !fit.fits()).count();
    let not = if bad > 0 { format!(", {bad} not fitted") } else { String::new() };
    let [_, objective, _] = quartiles(fits.iter().map(|fit| fit.objective));
    let runs = if fits.len() == 1 { "run" } else { "runs" };
    let mut out = String::new();
    let _ = writeln!(
        out,
        "  {} at {}: {} {runs}, median objective {}{not}",
        group.layout,
        group.set_point(),
        fits.len(),
        fixed(objective, 3)
    );
    let _ = writeln!(out, "    {:<26}{:>11}{:>11}{:>11}", "parameter", "median", "quartile", "quartile");
    for p in Parameter::ALL {
        let all: Vec<_> = fits.iter().filter_map(|f| f.parameters.get(p.name())).collect();
        let bound = all.iter().filter(|e| e.at_bound).count();
        let note = if bound > 0 { format!("{bound} at a bound") } else { String::new() };
        let [low, middle, high] = quartiles(all.iter().map(|e| e.value)).map(digits);
        let line = format!("    {:<26}{middle:>11}{low:>11}{high:>11}  {note}", p.name());
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out
}

/// What a run can tell, before it is fitted.
pub fn identifiability(fit: &RunFit) -> String {
    let mut out = format!("{}: {} laps\n", fit.run, fixed(fit.laps, 2));
    for p in Parameter::ALL {
        let Some(e) = fit.parameters.get(p.name()).filter(|e| e.fitted) else { continue };
        let _ = writeln!(out, "  {:<26}would be known to {} {}", p.name(), digits(0.5 * (e.high - e.low)), p.unit());
    }
    for line in &fit.identifiability {
        let _ = writeln!(out, "  {line}");
    }
    out
}
