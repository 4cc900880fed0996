//! The ten parameters that a measured lap can tell of the chain (thesis §2.4.2), with their coordinates, bounds and
//! priors.
//!
//! Each is estimated in a coordinate in which the model is nearly linear: restitutions through the logarithm of the
//! damping that they mean in a law, χ(e) or Kelvin-Voigt's ζ(e); positive numbers through their logarithm; the
//! trigger's place in metres. In these coordinates the damping laws are the same model, so what one law's fit found
//! starts the next one's.

use crate::base::trig;
use crate::chain_input::{ContactLaw, Simulation};
use crate::dynamics::law;
use std::fmt;

/// A parameter of identification.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, clap::ValueEnum)]
#[clap(rename_all = "snake_case")]
pub enum Parameter {
    RestitutionJointAxial,
    RestitutionJointRadial,
    RestitutionSteering,
    RestitutionRunning,
    Speed,
    Tension,
    RollingResistance,
    TriggerPosition,
    KP,
    KI,
}

/// How many there are.
pub const COUNT: usize = Parameter::ALL.len();

impl Parameter {
    pub const ALL: [Parameter; 10] = [
        Parameter::RestitutionJointAxial,
        Parameter::RestitutionJointRadial,
        Parameter::RestitutionSteering,
        Parameter::RestitutionRunning,
        Parameter::Speed,
        Parameter::Tension,
        Parameter::RollingResistance,
        Parameter::TriggerPosition,
        Parameter::KP,
        Parameter::KI,
    ];

    /// The coefficients of restitution.
    pub const RESTITUTIONS: [Parameter; 4] = [
        Parameter::RestitutionJointAxial,
        Parameter::RestitutionJointRadial,
        Parameter::RestitutionSteering,
        Parameter::RestitutionRunning,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Parameter::RestitutionJointAxial => "restitution_joint_axial",
            Parameter::RestitutionJointRadial => "restitution_joint_radial",
            Parameter::RestitutionSteering => "restitution_steering",
            Parameter::RestitutionRunning => "restitution_running",
            Parameter::Speed => "speed",
            Parameter::Tension => "tension",
            Parameter::RollingResistance => "rolling_resistance",
            Parameter::TriggerPosition => "trigger_position",
            Parameter::KP => "k_p",
            Parameter::KI => "k_i",
        }
    }

    /// The parameter of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Parameter::ALL.into_iter().find(|p| p.name() == name)
    }

    /// SI unit; empty for a ratio.
    pub fn unit(self) -> &'static str {
        match self {
            Parameter::Speed => "m/s",
            Parameter::Tension => "N",
            Parameter::TriggerPosition => "m",
            Parameter::KP => "N s/m",
            Parameter::KI => "N/m",
            _ => "",
        }
    }

    pub fn is_restitution(self) -> bool {
        Parameter::RESTITUTIONS.contains(&self)
    }

    pub fn index(self) -> usize {
        self as usize
    }

    /// Its value in a simulation input.
    pub fn get(self, simulation: &Simulation) -> f64 {
        match self {
            Parameter::RestitutionJointAxial => simulation.joint.axial.restitution,
            Parameter::RestitutionJointRadial => simulation.joint.radial.restitution,
            Parameter::RestitutionSteering => simulation.steering_wheel.contact.restitution,
            Parameter::RestitutionRunning => simulation.running_wheel.contact.restitution,
            Parameter::Speed => simulation.chain.speed_m_s,
            Parameter::Tension => simulation.chain.tension_n,
            Parameter::RollingResistance => simulation.running_wheel.rolling_resistance,
            Parameter::TriggerPosition => simulation.sensor.photocell_s_m,
            Parameter::KP => simulation.controller.proportional_n_s_per_m,
            Parameter::KI => simulation.controller.integral_n_per_m,
        }
    }

    /// Sets its value. Rolling resistance is that of the running wheels; the steering wheels' follows in proportion.
    pub fn set(self, simulation: &mut Simulation, value: f64) {
        match self {
            Parameter::RestitutionJointAxial => simulation.joint.axial.restitution = value,
            Parameter::RestitutionJointRadial => simulation.joint.radial.restitution = value,
            Parameter::RestitutionSteering => simulation.steering_wheel.contact.restitution = value,
            Parameter::RestitutionRunning => simulation.running_wheel.contact.restitution = value,
            Parameter::Speed => simulation.chain.speed_m_s = value,
            Parameter::Tension => simulation.chain.tension_n = value,
            Parameter::RollingResistance => {
                let (running, steering) = (&mut simulation.running_wheel, &mut simulation.steering_wheel);
                let ratio = if running.rolling_resistance > 0.0 {
                    steering.rolling_resistance / running.rolling_resistance
                } else {
                    1.0
                };
                running.rolling_resistance = value;
                steering.rolling_resistance = value * ratio;
            }
            Parameter::TriggerPosition => simulation.sensor.photocell_s_m = value,
            Parameter::KP => simulation.controller.proportional_n_s_per_m = value,
            Parameter::KI => simulation.controller.integral_n_per_m = value,
        }
    }

    /// Least and largest value that is believed, from the nominal one.
    pub fn bounds(self, nominal: f64) -> (f64, f64) {
        match self {
            Parameter::Speed => (0.9 * nominal, 1.1 * nominal),
            Parameter::Tension => (0.1 * nominal, 5.0 * nominal),
            Parameter::RollingResistance => (0.002, 0.08),
            Parameter::TriggerPosition => (nominal - 3.0, nominal + 3.0),
            Parameter::KP | Parameter::KI => (0.1 * nominal, 10.0 * nominal),
            _ => (0.05, 0.97),
        }
    }

    /// The value in its coordinate.
    pub fn coordinate(self, law: ContactLaw, value: f64) -> f64 {
        match self {
            Parameter::TriggerPosition => value,
            _ if self.is_restitution() => trig::ln(damping(law, value).max(1e-12)),
            _ => trig::ln(value.max(1e-12)),
        }
    }

    /// The value of a coordinate, within `bounds`.
    pub fn value(self, law: ContactLaw, coordinate: f64, bounds: (f64, f64)) -> f64 {
        let value = match self {
            Parameter::TriggerPosition => coordinate,
            _ if self.is_restitution() => restitution(law, trig::exp(coordinate)),
            _ => trig::exp(coordinate),
        };
        value.clamp(bounds.0, bounds.1)
    }

    /// Mean and standard deviation of what is believed before the run, in the coordinate. `nominal` is that of the
    /// layout or the sidecar. A restitution's prior is one of its damping, so that it is the same in every law: χ of
    /// 0.1 to 1.4 within 1.5 deviations, Herbert and McWhannell's e of 0.92 to 0.25.
    pub fn prior(self, law: ContactLaw, nominal: f64) -> (f64, f64) {
        match self {
            Parameter::Speed => (trig::ln(nominal), 0.02),
            Parameter::Tension | Parameter::RollingResistance => (trig::ln(nominal), 0.4),
            Parameter::TriggerPosition => (nominal, 0.5),
            Parameter::KP | Parameter::KI => (trig::ln(nominal), 0.6),
            _ if law == ContactLaw::KelvinVoigt => (trig::ln(0.14), 0.9),
            _ => (trig::ln(0.55), 0.9),
        }
    }

    /// How far a design moves it, in the coordinate: far enough to be seen over chaos, near enough to be linear.
    pub fn reach(self) -> f64 {
        match self {
            Parameter::Speed => 0.004,
            Parameter::Tension => 0.05,
            Parameter::RollingResistance => 0.2,
            Parameter::TriggerPosition => 0.2,
            Parameter::KP | Parameter::KI => 0.5,
            _ => 0.45,
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a restitution means as damping: χ(e), or Kelvin-Voigt's ζ(e).
pub fn damping(law: ContactLaw, e: f64) -> f64 {
    if law != ContactLaw::KelvinVoigt {
        return law::factor(law, e);
    }
    let ln = trig::ln(e);
    -ln / trig::hypot(trig::PI, ln)
}

/// The restitution that means a damping, as near as one of 1e-6 to 1 comes.
pub fn restitution(law: ContactLaw, damping_wanted: f64) -> f64 {
    // Every law's damping falls with e.
    let (mut low, mut high) = (1e-6, 1.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if damping(law, middle) > damping_wanted { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// What the floor of approach speeds is divided by, as the logarithm of a factor.
pub const FLOOR_SCALE: f64 = 0.35;

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn coordinates_lead_back_to_values_in_every_law() {
        for &law in ContactLaw::value_variants() {
            for e in [0.06, 0.3, 0.6, 0.9] {
                let p = Parameter::RestitutionSteering;
                let back = p.value(law, p.coordinate(law, e), (0.0, 1.0));
                assert!((back - e).abs() < 1e-6, "{law:?} {e}: {back}");
            }
        }
        for p in Parameter::ALL {
            let back = p.value(ContactLaw::LeeWang, p.coordinate(ContactLaw::LeeWang, 0.7), (0.0, 9.0));
            assert!((back - 0.7).abs() < 1e-9, "{p}");
            assert_eq!(Parameter::from_name(p.name()), Some(p));
            assert_eq!(Parameter::ALL[p.index()], p);
        }
    }
}
