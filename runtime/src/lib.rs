//! Runs compiled applications: tasks, process image, clock, stimulus, trace, faults, watchdog.
//!
//! It knows no compiler and no particular engine: an [`image::Image`] says what there is, an [`engine::Engine`] executes,
//! [`cli::RunFlags`] say how. `plcc run` and linked programs (through [`entry`]) go the same way.

pub mod cli;
pub mod engine;
pub mod image;
pub mod run;
#[cfg(test)]
mod testing;
