//! Runs an application: image, engine and flags to an exit code.

use crate::cli::RunFlags;
use crate::engine::Engine;
use crate::image::Image;

/// Runs until `--cycles`, a signal or a fault; prints its own messages. The exit code of docs/cli.md.
pub fn run(image: &Image, engine: &mut dyn Engine, flags: &RunFlags) -> u8 {
    let _ = (image, engine, flags);
    2
}
