//! From a layout's text to its track, its drawing and its bill: what is read, what is said of it, and what is solved.
//!
//! Each file is a module of this one program, which is linked once and runs its tests on all cores.

#![allow(clippy::expect_used, clippy::unwrap_used)]

mod cases;
mod certificate;
mod cheapest;
mod conflict;
mod contact_area;
mod drawing;
mod equipment;
mod errors;
mod headings;
mod hostile;
mod import;
mod levels;
mod mutated;
mod route;
mod self_crossing;
mod semantics;
mod shortest;
mod size;
mod small;
mod solvers;
mod tracks;
mod trades;
