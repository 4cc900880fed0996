//! The thrust that a chain of carts needs, in closed form.
//!
//! - Rolling: c W on running wheels, with W the weight of carts and load; on a climb its part across the track. What vertical
//!   curves add and take of the wheels' loads is nothing in the whole, as the track comes back to its slope.
//! - Curves: steering wheels carry |T − μ v²| / R a metre (thesis §2; the chain's tension less what it takes to turn it), so
//!   c |T − μ v²| θ in a curve that turns by θ, whatever its radius.
//! - Air: c v² a cart.
//! - Climbs: an evenly loaded chain climbs and descends alike. At the worst all that climbs is loaded and all that descends is
//!   empty: λ g H, with λ the load a metre and H the sum of all rises (as belt conveyors are rated: ISO 5048).
//! - Starting within t: M v / t beside all of these, at full speed. Wheels count without their rotation.
//! - Stopping within t, thrust reversed: M v / t less rolling, and with the load on descents pushing.

use crate::geometry::CentreLine;
use crate::model::{Cart, DriveDuty};

/// m/s², as the chain model takes it.
pub const GRAVITY: f64 = 9.81;
/// Share of the thrust that steady running may take: the controller needs the rest. An assumption.
pub const STEADY_SHARE: f64 = 0.8;
/// Steps in which heights are looked at, m.
const STEP: f64 = 0.05;

/// What of a centre line counts for the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lap {
    /// Along the slope, m.
    pub length: f64,
    /// Of its plan, m.
    pub run: f64,
    /// Sum of all turns to either side, rad.
    pub turn: f64,
    /// Sum of all rises, m.
    pub rise: f64,
}

impl Lap {
    pub fn new(line: &CentreLine) -> Self {
        let rise = |stretch: &crate::geometry::Stretch| {
            let steps = (stretch.length / STEP).ceil().max(1.0) as usize;
            let height = |k: usize| stretch.at(stretch.length * k as f64 / steps as f64).position.z;
            (0..steps).map(|k| (height(k + 1) - height(k)).max(0.0)).sum::<f64>()
        };
        let level = |s: &&crate::geometry::Stretch| s.form.inclination() != (0.0, 0.0);
        Lap {
            length: line.length,
            run: line.stretches.iter().map(|s| s.form.run()).sum(),
            turn: line.stretches.iter().map(|s| s.form.turn().abs()).sum(),
            rise: line.stretches.iter().filter(level).map(rise).sum(),
        }
    }
}

/// A chain on its track.
#[derive(Clone, Copy, Debug)]
pub struct Chain<'a> {
    pub cart: &'a Cart,
    pub carts: usize,
    /// m/s
    pub speed: f64,
    /// Mass on each cart, kg.
    pub load: f64,
    /// T₀, N
    pub tension: f64,
}

/// What a chain resists with at its speed, N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resistance {
    pub rolling: f64,
    pub curves: f64,
    pub air: f64,
    /// At the worst: loaded on climbs and empty on descents.
    pub climbs: f64,
}

impl Resistance {
    /// With the same load everywhere, N.
    pub fn steady(&self) -> f64 {
        self.rolling + self.curves + self.air
    }

    /// At the worst, N.
    pub fn most(&self) -> f64 {
        self.steady() + self.climbs
    }
}

/// What motors have to push with together, N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thrust {
    pub resistance: Resistance,
    /// To start within the time that the layout says; `None` where it says none.
    pub starting: Option<f64>,
    /// To stop within it, backwards.
    pub stopping: Option<f64>,
}

impl Chain<'_> {
    /// kg
    pub fn mass(&self) -> f64 {
        self.carts as f64 * (self.cart.mass + self.load)
    }

    pub fn resistance(&self, lap: &Lap) -> Resistance {
        let square = self.speed * self.speed;
        let per_metre = self.mass() / lap.length;
        Resistance {
            rolling: self.cart.running.rolling_resistance * self.mass() * GRAVITY * lap.run / lap.length,
            curves: self.cart.steering.rolling_resistance * (self.tension - per_metre * square).abs() * lap.turn,
            air: self.cart.drag.unwrap_or(0.0) * self.carts as f64 * square,
            climbs: self.carts as f64 * self.load / lap.length * GRAVITY * lap.rise,
        }
    }

    /// What the duty asks of the motors.
    pub fn thrust(&self, lap: &Lap, duty: &DriveDuty) -> Thrust {
        let resistance = self.resistance(lap);
        let inertia = |time: f64| self.mass() * self.speed / time;
        Thrust {
            resistance,
            starting: duty.starts.as_ref().map(|time| resistance.most() + inertia(time.value)),
            stopping: duty
                .stops
                .as_ref()
                .map(|time| (inertia(time.value) - resistance.rolling + resistance.climbs).max(0.0)),
        }
    }
}

impl Thrust {
    /// Fewest motors of so much thrust, N, of which `spare` may be out of order.
    pub fn motors(&self, force: f64, spare: usize) -> usize {
        let steady = self.resistance.most() / STEADY_SHARE;
        let most = steady.max(self.starting.unwrap_or(0.0)).max(self.stopping.unwrap_or(0.0));
        spare + ((most / force - 1e-9).ceil().max(1.0) as usize)
    }
}

/// Energy that motors of an efficiency take in a time, J, with the same load everywhere.
pub fn energy(resistance: &Resistance, speed: f64, time: f64, efficiency: Option<f64>) -> f64 {
    resistance.steady() * speed * time / efficiency.unwrap_or(1.0)
}
