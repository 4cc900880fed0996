//! The chain and what is measured of it: simulation, runs, identification and diagnosis.
//!
//! Each file is a module of this one program, which is linked once and runs its tests on all cores.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "../support/browser.rs"]
mod browser;
mod chain;
mod compare;
mod gap;
mod harmonics;
mod identify;
mod long_runs;
mod made_up;
mod noisy_windows;
mod outside;
mod outside_failures;
mod outside_models;
#[path = "../../benches/common/record.rs"]
mod record;
#[path = "../support/result_page.rs"]
mod result_page;
mod runs;
mod simulate;
mod single_effect;
#[path = "../../benches/common/track.rs"]
mod track;
mod windows;
