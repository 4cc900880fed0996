//! Places of a lap that passes of it are compared at.

/// What of a lap is compared.
#[derive(Clone, Copy, Debug)]
pub struct Lap {
    /// m
    pub length: f64,
    /// m/s
    pub speed: f64,
    pub carts: usize,
}

/// Equal places of a lap, about as many as it has samples.
pub struct Grid {
    /// m
    pub lap: f64,
    pub places: usize,
    /// Hz
    pub rate: f64,
}

impl Grid {
    /// Of a lap that is measured at a rate, Hz.
    pub fn new(lap: Lap, rate: f64) -> Grid {
        let places = (lap.length / lap.speed * rate).round().max(16.0) as usize;
        Grid { lap: lap.length, places, rate }
    }

    /// What was measured at each place in each pass; NaN where nothing was.
    pub fn passes(&self, station: &[f32], values: &[f32], trigger: f64) -> Vec<Vec<f32>> {
        let mut passes = vec![vec![f32::NAN; self.places]];
        let mut before: Option<usize> = None;
        for (s, x) in station.iter().zip(values) {
            let share = (f64::from(*s) + trigger) / self.lap;
            let place = (((share - share.floor()) * self.places as f64) as usize).min(self.places - 1);
            // Where the lap begins anew; a place or two back are the trigger's jitter.
            if before.is_some_and(|before| place + self.places / 2 < before) {
                passes.push(vec![f32::NAN; self.places]);
            }
            before = Some(place);
            if let Some(pass) = passes.last_mut() {
                pass[place] = *x;
            }
        }
        self.bridged(passes)
    }

    /// The same of a cart that goes around once, wherever it begins.
    pub fn once(&self, station: &[f32], values: &[f32]) -> Vec<f32> {
        let mut once = vec![f32::NAN; self.places];
        for pass in self.passes(station, values, 0.0) {
            once.iter_mut().zip(pass).filter(|(_, x)| x.is_finite()).for_each(|(to, x)| *to = x);
        }
        once
    }

    /// Places between two samples take the one before.
    fn bridged(&self, mut passes: Vec<Vec<f32>>) -> Vec<Vec<f32>> {
        for pass in &mut passes {
            for k in 1..pass.len() {
                let next = pass.get(k + 1).copied().unwrap_or(f32::NAN);
                if pass[k].is_nan() && !pass[k - 1].is_nan() && !next.is_nan() {
                    pass[k] = pass[k - 1];
                }
            }
        }
        passes
    }
}
