//! The process image meets the outside: %I is copied in before each execution of a task, %Q is given out after it.
//!
//! A driver is what moves the bytes. It is called in the cycle, so it must not wait: a device that does needs a thread of
//! its own that keeps a copy.

mod csv;
mod shm;

use crate::image::Image;
use crate::path::Resolver;

/// Moves the process image. Errors are sentences; they end the run with exit code 3.
pub trait IoDriver: Send {
    /// A cycle begins (from 1).
    fn begin(&mut self, cycle: u64) {
        let _ = cycle;
    }

    /// Copies inputs into %I. Bytes that it leaves alone keep their values.
    fn read(&mut self, inputs: &mut [u8]) -> Result<(), String>;

    /// Gives %Q out.
    fn write(&mut self, outputs: &[u8]) -> Result<(), String>;

    /// A cycle has ended; the outputs are those of its last task.
    fn end(&mut self, outputs: &[u8]) -> Result<(), String> {
        let _ = outputs;
        Ok(())
    }
}

/// `none`: inputs stay as they are (a stimulus may set them), outputs go nowhere.
pub(crate) struct Nothing;

impl IoDriver for Nothing {
    fn read(&mut self, _: &mut [u8]) -> Result<(), String> {
        Ok(())
    }
    fn write(&mut self, _: &[u8]) -> Result<(), String> {
        Ok(())
    }
}

/// The driver that `--io` names: `none`, `csv:IN.csv,OUT.csv`, `shm:NAME`. An error is an exit code and what to say.
pub fn open(spec: &str, image: &Image, resolver: &Resolver) -> Result<Box<dyn IoDriver>, (u8, String)> {
    let (kind, rest) = spec.split_once(':').unwrap_or((spec, ""));
    match kind {
        "none" => Ok(Box::new(Nothing)),
        "csv" => Ok(Box::new(csv::Csv::open(rest, image, resolver)?)),
        "shm" => Ok(Box::new(shm::Shm::open(rest, image)?)),
        _ => Err((2, format!("--io: there is no driver `{kind}`; there are none, csv:IN.csv,OUT.csv and shm:NAME"))),
    }
}
