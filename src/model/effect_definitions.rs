//! What effects a layout may name: each with its strengths, their units and bounds, and what says its place. What an
//! effect does stands in `effects`, one file each.

/// An effect that a layout may name.
#[derive(Debug, PartialEq)]
pub struct EffectDefinition {
    pub name: &'static str,
    /// What is unlike the nominal model, in a few words.
    pub about: &'static str,
    /// What is fitted.
    pub strengths: &'static [StrengthDefinition],
    /// What says where it sits.
    pub places: &'static [PlaceDefinition],
}

/// A strength of an effect.
#[derive(Debug, PartialEq)]
pub struct StrengthDefinition {
    pub name: &'static str,
    /// SI unit; empty for a ratio.
    pub unit: &'static str,
    pub about: &'static str,
    /// Bounds, in the unit.
    pub low: f64,
    pub high: f64,
}

/// A number that says where an effect sits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceDefinition {
    pub name: &'static str,
    pub kind: PlaceKind,
    /// In a few words; empty where the name says it.
    pub about: &'static str,
    /// Of an effect that does not say it.
    pub default: f64,
}

/// What a place's number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceKind {
    /// m
    Length,
    /// s
    Time,
    /// Which one of several, or which way; without a unit.
    Number,
    /// The number of a force channel, from 1.
    ForceChannel,
}

pub const JOINT_CLEARANCE: EffectDefinition = EffectDefinition {
    name: "joint_clearance",
    about: "play in every joint",
    strengths: &[StrengthDefinition { name: "gap", unit: "m", about: "play from end to end", low: 0.0, high: 2e-3 }],
    places: &[],
};

pub const WHEEL_SLIDING: EffectDefinition = EffectDefinition {
    name: "wheel_sliding",
    about: "running wheels that slide sideways",
    strengths: &[StrengthDefinition { name: "friction", unit: "", about: "friction coefficient", low: 0.0, high: 1.0 }],
    places: &[
        PlaceDefinition {
            name: "creep",
            kind: PlaceKind::Number,
            about: "speed in m/s beyond which they slide",
            default: 0.01,
        },
        PlaceDefinition {
            name: "held",
            kind: PlaceKind::Number,
            about: "0 for wheels that swivel and slide across the track, 1 for wheels that the cart holds and that slide \
                    across the cart",
            default: 0.0,
        },
    ],
};

pub const FORK_SWIVEL: EffectDefinition = EffectDefinition {
    name: "fork_swivel",
    about: "a fork that swivels against friction",
    strengths: &[StrengthDefinition {
        name: "moment",
        unit: "N m",
        about: "friction moment of a fork",
        low: 0.0,
        high: 100.0,
    }],
    places: &[],
};

pub const TRACK_FLEXIBILITY: EffectDefinition = EffectDefinition {
    name: "track_flexibility",
    about: "a track that bends between supports",
    strengths: &[
        StrengthDefinition {
            name: "compliance",
            unit: "m/N",
            about: "deflection in a span's middle over a cart's weight",
            low: 0.0,
            high: 1e-4,
        },
        StrengthDefinition {
            name: "guides",
            unit: "m/N",
            about: "deflection of a guide in a span's middle over a steering wheel's force",
            low: 0.0,
            high: 1e-4,
        },
    ],
    places: &[
        PlaceDefinition {
            name: "span",
            kind: PlaceKind::Length,
            about: "between two supports; 0 takes the layout's",
            default: 0.0,
        },
        PlaceDefinition {
            name: "shape",
            kind: PlaceKind::Number,
            about: "0 as each cart bends its own span, 1 as the whole chain's weight bends hinged spans",
            default: 0.0,
        },
        PlaceDefinition {
            name: "wider",
            kind: PlaceKind::Number,
            about: "how many times as far apart as in the layout supports are, where no span is given",
            default: 1.0,
        },
        PlaceDefinition {
            name: "first",
            kind: PlaceKind::Length,
            about: "arc length of the first support",
            default: 0.0,
        },
    ],
};

pub const WHEEL_OUT_OF_ROUND: EffectDefinition = EffectDefinition {
    name: "wheel_out_of_round",
    about: "a wheel out of round or with a flat spot",
    strengths: &[
        StrengthDefinition {
            name: "amplitude",
            unit: "m",
            about: "of the radius, once a turn; the depth of a flat spot",
            low: 0.0,
            high: 2e-3,
        },
        StrengthDefinition { name: "twice", unit: "m", about: "of the radius, twice a turn", low: 0.0, high: 2e-3 },
        StrengthDefinition {
            name: "thrice",
            unit: "m",
            about: "of the radius, three times a turn",
            low: 0.0,
            high: 2e-3,
        },
        StrengthDefinition {
            name: "four_times",
            unit: "m",
            about: "of the radius, four times a turn",
            low: 0.0,
            high: 2e-3,
        },
    ],
    places: &[
        PlaceDefinition {
            name: "wheel",
            kind: PlaceKind::Number,
            about: "1 both steering, 2 left running, 3 right running, 4 left steering, 5 right steering",
            default: 2.0,
        },
        PlaceDefinition {
            name: "shape",
            kind: PlaceKind::Number,
            about: "0 for waves around the wheel, 1 for a flat spot",
            default: 0.0,
        },
        PlaceDefinition {
            name: "every",
            kind: PlaceKind::Number,
            about: "each so manyth cart has such a wheel, from the one with the sensors on",
            default: 1.0,
        },
    ],
};

pub const RAIL_STEP: EffectDefinition = EffectDefinition {
    name: "rail_step",
    about: "a step at a joint of the track",
    strengths: &[StrengthDefinition { name: "height", unit: "m", about: "of the step", low: -5e-3, high: 5e-3 }],
    places: &[
        PlaceDefinition { name: "at", kind: PlaceKind::Length, about: "arc length", default: 0.0 },
        PlaceDefinition {
            name: "rail",
            kind: PlaceKind::Number,
            about: "1 of the steering wheels, 2 of the left and 3 of the right running wheels, 4 both of these",
            default: 2.0,
        },
        PlaceDefinition {
            name: "rise",
            kind: PlaceKind::Length,
            about: "over which it goes off; 0 for a sharp one, which the wheel climbs over √(2rh)",
            default: 0.0,
        },
        PlaceDefinition { name: "back", kind: PlaceKind::Length, about: "over which it comes back", default: 2.0 },
    ],
};

pub const MOTOR_RIPPLE: EffectDefinition = EffectDefinition {
    name: "motor_ripple",
    about: "thrust that ripples with the pole pitch",
    strengths: &[
        StrengthDefinition { name: "ratio", unit: "", about: "amplitude over thrust", low: 0.0, high: 1.0 },
        StrengthDefinition {
            name: "twice",
            unit: "",
            about: "amplitude of the second harmonic over thrust",
            low: 0.0,
            high: 1.0,
        },
        StrengthDefinition {
            name: "thrice",
            unit: "",
            about: "amplitude of the third harmonic over thrust",
            low: 0.0,
            high: 1.0,
        },
    ],
    places: &[
        PlaceDefinition { name: "wavelength", kind: PlaceKind::Length, about: "of the pole pitch", default: 0.2 },
        PlaceDefinition { name: "phase", kind: PlaceKind::Number, about: "rad", default: 0.0 },
        PlaceDefinition {
            name: "twice_phase",
            kind: PlaceKind::Number,
            about: "of the second harmonic, rad",
            default: 0.0,
        },
        PlaceDefinition {
            name: "thrice_phase",
            kind: PlaceKind::Number,
            about: "of the third harmonic, rad",
            default: 0.0,
        },
    ],
};

pub const MOTOR_IMBALANCE: EffectDefinition = EffectDefinition {
    name: "motor_imbalance",
    about: "a weak or dead motor",
    strengths: &[StrengthDefinition { name: "loss", unit: "", about: "of its thrust", low: -1.0, high: 1.0 }],
    places: &[PlaceDefinition {
        name: "motor",
        kind: PlaceKind::Number,
        about: "counted from 1 in driving order",
        default: 1.0,
    }],
};

pub const JOINT_FRICTION: EffectDefinition = EffectDefinition {
    name: "joint_friction",
    about: "friction in every joint",
    strengths: &[StrengthDefinition { name: "moment", unit: "N m", about: "friction moment", low: 0.0, high: 20.0 }],
    places: &[],
};

pub const LOAD_DISTRIBUTION: EffectDefinition = EffectDefinition {
    name: "load_distribution",
    about: "items on the carts",
    strengths: &[StrengthDefinition {
        name: "mass",
        unit: "kg",
        about: "of items on a loaded cart",
        low: 0.0,
        high: 200.0,
    }],
    places: &[
        PlaceDefinition {
            name: "on_sensor",
            kind: PlaceKind::Number,
            about: "0 when neither the cart with the sensors nor one beside it is loaded; 2, 3, 4 when the cart \
                    before, the one after, or both are; 5 to 8 the same with a load on it, too; 1 when all carts are",
            default: 0.0,
        },
        PlaceDefinition { name: "draw", kind: PlaceKind::Number, about: "which others are loaded", default: 1.0 },
        PlaceDefinition {
            name: "share",
            kind: PlaceKind::Number,
            about: "of the others that are loaded",
            default: 0.5,
        },
    ],
};

pub const STIFFNESS_TEMPERATURE: EffectDefinition = EffectDefinition {
    name: "stiffness_temperature",
    about: "stiffness that went with temperature",
    strengths: &[StrengthDefinition {
        name: "change",
        unit: "",
        about: "relative change of stiffness",
        low: -0.8,
        high: 2.0,
    }],
    places: &[PlaceDefinition {
        name: "after",
        kind: PlaceKind::Time,
        about: "time constant with which it comes up in a run; 0 where it is there from the beginning",
        default: 0.0,
    }],
};

pub const CURVE_GEOMETRY: EffectDefinition = EffectDefinition {
    name: "curve_geometry",
    about: "a curve that was built otherwise",
    strengths: &[
        StrengthDefinition {
            name: "offset",
            unit: "m",
            about: "to the left in the curve's middle",
            low: -0.04,
            high: 0.04,
        },
        StrengthDefinition { name: "radius", unit: "m", about: "that its radius is larger by", low: -1.0, high: 1.0 },
        StrengthDefinition {
            name: "heading",
            unit: "rad",
            about: "that it turns more to the left, and the next curve less",
            low: -0.1,
            high: 0.1,
        },
        StrengthDefinition {
            name: "transition",
            unit: "m",
            about: "over which its curvature comes and goes",
            low: 0.0,
            high: 2.0,
        },
    ],
    places: &[PlaceDefinition {
        name: "curve",
        kind: PlaceKind::Number,
        about: "counted from 1 in driving order",
        default: 1.0,
    }],
};

pub const PITCH_WEAR: EffectDefinition = EffectDefinition {
    name: "pitch_wear",
    about: "carts of unequal length",
    strengths: &[StrengthDefinition {
        name: "deviation",
        unit: "m",
        about: "largest of a cart's length",
        low: 0.0,
        high: 2e-3,
    }],
    places: &[],
};

pub const SPEED_DRAG: EffectDefinition = EffectDefinition {
    name: "speed_drag",
    about: "drag that grows with speed",
    strengths: &[StrengthDefinition { name: "drag", unit: "N s²/m²", about: "of a cart", low: -2.0, high: 50.0 }],
    places: &[],
};

pub const CONTROL_DELAY: EffectDefinition = EffectDefinition {
    name: "control_delay",
    about: "a drive that answers late",
    strengths: &[StrengthDefinition { name: "delay", unit: "s", about: "from speed to thrust", low: 0.0, high: 5.0 }],
    places: &[
        PlaceDefinition {
            name: "saturation",
            kind: PlaceKind::Number,
            about: "share of the largest thrust",
            default: 1.0,
        },
        PlaceDefinition {
            name: "gains",
            kind: PlaceKind::Number,
            about: "of the controller, over the planned ones",
            default: 1.0,
        },
    ],
};

pub const CART_BENDING: EffectDefinition = EffectDefinition {
    name: "cart_bending",
    about: "carts that bend",
    strengths: &[StrengthDefinition {
        name: "compliance",
        unit: "m/N",
        about: "of a cart's end",
        low: 0.0,
        high: 1e-4,
    }],
    places: &[],
};

pub const SENSOR_GAIN: EffectDefinition = EffectDefinition {
    name: "sensor_gain",
    about: "a gain that is off",
    strengths: &[StrengthDefinition {
        name: "gain",
        unit: "",
        about: "change of the gain, g − 1",
        low: -0.9,
        high: 3.0,
    }],
    places: &[PlaceDefinition { name: "channel", kind: PlaceKind::ForceChannel, about: "", default: 1.0 }],
};

pub const SENSOR_BIAS_DRIFT: EffectDefinition = EffectDefinition {
    name: "sensor_bias_drift",
    about: "an offset that drifts",
    strengths: &[
        StrengthDefinition { name: "offset", unit: "N", about: "from the beginning", low: -2e3, high: 2e3 },
        StrengthDefinition { name: "drift", unit: "N/s", about: "of the offset", low: -50.0, high: 50.0 },
    ],
    places: &[PlaceDefinition { name: "channel", kind: PlaceKind::ForceChannel, about: "", default: 1.0 }],
};

pub const SENSOR_CROSSTALK: EffectDefinition = EffectDefinition {
    name: "sensor_crosstalk",
    about: "a part of one channel in another",
    strengths: &[StrengthDefinition {
        name: "ratio",
        unit: "",
        about: "of the first channel in the second",
        low: -0.5,
        high: 0.5,
    }],
    places: &[
        PlaceDefinition { name: "first", kind: PlaceKind::ForceChannel, about: "which it comes from", default: 1.0 },
        PlaceDefinition { name: "second", kind: PlaceKind::ForceChannel, about: "which it goes into", default: 2.0 },
    ],
};

pub const SENSOR_LAG: EffectDefinition = EffectDefinition {
    name: "sensor_lag",
    about: "a channel that comes late",
    strengths: &[StrengthDefinition { name: "delay", unit: "s", about: "behind the others", low: 0.0, high: 2.0 }],
    places: &[
        PlaceDefinition { name: "channel", kind: PlaceKind::ForceChannel, about: "", default: 1.0 },
        PlaceDefinition {
            name: "order",
            kind: PlaceKind::Number,
            about: "lags of the first order in a row; 0 for a pure delay",
            default: 0.0,
        },
    ],
};

pub const SENSOR_CLIPPING: EffectDefinition = EffectDefinition {
    name: "sensor_clipping",
    about: "a channel that clips",
    strengths: &[StrengthDefinition {
        name: "loss",
        unit: "",
        about: "of the channel's range, at its top",
        low: 0.0,
        high: 0.95,
    }],
    places: &[PlaceDefinition { name: "channel", kind: PlaceKind::ForceChannel, about: "", default: 1.0 }],
};

pub const SENSOR_SWAPPED: EffectDefinition = EffectDefinition {
    name: "sensor_swapped",
    about: "two channels exchanged",
    strengths: &[StrengthDefinition { name: "share", unit: "", about: "1 for exchanged", low: 0.5, high: 1.0 }],
    places: &[
        PlaceDefinition { name: "first", kind: PlaceKind::ForceChannel, about: "", default: 1.0 },
        PlaceDefinition { name: "second", kind: PlaceKind::ForceChannel, about: "", default: 2.0 },
    ],
};

pub const RAIL_WAVINESS: EffectDefinition = EffectDefinition {
    name: "rail_waviness",
    about: "rails that are not quite even",
    strengths: &[StrengthDefinition {
        name: "amplitude",
        unit: "m",
        about: "root mean square of each rail",
        low: 0.0,
        high: 2e-3,
    }],
    places: &[PlaceDefinition { name: "draw", kind: PlaceKind::Number, about: "which waves", default: 1.0 }],
};

/// Effects that a diagnosis may name.
pub const EFFECTS: [&EffectDefinition; 22] = [
    &JOINT_CLEARANCE,
    &WHEEL_SLIDING,
    &FORK_SWIVEL,
    &TRACK_FLEXIBILITY,
    &WHEEL_OUT_OF_ROUND,
    &RAIL_STEP,
    &MOTOR_RIPPLE,
    &MOTOR_IMBALANCE,
    &JOINT_FRICTION,
    &LOAD_DISTRIBUTION,
    &STIFFNESS_TEMPERATURE,
    &CURVE_GEOMETRY,
    &PITCH_WEAR,
    &SPEED_DRAG,
    &CONTROL_DELAY,
    &CART_BENDING,
    &SENSOR_GAIN,
    &SENSOR_BIAS_DRIFT,
    &SENSOR_CROSSTALK,
    &SENSOR_LAG,
    &SENSOR_CLIPPING,
    &SENSOR_SWAPPED,
];

/// What every built chain has, so that no diagnosis names it; a layout may.
pub const AS_BUILT: [&EffectDefinition; 1] = [&RAIL_WAVINESS];

/// The effect of a name.
pub fn named(name: &str) -> Option<&'static EffectDefinition> {
    EFFECTS.into_iter().chain(AS_BUILT).find(|e| e.name == name)
}

/// A unit as the language spells it.
pub fn spelled(unit: &str) -> String {
    unit.replace(' ', "*").replace('²', "^2")
}

impl EffectDefinition {
    /// SI unit of what says its place; `None` of what does not.
    pub fn place_unit(&self, name: &str) -> Option<&'static str> {
        let place = self.places.iter().find(|p| p.name == name)?;
        Some(match place.kind {
            PlaceKind::Length => "m",
            PlaceKind::Time => "s",
            PlaceKind::Number | PlaceKind::ForceChannel => "",
        })
    }

    /// SI unit of a strength or of what says its place, as a layout writes it; empty for a ratio.
    pub fn unit(&self, name: &str) -> Option<&'static str> {
        self.strengths.iter().find(|s| s.name == name).map(|s| s.unit).or_else(|| self.place_unit(name))
    }
}
