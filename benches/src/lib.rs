//! Benchmarks of plcc; see `cycle_time.rs`. Run with `cargo bench`.
