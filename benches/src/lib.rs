//! Benchmarks of plcc: the programs with their C references, what feeds and compares them, and the report. Run with
//! `cargo bench`; see `report.rs`.

pub mod charts;
pub mod command;
pub mod compile_time;
pub mod interface;
pub mod lanes;
pub mod programs;
pub mod reference;
pub mod stimulus;
pub mod targets;
