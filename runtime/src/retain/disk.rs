//! What the retain file needs of a file system, so that a test can put one underneath that loses power.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read};
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::{Path, PathBuf};

/// One file and its successor beside it, which takes its place.
pub trait Disk {
    /// All bytes of the file; `None` if there is none.
    fn read(&mut self) -> io::Result<Option<Vec<u8>>>;
    /// Makes an empty successor.
    fn create(&mut self) -> io::Result<()>;
    /// Writes into the successor, if there is one, else into the file.
    fn write_at(&mut self, at: u64, bytes: &[u8]) -> io::Result<()>;
    /// Waits until the writes before are on the medium.
    fn sync(&mut self) -> io::Result<()>;
    /// The successor becomes the file, on the medium too.
    fn replace(&mut self) -> io::Result<()>;
}

/// The operating system's.
#[derive(Debug)]
pub struct RealDisk {
    path: PathBuf,
    file: Option<File>,
    successor: Option<File>,
}

impl RealDisk {
    /// The file at a path, locked if it exists. `WouldBlock` if another program has it.
    pub fn new(path: &Path) -> io::Result<Self> {
        let file = match OpenOptions::new().read(true).write(true).open(path) {
            Ok(file) => Some(file),
            Err(e) if e.kind() == ErrorKind::NotFound => None,
            Err(e) => return Err(e),
        };
        if let Some(file) = &file {
            lock(file)?;
        }
        Ok(Self { path: path.into(), file, successor: None })
    }

    /// Device and number of the file: a copy of it has others.
    pub fn identity(&self) -> (u64, u64) {
        let meta = self.file.as_ref().and_then(|f| f.metadata().ok());
        meta.map_or((0, 0), |m| (m.dev(), m.ino()))
    }

    fn sibling(&self) -> PathBuf {
        let mut name = self.path.as_os_str().to_owned();
        name.push(".new");
        name.into()
    }

    fn open_file(&self) -> io::Result<&File> {
        self.successor.as_ref().or(self.file.as_ref()).ok_or_else(|| ErrorKind::NotFound.into())
    }
}

impl Disk for RealDisk {
    fn read(&mut self) -> io::Result<Option<Vec<u8>>> {
        let Some(mut file) = self.file.as_ref() else { return Ok(None) };
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        Ok(Some(bytes))
    }

    fn create(&mut self) -> io::Result<()> {
        let options = OpenOptions::new().read(true).write(true).create(true).truncate(true).to_owned();
        let file = options.open(self.sibling())?;
        lock(&file)?;
        self.successor = Some(file);
        Ok(())
    }

    fn write_at(&mut self, at: u64, bytes: &[u8]) -> io::Result<()> {
        self.open_file()?.write_all_at(bytes, at)
    }

    fn sync(&mut self) -> io::Result<()> {
        let file = self.open_file()?;
        if self.successor.is_some() { file.sync_all() } else { file.sync_data() }
    }

    fn replace(&mut self) -> io::Result<()> {
        std::fs::rename(self.sibling(), &self.path)?;
        self.file = self.successor.take();
        // The new name is on the medium only when the folder is.
        let folder = match self.path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        File::open(folder)?.sync_all()
    }
}

/// Two programs on one file would overwrite each other.
fn lock(file: &File) -> io::Result<()> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(ErrorKind::WouldBlock.into()),
        // Some file systems know no locks.
        Err(TryLockError::Error(_)) => Ok(()),
    }
}
