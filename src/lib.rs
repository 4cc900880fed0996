//! `lss` compiles conveyor track layouts.
//!
//! A layout flows one way through the stages, each a pure function from one plain type to the next:
//!
//! 1. [`source`] reads files,
//! 2. [`syntax`] turns text into a tree and back,
//! 3. [`semantics`] resolves names, imports and dimensions: tree to [`model`],
//! 4. [`geometry`] gives the model lines, arcs, clearances and contact areas,
//! 5. `problem` states the optimisation problem without a solver,
//! 6. `solve` solves it in stages,
//! 7. `elements` covers the result with standard track elements,
//! 8. `emit` writes drawings, tables and simulation inputs,
//! 9. [`kinematics`] closes the chain of carts on the centre line,
//! 10. [`dynamics`] moves it.
//!
//! [`signal`] judges runs, measured or simulated: files, filters, spectra, load cycles, deviations.
//!
//! [`identify`] finds the parameters of the model that measurements speak for.
//!
//! [`gap`] says where a built system and its simulation part, which effect does it, and how much adding it closes.
//!
//! [`import`] is a way in: it makes source text of a drawing from CAD.
//!
//! [`base`] is below all of them: hashes, and files that are replaced whole.
//!
//! [`diagnostic`] stands beside every stage; the `lss` binary is a verb a file over these.

pub mod base;
pub mod benchmark;
pub mod chain_input;
pub mod cli;
pub mod compiled;
pub mod diagnostic;
pub mod dynamics;
pub mod effects;
pub mod elements;
pub mod emit;
pub mod gap;
pub mod geometry;
pub mod identify;
pub mod import;
pub mod kinematics;
pub mod model;
pub mod problem;
pub mod report;
pub mod semantics;
pub mod signal;
pub mod solve;
pub mod source;
pub mod syntax;
