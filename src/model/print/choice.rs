//! What of the components is free, as text.

use super::super::{Cart, Choice, Equipment, Free, Motor, Sensor, Strength, TakeUp};
use super::{Printer, list, metres, number, unit};
use std::fmt::Write;

impl Printer {
    /// Declarations of what may be chosen. A cart of a family is declared alone, with its length in its name.
    pub(super) fn choices(&mut self, choice: &Choice) {
        for Free { item: cart, .. } in &choice.carts {
            let name = name_of(cart);
            if self.printed.insert(format!("cart {name}")) {
                self.cart(cart, &name);
            }
        }
        choice.motors.iter().for_each(|motor| self.motor(&motor.item));
        choice.sensors.iter().for_each(|sensor| self.sensor(&sensor.item));
        choice.take_ups.iter().for_each(|take_up| self.take_up(&take_up.item));
    }

    pub(super) fn sensor(&mut self, sensor: &Sensor) {
        if !self.printed.insert(format!("sensor {}", sensor.name)) {
            return;
        }
        self.block(format!("sensor {}", sensor.name), |out| {
            out.field("lowpass", unit(sensor.lowpass, "Hz"));
            out.field("rate", unit(sensor.rate, "Hz"));
            out.field("trigger_length", metres(sensor.trigger_length));
            if let Some(range) = sensor.range {
                out.field("range", unit(range, "N"));
            }
            out.article(&sensor.article);
        });
        self.text.push('\n');
    }

    pub(super) fn take_up(&mut self, take_up: &TakeUp) {
        if !self.printed.insert(format!("take_up {}", take_up.name)) {
            return;
        }
        self.block(format!("take_up {}", take_up.name), |out| {
            out.field("travel", metres(take_up.travel));
            if let Some(force) = take_up.force {
                out.field("force", unit(force, "N"));
            }
            out.article(&take_up.article);
        });
        self.text.push('\n');
    }

    pub(super) fn motor(&mut self, motor: &Motor) {
        if !self.printed.insert(format!("motor {}", motor.name)) {
            return;
        }
        self.block(format!("motor {}", motor.name), |out| {
            out.field("length", metres(motor.length));
            out.field("force", unit(motor.force, "N"));
            if let Some(efficiency) = motor.efficiency {
                out.field("efficiency", number(efficiency));
            }
            out.article(&motor.article);
        });
        self.text.push('\n');
    }

    pub(super) fn strength(&mut self, strength: &Strength) {
        if let Some(rated) = strength.rated {
            self.field("rated", unit(rated, "N"));
        }
        if let Some(fatigue) = &strength.fatigue {
            self.block("fatigue", |out| {
                out.field("range", unit(fatigue.range, "N"));
                out.field("cycles", number(fatigue.cycles));
                out.field("exponent", number(fatigue.exponent));
            });
        }
    }

    /// The statements.
    pub(super) fn choice(&mut self, choice: &Choice, equipment: &Equipment) {
        if !choice.carts.is_empty() {
            let names: Vec<String> = choice.carts.iter().map(|cart| name_of(&cart.item)).collect();
            self.line(format!("choose cart {}", names.join(", ")));
        }
        if !choice.speeds.is_empty() {
            let speeds: Vec<String> = choice.speeds.iter().map(|v| unit(*v, "m/s")).collect();
            self.line(format!("choose speed [{}]", speeds.join(", ")));
        }
        if !choice.motors.is_empty() {
            let names: Vec<&str> = choice.motors.iter().map(|motor| motor.item.name.as_str()).collect();
            let on = if choice.on_straights { " on straights" } else { "" };
            self.line(format!("choose motor {}{on}", names.join(", ")));
        }
        let sensors = choice.sensors.iter().map(|sensor| sensor.item.name.as_str());
        let take_ups = choice.take_ups.iter().map(|take_up| take_up.item.name.as_str());
        for (word, names) in [("sensor", sensors.collect::<Vec<_>>()), ("take_up", take_ups.collect())] {
            if !names.is_empty() {
                self.line(format!("choose {word} {}", names.join(", ")));
            }
        }
        if !choice.radii.is_empty() {
            self.line(format!("choose radii {}", list(&choice.radii)));
        }
        for free in &choice.counts {
            let names: Vec<&str> = free.declared.iter().map(|index| equipment.declared[*index].name.as_str()).collect();
            let counts: Vec<String> = free.counts.iter().map(ToString::to_string).collect();
            self.line(format!("choose count {} [{}]", names.join(", "), counts.join(", ")));
        }
        let drive = &choice.drive;
        let mut text = String::from("drive");
        if drive.load > 0.0 {
            let _ = write!(text, " load {}", unit(drive.load, "kg"));
        }
        for (word, time) in [("starts", &drive.starts), ("stops", &drive.stops)] {
            if let Some(time) = time {
                let _ = write!(text, " {word} within {}", unit(time.value, "s"));
            }
        }
        if drive.spare > 0 {
            let _ = write!(text, " spare {}", drive.spare);
        }
        if text != "drive" {
            self.line(text);
        }
        if let Some(energy) = &choice.energy {
            let (price, hours) = (unit(energy.price, "EUR/J"), unit(energy.running, "s"));
            self.line(format!("energy {price} for {hours} per year over {} years", number(energy.years)));
        }
    }
}

/// `tilt_tray_600mm`
fn name_of(cart: &Cart) -> String {
    let end = format!("_{}mm", (cart.length * 1e3).round());
    if cart.name.ends_with(&end) { cart.name.clone() } else { format!("{}{end}", cart.name) }
}
