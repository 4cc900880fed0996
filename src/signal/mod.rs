//! Runs, measured or simulated, and what is read from them.
//!
//! A [`Run`] is one data file and one sidecar; [`csv`] and [`parquet`] write and read it, [`mdf4`]
//! reads it too, and a [`Campaign`] lists many. [`gaps`] bridges lost samples
//! and [`position`] turns time into places on the track. The rest are plain functions over slices: [`filter`]s,
//! [`measures`], [`spectrum`] and [`order`] spectra, [`rainflow`] counts. [`compare`] puts two runs side by side.
//!
//! ```
//! use lss::signal::{Channel, Run, Sidecar, csv, measures};
//!
//! let sidecar = Sidecar { layout: "reference.lss".into(), laps: 1, ..Sidecar::default() };
//! let mut run = Run { time: vec![0.0, 0.002, 0.004], sidecar, ..Run::default() };
//! run.channels.insert(Channel::JointXi, vec![409.0, f64::NAN, 410.0]);
//! assert_eq!(csv::write(&run), b"time,joint_xi\n0,409\n0.002,\n0.004,410\n");
//! assert_eq!(measures::statistics(&run.channels[&Channel::JointXi]).unwrap().mean, 409.5);
//! ```

pub mod campaign;
mod channel;
pub(crate) mod columns;
pub mod compare;
pub mod csv;
mod digits;
mod error;
pub mod filter;
pub mod gaps;
pub mod health;
mod keys;
mod mapping;
pub mod mdf4;
pub mod measures;
pub mod order;
pub mod parquet;
pub mod position;
pub mod rainflow;
pub(crate) mod read;
mod run;
mod sidecar;
pub mod spectrum;
mod supports;
mod warnings;

pub use campaign::{Campaign, Entry};
pub use channel::{Channel, FORCES};
pub use columns::{Column, MOST_NUMBERS};
pub use error::{DataPlace, DataProblem, RunError};
pub use run::Run;
pub use sidecar::{Sidecar, SidecarDefaults, sidecar_path};
pub use supports::SupportLoad;
