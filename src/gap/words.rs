//! A diagnosis in words.

use super::diagnosis::{Diagnosis, Finding, Verdict};

/// The verdict in two sentences.
pub fn summary(found: &Diagnosis) -> String {
    let percent = |x: f64| format!("{:.0} %", 100.0 * x);
    let place = |k: usize| {
        found.effects.get(k).map_or(String::new(), |e| {
            if e.place.is_empty() { e.name.clone() } else { format!("{} ({})", e.name, e.place) }
        })
    };
    let it = if found.verdict == Verdict::Pair { "them" } else { "it" };
    let closes = match (found.gap_closed, found.gap_closed_black_box) {
        (Some(x), Some(b)) => format!(
            "Adding {it} closes {} of the gap on runs left out; a black box that names nothing closes {}.",
            percent(x),
            percent(b)
        ),
        (Some(x), None) => format!("Adding {it} closes {} of the gap on runs left out.", percent(x)),
        (None, _) if found.runs.len() < 2 => {
            "With a single run nothing could be left out, so how far the gap closes elsewhere is not known.".into()
        }
        (None, _) => "The gap is too small to tell how far it closes on runs left out.".into(),
    };
    let small = !found.runs.is_empty() && found.runs.iter().all(|run| run.before <= 1.0);
    let closes = if small {
        closes
            + " It is small: no feature is farther off than in honest laps, but together they lie along its signature."
    } else {
        closes
    };
    match found.verdict {
        Verdict::None => {
            "There is no gap: these runs differ from the simulation no more than two honest laps do.".to_owned()
                + " Weaker effects than the floor shows would need more laps."
        }
        Verdict::Unknown => {
            let best = if by_chance(found) {
                format!("{} would close most of it, but patterns of that kind have nearly any shape.", place(0))
            } else {
                format!("The best of them, {}, leaves too much of it.", place(0))
            };
            let p = percent(found.unknown_probability);
            format!("There is a gap, and none of the known effects explains it (probability {p}). {best}")
        }
        Verdict::Effect | Verdict::Sensor => {
            let what = if found.verdict == Verdict::Sensor { "A sensor" } else { "One effect" };
            let p = found.effects.first().map_or(0.0, |e| e.probability);
            format!("{what} explains the gap: {}, with probability {}. {closes}", place(0), percent(p))
        }
        Verdict::Pair => format!("Two effects together explain the gap: {} and {}. {closes}", place(0), place(1)),
    }
}

/// What to measure next.
pub fn next_experiment(found: &Diagnosis) -> String {
    if let Some(group) = found.groups.first() {
        return group.experiment.clone();
    }
    match found.verdict {
        Verdict::None => "None is needed; more laps would lower the floor and show weaker effects.".into(),
        _ if by_chance(found) => {
            "A run with the sensors on another cart: what carts differ by goes along with them, what the track does stays at its place.".into()
        }
        Verdict::Unknown => found.places.first().map_or_else(
            || "More laps.".into(),
            |p| {
                format!(
                    "Look at the machine where the gap is largest: {} between {:.1} and {:.1} {}; then measure there at two speeds.",
                    p.channel, p.from_m, p.to_m, found.axis
                )
            },
        ),
        _ if found.runs.len() < 2 => "A second run at another speed and tension, to confirm the cause on data left out.".into(),
        _ => "Mend the cause, or add the effect to the model, and measure one more run to confirm.".into(),
    }
}

/// Whether what carts differ by was named or would close most of the gap: its pattern along the track has nearly any shape.
fn by_chance(found: &Diagnosis) -> bool {
    let by_cart = |e: &Finding| ["load_distribution", "pitch_wear"].contains(&&*e.name);
    let named = ![Verdict::None, Verdict::Unknown].contains(&found.verdict);
    let closes = |e: &Finding| e.gap_closed.is_some_and(|closed| closed > 0.5);
    found.runs.len() > 1 && found.effects.first().is_some_and(|e| by_cart(e) && (named || closes(e)))
}

/// What would separate effects that these runs do not.
pub fn separate(members: &[String]) -> String {
    let has = |name: &str| members.iter().any(|m| m == name);
    let list = members.join(", ");
    let how = if has("speed_drag") || has("motor_ripple") || has("wheel_out_of_round") {
        "a run at 0.7 of the speed, as these effects go with it differently"
    } else if has("joint_clearance") || has("joint_friction") || has("cart_bending") || has("stiffness_temperature") {
        "a run at twice the tension, which closes play and presses joints"
    } else if members.iter().any(|m| m.starts_with("sensor_")) {
        "a run with the sensor cart turned around or the channel's sensor exchanged"
    } else if has("motor_imbalance") || has("control_delay") {
        "a run with one motor after the other switched off, and wheel speeds measured"
    } else {
        "runs at another speed and another tension, of two laps each"
    };
    format!("These runs cannot separate {list}; {how}, would.")
}

/// Unit of a channel of the chain; empty for another machine's.
pub fn unit(channel: &str) -> &'static str {
    crate::signal::Channel::FORCES.iter().find(|c| c.name() == channel).map_or("", |c| c.unit())
}
