//! `lss` compiles conveyor track layouts.
//!
//! A layout flows one way through the rooms below, each a pure function from one plain type to the next. A room uses
//! only rooms above it; `tests/architecture.rs` holds that, and `docs/architecture.md` says why.
//!
//! - [`base`]: what has no subject: writing of numbers, JSON, random numbers, Student's t, a parallel map, hashing,
//!   trigonometry,
//! - [`source`]: files and spans; the only door to the disk, with the project's root,
//! - [`diagnostic`]: one type of diagnostic, its codes and their pages, as text and as JSON,
//! - [`syntax`]: text to a tree and back, keeping comments,
//! - [`geometry`]: lines, arcs, spirals, fillets, polygons, clearances, the centre line,
//! - [`model`]: the checked layout: immutable, in SI units, each item with its span; what effects a layout may name,
//! - [`semantics`]: names, imports, dimensions and checks: a tree to the model,
//! - [`import`]: a drawing from CAD to a layout's text,
//! - [`elements`]: standard track elements: sequence, closure, space, bill,
//! - [`placement`]: where equipment with a footprint stands along a track, and what is in its way,
//! - [`problem`]: the optimisation problem without a solver: variables, rows, objective; files for other solvers,
//! - [`kinematics`]: the chain on the centre line, polygon action,
//! - [`capacity`]: how many items an hour a sorter takes: closed forms and a simulation of carriers and items,
//! - [`solve`]: solvers, stages, the search on the catalogue's grid with bounds, explanations of conflicts,
//! - [`route`]: the vertices of a loop from the sections that it has to pass: orders, ways around obstacles, bounds,
//! - [`compiled`]: a solved layout with everything that its readers need worked out once,
//! - [`chain_input`]: the input of a simulation, `simulation.json`, and the deviations that a built machine may have
//!   from it,
//! - [`signal`]: runs and campaigns, filters, spectra, load cycles, deviations between runs,
//! - [`review`]: what changed between two solved layouts and their runs, as text, Markdown and JSON,
//! - [`dynamics`]: bodies, contacts, motors, control, integration, the sensor cart; deviations, but no effects,
//! - [`effects`]: one file an effect: what it does to the chain or to its sensors, and how it is told from others,
//! - [`choose`]: which components a layout is built with: every candidate, the cheapest checked, trades,
//! - [`identify`]: parameters of the model from measurements,
//! - [`gap`]: where a built system and its simulation part, and which effect does it; models outside,
//! - [`benchmark`]: sealed challenges: campaigns whose effects are withheld, and what a diagnosis makes of them,
//! - [`study`]: many tasks that differ in their parameters, done here or on a cluster, and one table of them,
//! - [`emit`]: files of a layout: SVG, PNG, DXF, CSV, JSON,
//! - [`report`]: pages that a person reads: a lap, an identification, a diagnosis, polygon action, a study,
//! - [`editor`]: the language server: what an editor asks of a layout while it is written,
//! - [`preview`]: a page that follows a layout's file, with vertices to drag,
//! - [`cli`]: one file a verb.

pub mod base;
pub mod benchmark;
pub mod capacity;
pub mod chain_input;
pub mod choose;
pub mod cli;
pub mod compiled;
pub mod diagnostic;
pub mod dynamics;
pub mod editor;
pub mod effects;
pub mod elements;
pub mod emit;
pub mod gap;
pub mod geometry;
pub mod identify;
pub mod import;
pub mod kinematics;
pub mod model;
pub mod placement;
pub mod preview;
pub mod problem;
pub mod report;
pub mod review;
pub mod route;
pub mod semantics;
pub mod signal;
pub mod solve;
pub mod source;
pub mod study;
pub mod syntax;
