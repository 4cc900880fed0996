//! The program as users start it: what it says, what it writes, and what it refuses.
//!
//! Each file is a module of this one program, which is linked once and runs its tests on all cores.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "../support/browser.rs"]
mod browser;
mod build;
mod choose;
mod cli;
mod crash;
mod determinism;
mod diff;
mod doc_commands;
mod documents;
mod editor;
mod fits;
mod hub;
mod limits;
mod links;
mod messages;
mod pages;
mod polygon;
mod preview;
#[path = "../support/result_page.rs"]
mod result_page;
mod route;
mod stiffness;
mod study;
mod terminal;
mod trust;
