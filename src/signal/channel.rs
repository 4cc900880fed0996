//! The columns that a run may have.

use std::fmt;

/// What a sensor cart measures: one column of a run.
///
/// The order is that of the format, in which columns are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Channel {
    SteerLeft,
    SteerRight,
    RunLeft,
    RunRight,
    JointXi,
    JointEta,
    JointZeta,
    ForkLeft,
    ForkRight,
    WheelSpeedSteerLeft,
    WheelSpeedSteerRight,
    WheelSpeedRunLeft,
    WheelSpeedRunRight,
    Temperature,
    Trigger,
}

/// How many channels of forces there are.
pub const FORCES: usize = Channel::FORCES.len();

impl Channel {
    /// SI unit of a channel of this name; empty where the chain has none, as of another machine's.
    pub fn unit_of(name: &str) -> &'static str {
        Channel::from_name(name).map_or("", Channel::unit)
    }

    pub const ALL: [Channel; 15] = [
        Channel::SteerLeft,
        Channel::SteerRight,
        Channel::RunLeft,
        Channel::RunRight,
        Channel::JointXi,
        Channel::JointEta,
        Channel::JointZeta,
        Channel::ForkLeft,
        Channel::ForkRight,
        Channel::WheelSpeedSteerLeft,
        Channel::WheelSpeedSteerRight,
        Channel::WheelSpeedRunLeft,
        Channel::WheelSpeedRunRight,
        Channel::Temperature,
        Channel::Trigger,
    ];

    /// The forces that pass the low-pass.
    pub const FORCES: [Channel; 7] = [
        Channel::SteerLeft,
        Channel::SteerRight,
        Channel::RunLeft,
        Channel::RunRight,
        Channel::JointXi,
        Channel::JointEta,
        Channel::JointZeta,
    ];

    /// Name, unit and label.
    const fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Channel::SteerLeft => ("steer_left", "N", "contact force of the left steering wheel"),
            Channel::SteerRight => ("steer_right", "N", "contact force of the right steering wheel"),
            Channel::RunLeft => ("run_left", "N", "contact force of the left running wheel"),
            Channel::RunRight => ("run_right", "N", "contact force of the right running wheel"),
            Channel::JointXi => ("joint_xi", "N", "joint force along the cart, tension positive"),
            Channel::JointEta => ("joint_eta", "N", "joint force to the left"),
            Channel::JointZeta => ("joint_zeta", "N", "joint force upwards"),
            Channel::ForkLeft => ("fork_left", "rad", "angle of the left steering fork"),
            Channel::ForkRight => ("fork_right", "rad", "angle of the right steering fork"),
            Channel::WheelSpeedSteerLeft => ("wheel_speed_steer_left", "rad/s", "speed of the left steering wheel"),
            Channel::WheelSpeedSteerRight => ("wheel_speed_steer_right", "rad/s", "speed of the right steering wheel"),
            Channel::WheelSpeedRunLeft => ("wheel_speed_run_left", "rad/s", "speed of the left running wheel"),
            Channel::WheelSpeedRunRight => ("wheel_speed_run_right", "rad/s", "speed of the right running wheel"),
            Channel::Temperature => ("temperature", "°C", "temperature in the core of the wheel"),
            Channel::Trigger => ("trigger", "", "photocell, 1 while the cart passes it"),
        }
    }

    /// The column's name: `steer_left`.
    pub const fn name(self) -> &'static str {
        self.words().0
    }

    /// The unit of its numbers: `N`. Empty for the trigger, which is 0 or 1.
    pub const fn unit(self) -> &'static str {
        self.words().1
    }

    /// Beyond this, in the channel's unit, a number is no measurement: far above what any sensor of the kind has, and
    /// far below where squares and sums of a long run would overflow.
    pub const fn farthest(self) -> f64 {
        match self {
            // That it is 0 or 1 is told in words of its own.
            Channel::Trigger => f64::MAX,
            Channel::Temperature => 1e4,
            Channel::ForkLeft | Channel::ForkRight => 1e3,
            Channel::WheelSpeedSteerLeft
            | Channel::WheelSpeedSteerRight
            | Channel::WheelSpeedRunLeft
            | Channel::WheelSpeedRunRight => 1e6,
            _ => 1e9,
        }
    }

    /// In plain English.
    pub const fn label(self) -> &'static str {
        self.words().2
    }

    pub fn from_name(name: &str) -> Option<Channel> {
        Channel::ALL.into_iter().find(|c| c.name() == name)
    }

    /// Whether it is one of the seven forces, which tests of the chain model compare (thesis §2.4.2).
    pub const fn is_force(self) -> bool {
        (self as usize) <= (Channel::JointZeta as usize)
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_find_their_channels_in_the_order_of_the_format() {
        for pair in Channel::ALL.windows(2) {
            assert!(pair[0] < pair[1]);
        }
        for channel in Channel::ALL {
            assert_eq!(Channel::from_name(channel.name()), Some(channel));
        }
        assert_eq!(Channel::ALL.iter().filter(|c| c.is_force()).count(), 7);
        assert_eq!(Channel::from_name("time"), None);
    }
}
