//! The sampled speed controller: PID with one command for all motors and a zero-order hold (design: chain model).

use super::model::Controller;

/// The controller's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Control {
    /// ∫ error dt, m.
    pub integral: f64,
    last_error: Option<f64>,
    /// Force a motor until the next sample, N.
    pub command: f64,
    /// Chain speed at the last sample, m/s.
    pub speed: f64,
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
