//! RETAIN variables in a file (`--retain`): restored before the first cycle, kept while the program runs and when it ends.
//!
//! In: the retain ranges of the image, the memory after each finished cycle. Two places keep the values:
//!
//! - the [live](live) area in shared memory, written at the end of each cycle in which something changed: a process that is
//!   killed loses at most the cycle in flight;
//! - the [file](file), written by a thread every flush interval and at the end: a power cut loses at most that.
//!
//! Both hold two slots in turn, and a slot counts only if it is whole, so that what is restored is always the values of one
//! finished cycle; with several resources, of one cycle of each. After an edit of the program values find their variables by
//! name and type ([directory](directory)).

mod directory;
mod disk;
mod file;
mod live;
#[cfg(test)]
mod power_cuts;
mod report;

use crate::image::Image;
use crate::path::Resolver;
use directory::Directory;
pub use directory::Restored;
use disk::RealDisk;
pub use file::MAGIC;
use file::{Set, Store};
use live::Live;
pub use live::Writer;
pub use report::{compare_program, compare_values, show};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How often changed values are written to the file while the program runs, if nothing else is said.
const FLUSH_EVERY: Duration = Duration::from_millis(500);
/// So many dropped values are listed at a start; `plcc retain diff` lists all.
const LISTED: usize = 20;

/// Why retained values cannot be used: an exit code and what to say.
pub type Problem = (u8, String);

/// Keeps the values of the last finished cycles.
#[derive(Debug)]
pub struct Retain {
    path: PathBuf,
    shared: Arc<Shared>,
    thread: Option<std::thread::JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    live: Live,
    store: Mutex<Store<RealDisk>>,
    done: AtomicBool,
    error: Mutex<Option<io::Error>>,
}

/// An open file: what to restore, and who keeps the values of each resource (and of what they share, the last one).
pub struct Opened {
    /// Ends it.
    pub retain: Retain,
    /// Bytes for the memory.
    pub restored: Vec<Restored>,
    /// `None` where nothing is retained.
    pub writers: Vec<Option<Writer>>,
}

impl Retain {
    /// Opens or makes the file. Messages about another version of the program go to standard error.
    pub fn open(path: &Path, image: &Image, resolver: &Resolver, flush: Option<Duration>) -> Result<Opened, Problem> {
        let fail = |e: io::Error| (3, format!("cannot use retain file `{}`: {e}", path.display()));
        let directory = Directory::of(image, resolver).map_err(|e| (2, e))?;
        let mut disk = RealDisk::new(path).map_err(|e| match e.kind() {
            io::ErrorKind::WouldBlock => {
                (3, format!("retain file `{}` is used by another program that runs", path.display()))
            }
            _ => fail(e),
        })?;
        let damaged =
            || (3, format!("`{}` is no retain file, or it is damaged; a cold start needs it removed", path.display()));
        let old = file::read(&mut disk).map_err(fail)?;
        let mut old = match old {
            file::Found::Nothing => None,
            file::Found::Damaged => return Err(damaged()),
            file::Found::Old(old) => Some(old),
        };
        let mut stale = None;
        if let Some(old) = &mut old {
            // What a killed run left is newer than its file.
            for (n, set) in live::read(&old.id, disk.identity(), &old.directory).into_iter().enumerate() {
                if set.sequence > old.sets[n].sequence {
                    old.sets[n] = set;
                }
            }
            stale = Some(old.id);
        }
        let mut restored = Vec::new();
        let (mut sets, dropped) = directory::carry_over(old.as_ref(), &directory, &mut restored);
        let same = old.as_ref().is_some_and(|o| o.directory == directory);
        if let Some(old) = old.as_ref().filter(|_| !same) {
            let kept = restored.len();
            if !old.sets.iter().all(|s| s.sequence == 0) {
                eprintln!(
                    "{}: the retain file is of another version of this program: {kept} of {} variables restored",
                    image.name,
                    directory.entries.len()
                );
                for line in dropped.iter().take(LISTED) {
                    eprintln!("  dropped: {line}");
                }
                if dropped.len() > LISTED {
                    eprintln!("  and {} more", dropped.len() - LISTED);
                }
            }
        }
        if old.as_ref().is_some_and(|o| o.sets.iter().all(|s| s.sequence == 0)) {
            restored.clear();
        }
        let old = old.filter(|_| same);
        let store = match &old {
            Some(old) => Store::resume(disk, old),
            None => {
                // Sequence numbers start again: the file is a new one.
                for set in &mut sets {
                    set.sequence = u64::from(!restored.is_empty());
                }
                Store::create(disk, &directory, &sets).map_err(fail)?
            }
        };
        let (live, told) = Live::open(&store.id, store.identity(), &directory, &sets);
        if let Some(why) = told {
            eprintln!("{}: {why}; a killed process may lose what the last flush did not write", image.name);
        }
        if let Some(stale) = stale.filter(|id| *id != store.id) {
            live::remove(&stale);
        }
        let writers = live.writers(&directory);
        let shared =
            Arc::new(Shared { live, store: Mutex::new(store), done: AtomicBool::new(false), error: Mutex::new(None) });
        let own = Arc::clone(&shared);
        let flush = flush.unwrap_or(FLUSH_EVERY);
        let thread = std::thread::Builder::new().name("retain".into()).spawn(move || own.save_on_and_on(flush));
        let thread = Some(thread.map_err(fail)?);
        Ok(Opened { retain: Self { path: path.into(), shared, thread }, restored, writers })
    }

    /// Ends the thread and writes the values of the last finished cycles.
    pub fn finish(mut self) -> Result<(), String> {
        self.end_thread();
        let failed = |e| format!("cannot write retain file `{}`: {e}", self.path.display());
        let written = self.shared.save().map_err(failed);
        if written.is_ok() {
            // The file has everything: what a killed run would need is not needed.
            live::remove(&guard(&self.shared.store).id);
        }
        written
    }

    fn end_thread(&mut self) {
        self.shared.done.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            let _ = thread.join();
        }
    }
}

impl Drop for Retain {
    fn drop(&mut self) {
        self.end_thread();
    }
}

impl Shared {
    /// The thread: writes what has changed until the run ends. An error is tried again; the last one is told at the end.
    fn save_on_and_on(&self, flush: Duration) {
        while !self.done.load(Ordering::Relaxed) {
            std::thread::park_timeout(flush);
            if self.done.load(Ordering::Relaxed) {
                return;
            }
            *guard(&self.error) = self.save().err();
        }
    }

    fn save(&self) -> io::Result<()> {
        let mut store = guard(&self.store);
        let mut sets = store.sets.clone();
        let mut changed = false;
        for (n, set) in sets.iter_mut().enumerate() {
            changed |= self.live.read_set(n, set);
        }
        if changed || store.behind { store.save(&sets) } else { Ok(()) }
    }
}

/// The values of a set that no slot has yet.
fn empty_sets(directory: &Directory) -> Vec<Set> {
    directory.sets.iter().map(|s| Set { sequence: 0, values: vec![0; s.bytes as usize] }).collect()
}

/// A panic elsewhere does not make the values wrong.
fn guard<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Resource, Root, TypeDesc};
    use plcc_stdlib::elem::Elem;

    fn image(names: &[(&str, u32)]) -> Image {
        let root = |(name, offset): &(&str, u32)| Root {
            name: name.to_string(),
            offset: *offset,
            retain: true,
            ..Root::default()
        };
        Image {
            name: "test".into(),
            resources: vec![Resource { bytes: 128, ..Resource::default() }],
            types: vec![TypeDesc::Elem(Elem::Int.code())],
            roots: names.iter().map(root).collect(),
            retain: names.iter().map(|(_, offset)| (*offset, 2)).collect(),
            ..Image::default()
        }
    }

    fn open(path: &Path, image: &Image) -> Result<Opened, Problem> {
        Retain::open(path, image, &Resolver::new(image), None)
    }

    fn scratch(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("plcc-retain-{}-{name}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        path
    }

    fn value(offset: u32, byte: u8) -> Restored {
        Restored { offset, bit: None, bytes: vec![byte, 0] }
    }

    /// Memory with its own number in each even byte.
    fn memory() -> Vec<u8> {
        (0..=127).map(|n| if n % 2 == 0 { n } else { 0 }).collect()
    }

    fn capture(opened: &mut Opened, memory: &[u8]) {
        opened.writers[0].as_mut().unwrap().capture(0, memory);
    }

    #[test]
    fn the_last_finished_cycle_comes_back() {
        let (path, image) = (scratch("back"), image(&[("a", 64), ("b", 80)]));
        let mut opened = open(&path, &image).unwrap();
        assert_eq!(opened.restored, []);
        assert_eq!(open(&path, &image).err().map(|e| e.0), Some(3), "two programs on one file");
        capture(&mut opened, &[9; 128]);
        capture(&mut opened, &memory());
        opened.retain.finish().unwrap();
        let opened = open(&path, &image).unwrap();
        assert_eq!(opened.restored, [value(64, 64), value(80, 80)]);
        opened.retain.finish().unwrap();
        let _ = std::fs::remove_file(path);
    }

    /// No flush and no finish: as after kill -9.
    #[test]
    fn a_killed_run_loses_no_finished_cycle() {
        let (path, image) = (scratch("killed"), image(&[("a", 64), ("b", 80)]));
        let hour = Some(Duration::from_secs(3600));
        for byte in 1..5u8 {
            let resolver = Resolver::new(&image);
            let mut opened = Retain::open(&path, &image, &resolver, hour).unwrap();
            if byte > 1 {
                let last = vec![byte - 1, byte - 1];
                assert_eq!(opened.restored.iter().map(|r| r.bytes.clone()).collect::<Vec<_>>(), [last.clone(), last]);
            }
            capture(&mut opened, &[9; 128]);
            capture(&mut opened, &[byte; 128]);
            drop(opened);
        }
        let opened = open(&path, &image).unwrap();
        opened.retain.finish().unwrap();
        let _ = std::fs::remove_file(path);
    }

    #[test]
    fn a_changed_program_finds_its_variables_by_name() {
        let path = scratch("changed");
        let mut opened = open(&path, &image(&[("a", 64), ("b", 80)])).unwrap();
        capture(&mut opened, &memory());
        opened.retain.finish().unwrap();
        let changed = image(&[("c", 64), ("B", 100)]);
        let opened = open(&path, &changed).unwrap();
        assert_eq!(opened.restored, [value(100, 80)]);
        drop(opened.retain);
        // The new file holds them even though nothing was captured.
        let opened = open(&path, &changed).unwrap();
        assert_eq!(opened.restored, [value(64, 0), value(100, 80)]);
        opened.retain.finish().unwrap();
        let _ = std::fs::remove_file(path);
    }

    #[test]
    fn a_torn_slot_falls_back_to_the_other_one() {
        let (path, image) = (scratch("torn"), image(&[("a", 64)]));
        for byte in [1, 2] {
            let mut opened = open(&path, &image).unwrap();
            capture(&mut opened, &[byte; 128]);
            opened.retain.finish().unwrap();
        }
        let mut bytes = std::fs::read(&path).unwrap();
        let found = |bytes: &[u8], byte: u8| bytes.windows(2).rposition(|w| w == [byte, byte]).unwrap();
        let at = found(&bytes, 2);
        bytes[at] ^= 4;
        std::fs::write(&path, &bytes).unwrap();
        let opened = open(&path, &image).unwrap();
        assert_eq!(opened.restored, [Restored { offset: 64, bit: None, bytes: vec![1, 1] }]);
        drop(opened.retain);
        live::remove(&file::parse(&bytes).unwrap().id);
        let at = found(&bytes, 1);
        bytes[at] ^= 4;
        std::fs::write(&path, &bytes).unwrap();
        assert!(open(&path, &image).err().unwrap().1.contains("damaged"));
        let _ = std::fs::remove_file(path);
    }
}
