//! Benchmarks of plcc; see `cycle_time.rs` and `charts.rs`. Run with `cargo bench`.
