//! What runs a compiled program: scan loop, tasks, clock, process image, stimulus, trace, faults.
//!
//! It is linked into every program that plcc builds and into plcc itself (for `plcc run`), so that both behave alike. It
//! knows no compiler crate and no engine: an engine is whatever implements [`engine::Engine`], a program is an
//! [`image::Image`].

mod charts;
pub mod cli;
pub mod clock;
mod edges;
pub mod engine;
pub mod entry;
pub mod fault;
mod force;
mod history;
pub mod image;
pub mod io;
pub mod path;
mod realtime;
pub mod release;
pub mod retain;
pub mod run;
mod scan;
mod signals;
mod stats;
pub mod stimulus;
pub mod task;
mod threads;
mod trace;
mod vcd;
pub mod watchdog;
mod worker;
