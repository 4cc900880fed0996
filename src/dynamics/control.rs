//! The sampled speed controller: PID with one command for all motors and a zero-order hold (design: chain model).

use super::model::Controller;
use crate::base::trig;
use std::collections::VecDeque;

/// The controller's memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Control {
    /// ∫ error dt, m.
    pub integral: f64,
    last_error: Option<f64>,
    /// Force a motor until the next sample, N.
    pub command: f64,
    /// Chain speed at the last sample, m/s.
    pub speed: f64,
    /// Commands before, the latest first; kept only where they come late.
    past: VecDeque<f64>,
}

/// How the drive deviates from its controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Late {
    /// s
    pub delay: f64,
    /// Of F_max.
    pub saturation: f64,
    /// Amplitude, N, and frequency, Hz, of a force beside the command.
    pub hum: [f64; 2],
    /// s
    pub time: f64,
}

impl Control {
    /// A sample: I += e T_c with |K_i I| ≤ F_max, then the output, in [0, F_max].
    pub fn sample(&mut self, controller: &Controller, largest: f64, setpoint: f64, speed: f64) {
        let error = setpoint - speed;
        self.integral += error * controller.period;
        if controller.integral > 0.0 {
            let bound = largest / controller.integral;
            self.integral = self.integral.clamp(-bound, bound);
        }
        let slope = self.last_error.map_or(0.0, |last| (error - last) / controller.period);
        self.last_error = Some(error);
        let output =
            controller.proportional * error + controller.integral * self.integral + controller.derivative * slope;
        self.command = output.clamp(0.0, largest);
        self.speed = speed;
    }

    /// The same behind a delay, s, and with the motors' force bounded to a share; between two samples' commands in
    /// proportion.
    pub fn sample_late(&mut self, controller: &Controller, largest: f64, setpoint: f64, speed: f64, late: &Late) {
        self.sample(controller, late.saturation * largest, setpoint, speed);
        let (now, periods) = (self.command, (late.delay / controller.period).max(0.0));
        self.past.truncate(periods as usize + 2);
        self.past.push_front(now);
        let at = |k: usize| self.past.get(k).or(self.past.back()).copied().unwrap_or(now);
        let (whole, share) = (periods as usize, periods - periods.floor());
        let hum = late.hum[0] * trig::sin(trig::TAU * late.hum[1] * late.time);
        self.command = ((1.0 - share) * at(whole) + share * at(whole + 1) + hum).max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PI: Controller = Controller { proportional: 400.0, integral: 200.0, derivative: 0.0, period: 0.01 };

    #[test]
    fn the_command_is_proportional_and_integral() {
        let mut control = Control::default();
        control.sample(&PI, 400.0, 2.0, 1.9);
        assert!((control.command - (40.0 + 200.0 * 0.001)).abs() < 1e-12);
        control.sample(&PI, 400.0, 2.0, 1.9);
        assert!((control.command - (40.0 + 200.0 * 0.002)).abs() < 1e-12);
    }

    #[test]
    fn the_command_and_the_integral_are_bounded() {
        let mut control = Control::default();
        for _ in 0..100_000 {
            control.sample(&PI, 400.0, 2.0, 0.0);
        }
        assert_eq!(control.command, 400.0);
        assert!((control.integral - 2.0).abs() < 1e-12);
        control.sample(&PI, 400.0, 2.0, 9.0);
        assert_eq!(control.command, 0.0);
    }

    #[test]
    fn the_derivative_acts_from_the_second_sample_on() {
        let mut control = Control::default();
        let pid = Controller { derivative: 3.0, ..PI };
        control.sample(&pid, 400.0, 2.0, 2.0);
        assert_eq!(control.command, 0.0);
        control.sample(&pid, 400.0, 2.0, 1.9);
        assert!((control.command - (40.0 + 0.2 + 30.0)).abs() < 1e-9);
    }
}
