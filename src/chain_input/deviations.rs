//! How a built chain may deviate from the nominal one: what effects set and forces read.

use crate::base::number::fraction;
use crate::base::trig;
use crate::geometry::CentreLine;
use nalgebra::Vector3;

/// Deviations of a built chain. The default has none.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviations {
    /// Play of every joint along each axis, m: a joint pulls or pushes once half of it is used up.
    pub clearance: f64,
    /// Friction coefficient of running wheels that slide sideways.
    pub sliding: f64,
    /// Moment that a wheel fork takes to swivel, N m.
    pub swivel: f64,
    /// Friction moment of a joint, N m.
    pub joint_friction: f64,
    /// Drag of a cart over the square of its speed, N s²/m².
    pub drag: f64,
    /// Speed, m/s, and turning rate, rad/s, over which dry friction comes up.
    pub smoothing: [f64; 2],
    /// Thrust of each motor as a share of the command; those beyond the list have 1.
    pub thrust: Vec<f64>,
    /// Ripple of the thrust along every motor.
    pub ripple: Ripple,
    /// Delay from the speed's measurement to the thrust, s.
    pub delay: f64,
    /// Share of F_max that motors really give.
    pub saturation: f64,
    /// A force added to every motor's command: amplitude, N, and frequency, Hz.
    pub hum: [f64; 2],
    /// Added to each cart's mass, its inertia in proportion, as a share; carts beyond the list have 0.
    pub load: Vec<f64>,
    /// Added to each cart's length, m; carts beyond the list have 0.
    pub pitch: Vec<f64>,
    /// Where the rails are beside where the centre line has them, m: to the left; upwards under the left and the right
    /// running wheel. Closed tables over the lap, at equal distances; empty for none.
    pub rails: [Vec<f64>; 3],
    /// Wheels whose radius is not the nominal one. Every cart's wheels are at another angle.
    pub worn: Vec<WornWheel>,
    /// How the guides of the steering wheels give way.
    pub guides: Guides,
    /// Whether running wheels slide across the cart, which holds them; else across the track, along which they swivel.
    pub held: bool,
    /// Force along the track on a cart, N, over the lap; empty for none.
    pub resistance: Vec<f64>,
    /// Force across the track on a cart, to the left, N, over the lap; empty for none.
    pub side_force: Vec<f64>,
    pub warming: Warming,
}

/// Every stiffness times 1 + change (1 − exp(−t/after)), with the time t since a run's record began, s. A chain without
/// such a time, of which each cart is a lap, has none of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Warming {
    pub change: f64,
    /// s
    pub after: f64,
}

impl Warming {
    /// Share of the change that is there at a time, s.
    pub fn share(&self, time: f64) -> f64 {
        if self.after > 0.0 { 1.0 - trig::exp(-time.max(0.0) / self.after) } else { 1.0 }
    }

    /// The mean of that share over a run of so many seconds.
    pub fn mean_share(&self, duration: f64) -> f64 {
        let over = if self.after > 0.0 { duration / self.after } else { f64::INFINITY };
        match over {
            x if x <= 0.0 => 0.0,
            x if x.is_finite() => 1.0 - (1.0 - trig::exp(-x)) / x,
            _ => 1.0,
        }
    }
}

/// Thrust times 1 + Σ aₙ sin(2πn d/λ + φₙ), with d how far a plate's front is past a motor's begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    /// aₙ over the mean thrust, from the fundamental on.
    pub ratios: [f64; HARMONICS],
    /// λ of the fundamental, m.
    pub wavelength: f64,
    /// φₙ, rad.
    pub phases: [f64; HARMONICS],
}

/// How many waves a ripple is a sum of.
pub const HARMONICS: usize = 3;

impl Default for Ripple {
    fn default() -> Self {
        Ripple { ratios: [0.0; HARMONICS], wavelength: 1.0, phases: [0.0; HARMONICS] }
    }
}

impl Ripple {
    /// Whether thrust is even.
    pub fn is_none(&self) -> bool {
        self.ratios.iter().all(|ratio| *ratio == 0.0)
    }

    /// What thrust has more, over its mean, for a plate whose front is so far past a motor's begin, m.
    pub fn at(&self, ahead: f64) -> f64 {
        let turn = trig::TAU * ahead / self.wavelength;
        let waves = self.ratios.iter().zip(&self.phases).zip(1..).filter(|((ratio, _), _)| **ratio != 0.0);
        waves.map(|((ratio, phase), n)| ratio * trig::sin(f64::from(n) * turn + phase)).sum()
    }
}

/// A wheel of some carts that is worn.
#[derive(Clone, Debug, PartialEq)]
pub struct WornWheel {
    pub wheel: WheelPlace,
    /// Radius beside the nominal one, m, over a revolution, at equal angles.
    pub radius: Vec<f64>,
    pub carts: Every,
}

/// A wheel of a cart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelPlace {
    /// Both steering wheels as one, which shifts the cart to the left by what its radius has more.
    Steering,
    RunningLeft,
    RunningRight,
    SteeringLeft,
    SteeringRight,
}

impl WheelPlace {
    /// In the order in which layouts count them, from 1.
    pub const ALL: [WheelPlace; 5] = [
        WheelPlace::Steering,
        WheelPlace::RunningLeft,
        WheelPlace::RunningRight,
        WheelPlace::SteeringLeft,
        WheelPlace::SteeringRight,
    ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            WheelPlace::Steering => "steering wheels",
            WheelPlace::RunningLeft => "left running wheel",
            WheelPlace::RunningRight => "right running wheel",
            WheelPlace::SteeringLeft => "left steering wheel",
            WheelPlace::SteeringRight => "right steering wheel",
        }
    }

    pub fn is_running(self) -> bool {
        matches!(self, WheelPlace::RunningLeft | WheelPlace::RunningRight)
    }
}

/// Each so manyth cart from one on, which is counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Every {
    pub nth: usize,
    pub from: usize,
}

impl Default for Every {
    fn default() -> Self {
        Every { nth: 1, from: 0 }
    }
}

impl Every {
    /// Whether a cart is one of them.
    pub fn has(&self, cart: usize) -> bool {
        self.nth < 2 || cart.abs_diff(self.from).is_multiple_of(self.nth)
    }
}

/// Guides that give way by `compliance` sin²(π (s − first)/span) times the force on them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Guides {
    /// In a span's middle, m/N; 0 for none.
    pub compliance: f64,
    /// m
    pub span: f64,
    /// Arc length of a support, m.
    pub first: f64,
}

impl Guides {
    /// At a station, m/N.
    pub fn at(&self, station: f64) -> f64 {
        let sin = trig::sin(trig::PI * (station - self.first) / self.span);
        self.compliance * sin * sin
    }
}

impl Default for Deviations {
    fn default() -> Self {
        Deviations {
            clearance: 0.0,
            sliding: 0.0,
            swivel: 0.0,
            joint_friction: 0.0,
            drag: 0.0,
            smoothing: [0.01, 0.02],
            thrust: Vec::new(),
            ripple: Ripple::default(),
            delay: 0.0,
            saturation: 1.0,
            hum: [0.0; 2],
            load: Vec::new(),
            pitch: Vec::new(),
            rails: Default::default(),
            worn: Vec::new(),
            guides: Guides::default(),
            held: false,
            resistance: Vec::new(),
            side_force: Vec::new(),
            warming: Warming::default(),
        }
    }
}

/// Turns of a wheel from one cart to the next, beside whole ones: the golden ratio spreads any number of them evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Steps to a station between rails that are off.
const SPACED: usize = 8;

impl Deviations {
    /// Whether carts feel anything that the nominal forces lack.
    pub fn on_carts(&self) -> bool {
        let moments = self.swivel > 0.0 || self.joint_friction > 0.0;
        self.has_profiles() || self.has_pushes() || moments || !self.load.is_empty() || self.guides.compliance > 0.0
    }

    /// Whether rails or wheels are not where or as they should be.
    pub fn has_profiles(&self) -> bool {
        !self.worn.is_empty() || self.rails.iter().any(|table| !table.is_empty())
    }

    /// Whether forces act at front joints that the nominal ones lack.
    pub fn has_pushes(&self) -> bool {
        self.sliding > 0.0 || self.drag != 0.0 || !self.resistance.is_empty() || !self.side_force.is_empty()
    }

    /// Factor on a motor's thrust, for a plate whose front is so far past the motor's begin, m.
    pub fn factor(&self, motor: usize, ahead: f64) -> f64 {
        let share = self.thrust.get(motor).copied().unwrap_or(1.0);
        if self.ripple.is_none() { share } else { share * (1.0 + self.ripple.at(ahead)) }
    }

    /// Where the rails of a line lead at a station, m.
    pub fn way(&self, line: &CentreLine, station: f64) -> Vector3<f64> {
        let frame = line.at(station);
        let [across, left, right] = [0, 1, 2].map(|rail| closed(&self.rails[rail], station / line.length).0);
        frame.position + frame.normal * across + frame.up * (0.5 * (left + right))
    }

    /// How much longer than a line the way between its rails is, m, up to each of the tables' points and to the end:
    /// the difference of two polygons through the points, as the rails are off by little beside their distance. Empty
    /// where no rail is off.
    pub fn longer(&self, line: &CentreLine) -> Vec<f64> {
        let n = self.rails.iter().map(Vec::len).max().unwrap_or(0);
        let planned = Deviations::default();
        let points = |which: &Deviations| -> Vec<Vector3<f64>> {
            (0..n).map(|k| which.way(line, line.length * k as f64 / n as f64)).collect()
        };
        let (built, planned) = (points(self), points(&planned));
        let mut longer = vec![0.0; n.min(1)];
        for k in 0..n {
            let side = |points: &[Vector3<f64>]| (points[(k + 1) % n] - points[k]).norm();
            longer.push(longer[k] + side(&built) - side(&planned));
        }
        longer
    }

    /// How much longer than on the line a chain of so many carts is between the rails, m, whose sides are chords from
    /// one station to the next: the mean of so many phases.
    pub fn chain_longer(&self, line: &CentreLine, carts: usize, phases: usize) -> f64 {
        if self.rails.iter().all(Vec::is_empty) {
            return 0.0;
        }
        let planned = Deviations::default();
        let chain = |which: &Deviations, phase: usize| -> f64 {
            let share = |k: usize| (k as f64 + phase as f64 / phases as f64) / carts as f64;
            let joint = |k: usize| which.way(line, line.length * (share(k % carts)));
            (0..carts).map(|k| (joint(k + 1) - joint(k)).norm()).sum()
        };
        (0..phases).map(|phase| chain(self, phase) - chain(&planned, phase)).sum::<f64>() / phases as f64
    }

    /// The station, m, up to which the way between the rails is the same part of the whole as a station of the line is
    /// of the lap.
    pub fn spaced(&self, line: &CentreLine, longer: &[f64], station: f64) -> f64 {
        let Some(whole) = longer.last() else { return station };
        let n = (longer.len() - 1) as f64;
        let up_to = |station: f64| {
            let place = n * (station / line.length).clamp(0.0, 1.0);
            let k = (place as usize).min(longer.len() - 2);
            longer[k] + (place - k as f64) * (longer[k + 1] - longer[k])
        };
        // What is longer grows by a small part of the way, so that this comes to rest at once.
        let mut spaced = station;
        for _ in 0..SPACED {
            spaced = station * (1.0 + whole / line.length) - up_to(spaced);
        }
        spaced
    }

    /// Offset and slope, m and 1, of rail and wheel `k` (lateral, left, right) under cart `i` at a share of the lap;
    /// `lap` and `radius` in m.
    pub fn offset(&self, k: usize, i: usize, station: f64, lap: f64, radius: f64) -> (f64, f64) {
        let (rail, slope) = closed(&self.rails[k], station / lap);
        let (wheel, rate) = self.of_wheel(WheelPlace::ALL[k], i, station, radius);
        (rail + wheel, slope / lap + rate)
    }

    /// The same of the steering wheel that is nearer to its rail, of a cart that lies `across` to the left, m: where the
    /// wheel's radius is larger, its rail is as much nearer.
    pub fn steered(&self, across: f64, i: usize, station: f64, radius: f64) -> (f64, f64) {
        let (wheel, nearer) =
            if across > 0.0 { (WheelPlace::SteeringLeft, -1.0) } else { (WheelPlace::SteeringRight, 1.0) };
        let (more, rate) = self.of_wheel(wheel, i, station, radius);
        (nearer * more, nearer * rate)
    }

    /// What a wheel's radius has more where cart `i` is, m, and its slope.
    fn of_wheel(&self, wheel: WheelPlace, i: usize, station: f64, radius: f64) -> (f64, f64) {
        let own = self.worn.iter().filter(|worn| worn.wheel == wheel && worn.carts.has(i));
        let each = own.map(|worn| closed(&worn.radius, turns(i, station, radius)));
        let (more, rate) = each.fold((0.0, 0.0), |sum, (more, rate)| (sum.0 + more, sum.1 + rate));
        (more, rate / (trig::TAU * radius))
    }
}

/// Turns of cart `i`'s wheels of a radius, m, at a station.
fn turns(i: usize, station: f64, radius: f64) -> f64 {
    station / (trig::TAU * radius) + GOLDEN * i as f64
}

/// Value and slope of a closed table at a share of its period, by Catmull and Rom's cubic (1974); 0 of an empty one.
pub fn closed(table: &[f64], share: f64) -> (f64, f64) {
    let n = table.len();
    if n == 0 {
        return (0.0, 0.0);
    }
    let x = fraction(share) * n as f64;
    let i = (x as usize).min(n - 1);
    let t = x - i as f64;
    // Without the remainders of divisions, which took most of the time.
    let next = |k: usize| if k + 1 < n { k + 1 } else { 0 };
    let (before, after) = (if i > 0 { i - 1 } else { n - 1 }, next(i));
    let (a, b, c, d) = (table[before], table[i], table[after], table[next(after)]);
    // As most of a rail is where one step is all that is wrong.
    if [a, b, c, d] == [0.0; 4] {
        return (0.0, 0.0);
    }
    let (p, q, r) = (c - a, 2.0 * a - 5.0 * b + 4.0 * c - d, 3.0 * (b - c) + d - a);
    (b + 0.5 * t * (p + t * (q + t * r)), 0.5 * n as f64 * (p + t * (2.0 * q + 3.0 * t * r)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Form;

    #[test]
    fn a_wider_circle_is_longer_by_its_radius_and_a_wave_by_half_its_slope_squared() {
        let circle = CentreLine::new([0.0; 4], &[Form::Arc { radius: 5.0, turn: trig::TAU }]);
        let wider = Deviations { rails: [vec![-0.01; 500], Vec::new(), Vec::new()], ..Deviations::default() };
        let whole = |deviations: &Deviations| deviations.longer(&circle).last().copied();
        assert!((whole(&wider).unwrap() - trig::TAU * 0.01).abs() < 1e-5);
        let wave: Vec<f64> = (0..2000).map(|k| 0.01 * trig::sin(trig::TAU * f64::from(k) / 200.0)).collect();
        let wavy = Deviations { rails: [Vec::new(), wave.clone(), wave], ..Deviations::default() };
        let slope = 0.01 * 10.0 / 5.0;
        let more = whole(&wavy).unwrap() / circle.length;
        assert!((more - slope * slope / 4.0).abs() < 0.01 * slope * slope, "{more}");
        assert_eq!(whole(&Deviations::default()), None);
    }

    #[test]
    fn stations_between_rails_are_evenly_apart() {
        let circle = CentreLine::new([0.0; 4], &[Form::Arc { radius: 5.0, turn: trig::TAU }]);
        let bulge = |k: usize| 0.1 * trig::sin(trig::PI * k as f64 / 1000.0) * trig::sin(trig::PI * k as f64 / 1000.0);
        let built =
            Deviations { rails: [(0..1000).map(bulge).collect(), Vec::new(), Vec::new()], ..Deviations::default() };
        let longer = built.longer(&circle);
        let station = |k: usize| built.spaced(&circle, &longer, circle.length * k as f64 / 20.0);
        let points: Vec<_> = (0..=20).map(|k| built.way(&circle, station(k))).collect();
        let apart: Vec<f64> = points.windows(2).map(|p| (p[1] - p[0]).norm()).collect();
        let (low, high) = apart.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
        assert!(
            high - low < 5e-4 && (station(10) - 0.5 * circle.length).abs() < 1e-5 && station(5) < 0.249 * circle.length,
            "{low} {high}"
        );
    }

    #[test]
    fn a_closed_table_follows_a_sine_with_its_slope() {
        let table: Vec<f64> = (0..64).map(|k| trig::sin(trig::TAU * f64::from(k) / 64.0)).collect();
        for k in 0..200 {
            let share = f64::from(k) * 0.0137 - 1.0;
            let (value, slope) = closed(&table, share);
            assert!((value - trig::sin(trig::TAU * share)).abs() < 2e-4, "{share}");
            assert!((slope - trig::TAU * trig::cos(trig::TAU * share)).abs() < 0.02, "{share}");
        }
        assert_eq!(closed(&[], 0.3), (0.0, 0.0));
    }
}
