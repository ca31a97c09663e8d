//! `plcc bench`, and what the benchmarks of the project share with it: lanes, measuring, counting, the report.

pub mod app;
pub mod command;
pub mod count;
mod facts;
pub mod lane;
pub mod measure;
pub mod report;
pub mod stats;
pub mod svg;
pub mod ticks;

pub use facts::{load, machine, method};
