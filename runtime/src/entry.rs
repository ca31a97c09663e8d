//! What a linked program starts with: its `main`, made by the code generator, calls [`plcc_main`].

use crate::cli::RunFlags;
use crate::engine::{Engine, InitFn, NativeEngine, ScanFn};
use crate::image::Image;
use crate::run::run;
use clap::{Args, Command, FromArgMatches};
use std::ffi::{CStr, OsString, c_char, c_int};
use std::os::unix::ffi::OsStringExt;

/// Runs the program that this executable is.
///
/// # Safety
/// `argv` holds `argc` C strings, `image` points to `image_len` bytes, and both functions are the entry points of the
/// program that the image describes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn plcc_main(
    argc: c_int,
    argv: *const *const c_char,
    image: *const u8,
    image_len: usize,
    init: InitFn,
    scan: ScanFn,
) -> c_int {
    // SAFETY: promised above.
    let (args, bytes) = unsafe {
        let args: Vec<OsString> = (0..argc.max(0) as usize)
            .map(|n| OsString::from_vec(CStr::from_ptr(*argv.add(n)).to_bytes().to_vec()))
            .collect();
        (args, std::slice::from_raw_parts(image, image_len))
    };
    // A panic is a bug, here or in plcc; the exit code says so (docs/cli.md).
    std::panic::set_hook(Box::new(|panic| {
        eprintln!("a bug in plcc's runtime, please report it: {panic}");
        std::process::exit(70);
    }));
    let image = match Image::decode(bytes) {
        Ok(image) => image,
        Err(_) => {
            eprintln!("the image in this program is damaged; build it again");
            return 70;
        }
    };
    // Once, for the life of the process.
    let name: &'static str = image.name.clone().leak();
    let command = RunFlags::augment_args(Command::new(name).about("A control program built by plcc."));
    let flags = match command.try_get_matches_from(args).and_then(|m| RunFlags::from_arg_matches(&m)) {
        Ok(flags) => flags,
        Err(e) => {
            let _ = e.print();
            return e.exit_code();
        }
    };
    let engine = || -> Box<dyn Engine> {
        // SAFETY: promised above; the run gives regions of the image's size.
        Box::new(unsafe { NativeEngine::new(init, scan) })
    };
    let mut engines: Vec<Box<dyn Engine>> = image.resources.iter().map(|_| engine()).collect();
    c_int::from(run(&image, &mut engines, &flags))
}
