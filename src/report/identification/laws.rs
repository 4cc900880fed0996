//! All laws on the same footing, by set point, and what that can show.

use super::name;
use crate::base::number::fixed;
use crate::chain_input::ContactLaw;
use crate::identify::groups::{RunGroup, quartiles};
use crate::identify::study::RunFit;
use crate::identify::{Parameter, damping};
use maud::{Markup, html};

pub fn comparison(laws: &[(ContactLaw, &[RunFit])], groups: &[RunGroup]) -> Markup {
    html! {
        h2 { "Laws" }
        p { "At equal stiffness, exponent and approach speed all laws but Kelvin and Voigt's are one law in other \
             coordinates: what χ one finds, "
            "another finds too, at another restitution. Their objectives can differ only where a restitution meets its \
             bound, and the spread of "
            "restitution over runs says how a law stretches its scale, not how well it describes the contact. Runs \
             that no bound stopped were therefore "
            "carried over through χ, and the others fitted anew from there." }
        @for group in groups {
            @if groups.len() > 1 { h3 { (group.short(groups)) ", " (group.set_point()) } }
            (table(laws, group))
        }
    }
}

fn table(laws: &[(ContactLaw, &[RunFit])], group: &RunGroup) -> Markup {
    html! {
        div.scroll { table {
            thead { tr {
                th { "law" } th { "median objective" } th { "fitted anew" } th { "restitutions at a bound" }
                @for p in Parameter::RESTITUTIONS { th { "median of " (short(p)) } th { "its quartile range" } }
                th { "χ at e = 0.6" }
            } }
            tbody {
                @for (law, fits) in laws {
                    (row(*law, &fits.iter().filter(|fit| group.has(&fit.run)).collect::<Vec<_>>()))
                }
            }
        } }
    }
}

fn row(law: ContactLaw, fits: &[&RunFit]) -> Markup {
    let of = |p: Parameter| fits.iter().filter_map(move |fit| fit.parameters.get(p.name())).filter(|e| e.fitted);
    let quarters = |p: Parameter| quartiles(of(p).map(|e| e.value));
    let held = Parameter::RESTITUTIONS.into_iter().flat_map(of).filter(|e| e.at_bound).count();
    let [_, objective, _] = quartiles(fits.iter().map(|fit| fit.objective));
    html! {
        tr {
            td { (name(law)) }
            td.number { (fixed(objective, 3)) }
            td.number { (fits.iter().filter(|fit| fit.carried_from.is_none()).count()) }
            td.number { (held) }
            @for [lower, median, upper] in Parameter::RESTITUTIONS.map(quarters) {
                @if median.is_finite() {
                    td.number { (fixed(median, 3)) } td.number { (fixed(upper - lower, 3)) }
                } @else {
                    td { "not fitted" } td {}
                }
            }
            td.number { (fixed(damping(law, 0.6), 3)) }
        }
    }
}

fn short(p: Parameter) -> String {
    p.name().trim_start_matches("restitution_").replace('_', " ")
}
