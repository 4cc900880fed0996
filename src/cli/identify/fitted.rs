//! The fitted layouts: a `.lss` that changes only what was fitted, and its simulation input.

use crate::cli::cases::Case;
use crate::cli::layouts;
use crate::cli::{MessageFormat, Outcome, read};
use crate::emit::json;
use crate::emit::number::shortest;
use crate::emit::simulation::{Contact, ContactLaw, Simulation, Wheel};
use crate::identify::study::Fitted;
use crate::identify::{Parameter, damping, restitution};
use crate::model::Layout;
use crate::source::root::is_marked;
use crate::source::{SIZE_LIMIT, input};
use std::fmt::Write;
use std::path::{Component, Path};

/// For each layout of the campaign `NAME-fitted.json`, and `NAME-fitted.lss` where it came as `.lss`.
pub fn files(cases: &[Case], fits: &[Fitted], output: &Path) -> Result<Vec<(String, Vec<u8>)>, Outcome> {
    let mut out = Vec::new();
    let mut seen: Vec<&Path> = Vec::new();
    let names = layouts::names(cases.iter().map(|c| c.layout.as_path()), "-fitted");
    for case in cases {
        if seen.contains(&case.layout.as_path()) {
            continue;
        }
        seen.push(&case.layout);
        let own: Vec<&Fitted> =
            fits.iter().filter(|f| cases.iter().any(|c| c.layout == case.layout && c.subject.name == f.run)).collect();
        let Some(first) = own.first() else { continue };
        let mut simulation = first.input(&case.subject);
        for p in Parameter::ALL {
            let mut values: Vec<f64> = own.iter().filter_map(|f| f.parameters.get(p.name())).map(|e| e.value).collect();
            values.sort_by(f64::total_cmp);
            if let Some(middle) = values.get(values.len() / 2) {
                p.set(&mut simulation, *middle);
            }
        }
        let Some(own_name) = names.get(&case.layout) else { continue };
        let name = format!("{own_name}-fitted");
        out.push((format!("{name}.json"), json::to_json(&simulation)));
        if case.layout.extension().is_some_and(|e| e == "lss") {
            let layout = read::read(&case.layout, None, MessageFormat::Text)?.layout;
            let (import, copy) = import(&case.layout, output, own_name);
            if let Some(bytes) = copy {
                out.push((import.clone(), bytes));
            }
            let shift = simulation.sensor.photocell_s_m - case.subject.simulation.sensor.photocell_s_m;
            out.push((format!("{name}.lss"), text(&layout, &simulation, &import, shift, own.len()).into_bytes()));
        }
    }
    Ok(out)
}

/// How a file in `output` names the layout: by its relative path inside one project, else by a copy beside it that is called `name`.
pub fn import(layout: &Path, output: &Path, name: &str) -> (String, Option<Vec<u8>>) {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (layout, output) = (absolute(layout), absolute(output));
    let root = output.ancestors().find(|folder| is_marked(folder));
    if let Some(path) = root.filter(|root| layout.starts_with(root)).map(|_| relative(&layout, &output)) {
        return (path, None);
    }
    (format!("{name}.lss"), input::read_given(&layout, SIZE_LIMIT).ok())
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

/// The layout's declaration. A layout always has Herbert and McWhannell's law: restitutions of another law are written as those of
/// this one with the same damping.
fn text(layout: &Layout, simulation: &Simulation, import: &str, shift: f64, runs: usize) -> String {
    let mut out = String::new();
    let law = simulation.contact_law;
    let _ = writeln!(
        out,
        "// `{}` with the parameters that {runs} measured {} for, by `lss identify`.",
        layout.name,
        if runs == 1 { "run speaks" } else { "runs speak" }
    );
    match law {
        ContactLaw::HerbertMcwhannell => {}
        ContactLaw::KelvinVoigt => {
            out.push_str("// Fitted with Kelvin and Voigt's damper, which a layout does not know: the restitutions are the same, their\n// meaning is not. The simulation input beside this file has the law.\n");
        }
        _ => out.push_str("// Fitted with another law of damping: the restitutions here mean the same damping in Herbert and McWhannell's.\n"),
    }
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
        "cart fitted_cart {{\n  length = {} m\n  mass = {} kg\n  inertia = ({roll} kg*m^2, {pitch} kg*m^2, {yaw} kg*m^2)\n  centre_of_mass = ({ahead} m, {above} m)\n  steering = fitted_steering\n  running = fitted_running\n  joint = fitted_joint\n  motor_height = {} m\n  tension = {} N\n}}\n",
        shortest(cart.length_m),
        shortest(cart.mass_kg),
        shortest(cart.motor_height_m),
        shortest(simulation.chain.tension_n),
    );
    let controller = &simulation.controller;
    let _ = writeln!(
        out,
        "controller fitted_controller {{\n  proportional = {} N*s/m\n  integral = {} N/m\n  derivative = {} N*s^2/m\n  period = {} s\n}}\n",
        shortest(controller.proportional_n_s_per_m),
        shortest(controller.integral_n_per_m),
        shortest(controller.derivative_n_s2_per_m),
        shortest(controller.period_s),
    );
    let _ = writeln!(
        out,
        "layout {}_fitted from {} {{\n  cart fitted_cart\n  controller fitted_controller\n  speed {} m/s\n  chain tension {} N",
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

fn contact_lines(contact: &Contact, e: f64, indent: &str) -> String {
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
