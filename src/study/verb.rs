//! What a step of a task may be: verbs of the command line, and which of their options a study may set.
//!
//! Options that would make a result hang on time (`--time-limit`) or that start a program (`--model`, `--fmu`) are not
//! among them.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verb {
    Build,
    Simulate,
    Identify,
    Diagnose,
    Challenge,
}

/// What a verb works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Works {
    /// A layout, `.lss` or `simulation.json`.
    OnTrack,
    /// Runs: a campaign.
    OnRuns,
}

/// How an option's value is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OptionKind {
    /// `--speed=2m/s`
    Value,
    /// `--supports`, where the value is true.
    Flag,
    /// A file, whose content counts.
    File,
    /// `--set=KEY=VALUE`, for each key of a table.
    Table,
}

/// An option of a verb: its key in `study.toml` and how it is told.
#[derive(Clone, Copy, Debug)]
pub struct VerbOption {
    pub key: &'static str,
    pub kind: OptionKind,
}

impl VerbOption {
    /// `--sensor-cart` of `sensor_cart`.
    pub fn flag(&self) -> String {
        format!("--{}", self.key.replace('_', "-"))
    }
}

const fn value(key: &'static str) -> VerbOption {
    VerbOption { key, kind: OptionKind::Value }
}

const fn flag(key: &'static str) -> VerbOption {
    VerbOption { key, kind: OptionKind::Flag }
}

const fn file(key: &'static str) -> VerbOption {
    VerbOption { key, kind: OptionKind::File }
}

const BUILD: &[VerbOption] = &[
    value("layout"),
    value("solver"),
    value("perturb"),
    value("seed"),
    value("gap"),
    value("nodes"),
    flag("stages"),
    flag("pdf"),
];
const SIMULATE: &[VerbOption] = &[
    value("layout"),
    value("laps"),
    value("settle"),
    value("speed"),
    value("tension"),
    value("law"),
    value("step"),
    value("integrator"),
    value("sensor_cart"),
    flag("supports"),
    VerbOption { key: "set", kind: OptionKind::Table },
    value("run_format"),
];
const IDENTIFY: &[VerbOption] = &[file("layout"), value("law"), value("free"), value("share"), value("seed")];
const DIAGNOSE: &[VerbOption] = &[file("layout"), value("seed"), flag("apply")];
const CHALLENGE: &[VerbOption] = &[value("cases"), value("seed"), value("only")];

impl Verb {
    pub const ALL: [Verb; 5] = [Verb::Build, Verb::Simulate, Verb::Identify, Verb::Diagnose, Verb::Challenge];

    /// As `study.toml` and folders call it.
    pub fn name(self) -> &'static str {
        match self {
            Verb::Build => "build",
            Verb::Simulate => "simulate",
            Verb::Identify => "identify",
            Verb::Diagnose => "diagnose",
            Verb::Challenge => "challenge",
        }
    }

    pub fn find(name: &str) -> Option<Verb> {
        Verb::ALL.into_iter().find(|verb| verb.name() == name)
    }

    pub fn works(self) -> Works {
        match self {
            Verb::Build | Verb::Simulate | Verb::Challenge => Works::OnTrack,
            Verb::Identify | Verb::Diagnose => Works::OnRuns,
        }
    }

    pub fn options(self) -> &'static [VerbOption] {
        match self {
            Verb::Build => BUILD,
            Verb::Simulate => SIMULATE,
            Verb::Identify => IDENTIFY,
            Verb::Diagnose => DIAGNOSE,
            Verb::Challenge => CHALLENGE,
        }
    }

    pub fn option(self, key: &str) -> Option<VerbOption> {
        self.options().iter().find(|option| option.key == key).copied()
    }

    /// The words that begin its command line.
    pub fn words(self) -> &'static [&'static str] {
        match self {
            Verb::Build => &["build"],
            Verb::Simulate => &["simulate"],
            Verb::Identify => &["identify"],
            Verb::Diagnose => &["gap", "diagnose"],
            Verb::Challenge => &["gap", "challenge", "new"],
        }
    }

    /// Of what steps before it made, what it works on: the step and the file in the step's folder, or all of it.
    pub fn takes_from(self) -> Option<(Verb, &'static str)> {
        match self {
            Verb::Build => None,
            Verb::Simulate | Verb::Challenge => Some((Verb::Build, "simulation.json")),
            Verb::Identify | Verb::Diagnose => Some((Verb::Simulate, "")),
        }
    }
}
