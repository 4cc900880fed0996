//! The fitted layouts: a `.lss` that changes only what was fitted, and its simulation input.

use crate::base::json;
use crate::base::number::{fixed, shortest};
use crate::chain_input::{ContactLaw, ContactParameters, Simulation, Wheel};
use crate::cli::{MessageFormat, Outcome, layouts, read};
use crate::identify::cases::Case;
use crate::identify::groups::{RunGroup, quartiles};
use crate::identify::lack_of_fit::at_bounds;
use crate::identify::study::RunFit;
use crate::identify::{Parameter, damping, restitution};
use crate::model::Layout;
use crate::source::root::is_marked;
use crate::source::{SIZE_LIMIT, root};
use std::fmt::Write;
use std::path::{Component, Path};

/// For each layout and set point of the campaign `NAME-fitted.json`, and `NAME-fitted.lss` where it came as `.lss`. The
/// set point is in the name where a layout has several.
pub fn files(
    cases: &[Case],
    groups: &[RunGroup],
    fits: &[RunFit],
    output: &Path,
) -> Result<Vec<(String, Vec<u8>)>, Outcome> {
    let mut out: Vec<(String, Vec<u8>)> = Vec::new();
    let names = layouts::names(cases.iter().map(|c| c.layout.as_path()), "-fitted");
    for group in groups {
        let own: Vec<&RunFit> = fits.iter().filter(|fit| group.has(&fit.run)).collect();
        let of_first = |first: &&RunFit| cases.iter().find(|case| case.subject.name == first.run);
        let Some((first, case)) = own.first().and_then(|first| Some((first, of_first(first)?))) else { continue };
        let mut simulation = first.input(&case.subject);
        for p in Parameter::ALL {
            let values = own.iter().filter_map(|fit| fit.parameters.get(p.name())).map(|e| e.value);
            let [_, middle, _] = quartiles(values);
            if middle.is_finite() {
                p.set(&mut simulation, middle);
            }
        }
        let Some(own_name) = names.get(&case.layout) else { continue };
        let name = name(own_name, group, groups);
        out.push((format!("{name}.json"), json::to_json(&simulation)));
        if case.layout.extension().is_some_and(|e| e == "lss") {
            let layout = read::read(&case.layout, None, MessageFormat::Text)?.layout;
            let (import, copy) = import(&case.layout, output, own_name);
            let copy = copy.map(|bytes| (import.clone(), bytes));
            out.extend(copy.filter(|copy| !out.contains(copy)));
            let shift = simulation.sensor.photocell_s_m - case.subject.simulation.sensor.photocell_s_m;
            let head = head(&layout, group, &own) + &law_note(simulation.contact_law);
            out.push((format!("{name}.lss"), (head + &text(&layout, &simulation, &import, shift)).into_bytes()));
        }
    }
    Ok(out)
}

/// What a group's fitted files are called, after what its layout is.
fn name(layout: &str, group: &RunGroup, groups: &[RunGroup]) -> String {
    let alone = groups.iter().filter(|g| g.layout == group.layout).count() == 1;
    let part = if alone { String::new() } else { format!("-{}", group.file_part()) };
    format!("{layout}{part}-fitted")
}

/// What the file is, and whether its values may be believed.
fn head(layout: &Layout, group: &RunGroup, fits: &[&RunFit]) -> String {
    let runs = fits.len();
    let mut out = format!(
        "// `{}` at {} with the parameters that {runs} measured {} for, by `lss identify`.\n",
        layout.name,
        group.set_point(),
        if runs == 1 { "run speaks" } else { "runs speak" }
    );
    let bad: Vec<_> = fits.iter().filter(|fit| !fit.fits()).collect();
    if let Some(worst) = bad.iter().max_by(|a, b| a.objective.total_cmp(&b.objective)) {
        let which = if runs == 1 { "this run".to_owned() } else { format!("{} of the {runs} runs", bad.len()) };
        let _ = writeln!(
            out,
            "// WARNING: the model does not fit {which}: the objective of {} is {}, repeatability allows {}.\n\
             // These values make up for something that the model lacks. Look for it with `lss gap diagnose` before you\n\
             // use them.",
            worst.run,
            fixed(worst.objective, 2),
            fixed(worst.goodness.limit.objective, 2),
        );
    }
    for p in Parameter::ALL {
        let held = fits.iter().filter(|fit| at_bounds(fit).contains(&p.name())).count();
        if held > 0 {
            let _ = writeln!(out, "// WARNING: {} is at a bound in {held} of {runs} runs.", p.name());
        }
    }
    out
}

/// What the restitutions of a layout mean.
fn law_note(law: ContactLaw) -> String {
    match law {
        ContactLaw::HerbertMcwhannell => String::new(),
        ContactLaw::KelvinVoigt => concat!(
            "// Fitted with Kelvin and Voigt's damper, which a layout does not know: the restitutions are the same, ",
            "their\n// meaning is not. The simulation input beside this file has the law.\n",
        )
        .to_owned(),
        _ => concat!(
            "// Fitted with another law of damping: the restitutions here mean the same damping in Herbert and ",
            "McWhannell's.\n",
        )
        .to_owned(),
    }
}

/// How a file in `output` names the layout: by its relative path inside one project, else by a copy beside it that is
/// called `name`.
pub fn import(layout: &Path, output: &Path, name: &str) -> (String, Option<Vec<u8>>) {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (layout, output) = (absolute(layout), absolute(output));
    let root = output.ancestors().find(|folder| is_marked(folder));
    if let Some(path) = root.filter(|root| layout.starts_with(root)).map(|_| relative(&layout, &output)) {
        return (path, None);
    }
    (format!("{name}.lss"), root::read_given(&layout, SIZE_LIMIT).ok())
}

/// `to` as seen from the folder `from`.
fn relative(to: &Path, from: &Path) -> String {
    let plain = |path: &Path| -> Vec<String> {
        let mut parts: Vec<String> = Vec::new();
        for part in path.components() {
            match part {
                Component::ParentDir => drop(parts.pop()),
                Component::CurDir => {}
                other => parts.push(other.as_os_str().to_string_lossy().into_owned()),
            }
        }
        parts
    };
    let (to, from) = (plain(to), plain(from));
    let common = to.iter().zip(&from).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n("..".to_owned(), from.len() - common);
    let parts: Vec<String> = up.chain(to[common..].iter().cloned()).collect();
    if from.len() == common { format!("./{}", parts.join("/")) } else { parts.join("/") }
}

/// The layout's declaration. A layout always has Herbert and McWhannell's law: restitutions of another law are written
/// as those of this one with the same damping.
fn text(layout: &Layout, simulation: &Simulation, import: &str, shift: f64) -> String {
    let mut out = String::new();
    let law = simulation.contact_law;
    let _ = writeln!(out, "\nuse \"{import}\"\n");
    let equal = |e: f64| {
        let same = law == ContactLaw::HerbertMcwhannell || law == ContactLaw::KelvinVoigt;
        if same { e } else { restitution(ContactLaw::HerbertMcwhannell, damping(law, e)) }
    };
    for (name, wheel) in [("steering", &simulation.steering_wheel), ("running", &simulation.running_wheel)] {
        let Wheel { radius_m, half_spacing_m, height_m, gap_m, contact, rolling_resistance, .. } = wheel;
        let _ = writeln!(out, "wheel fitted_{name} {{");
        for (field, value) in
            [("radius", radius_m), ("half_spacing", half_spacing_m), ("height", height_m), ("gap", gap_m)]
        {
            let _ = writeln!(out, "  {field} = {} m", shortest(*value));
        }
        out.push_str(&contact_lines(contact, equal(contact.restitution), "  "));
        let _ = writeln!(out, "  rolling_resistance = {}\n}}\n", shortest(*rolling_resistance));
    }
    let joint = &simulation.joint;
    let _ = writeln!(out, "joint fitted_joint {{\n  approach_floor = {} m/s", shortest(joint.approach_floor_m_s));
    for (name, contact) in [("axial", &joint.axial), ("radial", &joint.radial)] {
        let lines = contact_lines(contact, equal(contact.restitution), "    ");
        let _ = writeln!(out, "  {name} {{\n{lines}  }}");
    }
    out.push_str("}\n\n");
    let cart = &simulation.cart;
    let [roll, pitch, yaw] = cart.inertia_kg_m2.map(shortest);
    let [ahead, above] = cart.centre_of_mass_m.map(shortest);
    let _ = writeln!(
        out,
        "cart fitted_cart {{\n  length = {} m\n  mass = {} kg\n  \
         inertia = ({roll} kg*m^2, {pitch} kg*m^2, {yaw} kg*m^2)\n  centre_of_mass = ({ahead} m, {above} m)\n  \
         steering = fitted_steering\n  running = fitted_running\n  joint = fitted_joint\n  \
         motor_height = {} m\n  tension = {} N\n}}\n",
        shortest(cart.length_m),
        shortest(cart.mass_kg),
        shortest(cart.motor_height_m),
        shortest(simulation.chain.tension_n),
    );
    let controller = &simulation.controller;
    let _ = writeln!(
        out,
        "controller fitted_controller {{\n  proportional = {} N*s/m\n  integral = {} N/m\n  derivative = {} N*s^2/m\n  \
         period = {} s\n}}\n",
        shortest(controller.proportional_n_s_per_m),
        shortest(controller.integral_n_per_m),
        shortest(controller.derivative_n_s2_per_m),
        shortest(controller.period_s),
    );
    let _ = writeln!(
        out,
        "layout {}_fitted from {} {{\n  cart fitted_cart\n  controller fitted_controller\n  speed {} m/s\n  \
         chain tension {} N",
        layout.name,
        layout.name,
        shortest(simulation.chain.speed_m_s),
        shortest(simulation.chain.tension_n),
    );
    if let Some(place) = layout.equipment.photocell {
        let names = (&layout.vertices[place.section].name, &layout.vertices[layout.next(place.section)].name);
        let _ = writeln!(out, "  photocell on {}..{} at {} m", names.0, names.1, shortest(place.at + shift));
    }
    out.push_str("}\n");
    out
}

fn contact_lines(contact: &ContactParameters, e: f64, indent: &str) -> String {
    let unit = if contact.exponent == 1.0 { "N/m".to_owned() } else { format!("N/m^{}", shortest(contact.exponent)) };
    format!(
        "{indent}stiffness = {} {unit}\n{indent}exponent = {}\n{indent}restitution = {}\n",
        shortest(contact.stiffness_n_per_m_n),
        shortest(contact.exponent),
        shortest(e)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    #[test]
    fn layouts_are_named_as_their_user_would() {
        let from = PathBuf::from("/project/out/today");
        for (to, expected) in [
            ("/project/layouts/a.lss", "../../layouts/a.lss"),
            ("/project/out/today/a.lss", "./a.lss"),
            ("/project/x/../b.lss", "../../b.lss"),
        ] {
            assert_eq!(relative(Path::new(to), &from), expected);
        }
    }
}
