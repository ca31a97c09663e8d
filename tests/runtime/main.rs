//! The runtime as a plant sees it: programs that plcc builds, run in real time, killed, restarted, watched from outside.
//!
//! Long runs, outside CI: `KILLS=1000` kills a program at so many random moments, `EDITS=1000` edits a program so often.

mod edits;
mod endless;
mod image;
mod retained;
mod scheduling;

use plcc_tests::{Done, command};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

const PLCC: &str = env!("CARGO_BIN_EXE_plcc-under-test");

/// A folder with sources, and programs built in it.
struct Plant {
    folder: tempfile::TempDir,
}

impl Plant {
    fn new(files: &[(&str, &str)]) -> Self {
        let plant = Self { folder: tempfile::tempdir().expect("a folder") };
        for (name, text) in files {
            plant.write(name, text);
        }
        plant
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("a file");
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn plcc(&self, args: &[&str]) -> Done {
        command(Path::new(PLCC), self.folder.path(), args)
    }

    /// Builds an executable.
    fn build(&self, source: &str, app: &str) {
        let done = self.plcc(&["build", source, "-o", app]);
        assert_eq!(done.code, 0, "{}", done.stderr);
    }

    fn run(&self, app: &str, args: &[&str]) -> Done {
        command(&self.path(app), self.folder.path(), args)
    }

    fn start(&self, app: &str, args: &[&str]) -> Child {
        Command::new(self.path(app))
            .args(args)
            .current_dir(self.folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts")
    }
}

fn signal(child: &Child, name: &str) {
    let pid = child.id().to_string();
    assert!(Command::new("kill").args([name, &pid]).status().expect("kill runs").success());
}
