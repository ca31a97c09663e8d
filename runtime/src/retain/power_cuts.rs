//! Power cuts over a file system in memory that does to unsynced writes what it may: it drops them, applies them in any
//! order, tears them at 512 bytes; a file without its name, an old name after a rename. Cuts come at any operation, while
//! values are saved, while a changed program makes a new file, and again while that recovers.
//!
//! What must hold: what is restored is one whole set of values, not older than the last save that was finished and not
//! newer than the last that was begun. `POWER_CUTS=100000` for the long run; the seed of a failure is in its message.

use super::directory::{Directory, Entry, Kind, SetPlace, carry_over};
use super::disk::Disk;
use super::file::{Found, Old, Set, Store, read};
use plcc_stdlib::elem::Elem;
use std::cell::RefCell;
use std::io;
use std::rc::Rc;

const SECTOR: usize = 512;

/// A file: what the medium has, and the writes that it does not have for certain.
#[derive(Clone, Default)]
struct Inode {
    durable: Vec<u8>,
    pending: Vec<(usize, Vec<u8>)>,
}

/// The file and its successor by their inodes: as programs see them, and as the medium has them for certain.
#[derive(Clone, Default)]
struct Disks {
    inodes: Vec<Inode>,
    names: [Option<usize>; 2],
    durable_names: [Option<usize>; 2],
    /// Names between the durable and the current ones, any of which the medium may have.
    between: Vec<[Option<usize>; 2]>,
    /// Operations until the power fails.
    left: u64,
}

const FILE: usize = 0;
const SUCCESSOR: usize = 1;

#[derive(Clone)]
struct Simulated(Rc<RefCell<Disks>>, bool);

/// xorshift64*.
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    fn below(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) % limit.max(1)
    }
}

impl Inode {
    /// As programs see it.
    fn current(&self) -> Vec<u8> {
        let mut bytes = self.durable.clone();
        self.pending.iter().for_each(|(at, data)| put(&mut bytes, *at, data));
        bytes
    }
}

fn put(bytes: &mut Vec<u8>, at: usize, data: &[u8]) {
    bytes.resize(bytes.len().max(at + data.len()), 0);
    bytes[at..at + data.len()].copy_from_slice(data);
}

impl Disks {
    /// What is there after the power failed.
    fn cut(&mut self, random: &mut Random) {
        for inode in &mut self.inodes {
            // Every write falls into sectors, each of which may come, or not, in any order.
            let mut sectors: Vec<(usize, Vec<u8>)> = Vec::new();
            for (at, data) in std::mem::take(&mut inode.pending) {
                let mut from = 0;
                while from < data.len() {
                    let end = (from + SECTOR - (at + from) % SECTOR).min(data.len());
                    sectors.push((at + from, data[from..end].to_vec()));
                    from = end;
                }
            }
            let keep = random.below(3);
            for n in (1..sectors.len()).rev() {
                sectors.swap(n, random.below(n as u64 + 1) as usize);
            }
            for (at, data) in sectors {
                let comes = match keep {
                    0 => false,
                    1 => true,
                    _ => random.below(2) == 0,
                };
                if comes {
                    put(&mut inode.durable, at, &data);
                }
            }
        }
        self.between.push(self.durable_names);
        self.between.push(self.names);
        self.names = self.between[random.below(self.between.len() as u64) as usize];
        self.durable_names = self.names;
        self.between.clear();
    }

    /// The power is on for so many operations.
    fn operation(&mut self) -> io::Result<()> {
        if self.left == 0 {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        self.left -= 1;
        Ok(())
    }
}

impl Disk for Simulated {
    fn read(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut disks = self.0.borrow_mut();
        disks.operation()?;
        Ok(disks.names[FILE].map(|n| disks.inodes[n].current()))
    }

    fn create(&mut self) -> io::Result<()> {
        let mut disks = self.0.borrow_mut();
        disks.operation()?;
        let names = disks.names;
        disks.between.push(names);
        disks.inodes.push(Inode::default());
        disks.names[SUCCESSOR] = Some(disks.inodes.len() - 1);
        self.1 = true;
        Ok(())
    }

    fn write_at(&mut self, at: u64, bytes: &[u8]) -> io::Result<()> {
        let mut disks = self.0.borrow_mut();
        let inode = disks.names[if self.1 { SUCCESSOR } else { FILE }].ok_or(io::ErrorKind::NotFound)?;
        let done = disks.operation();
        // A write in which the power fails may come in part.
        disks.inodes[inode].pending.push((at as usize, bytes.to_vec()));
        done
    }

    fn sync(&mut self) -> io::Result<()> {
        let mut disks = self.0.borrow_mut();
        disks.operation()?;
        let inode = disks.names[if self.1 { SUCCESSOR } else { FILE }].ok_or(io::ErrorKind::NotFound)?;
        let current = disks.inodes[inode].current();
        disks.inodes[inode] = Inode { durable: current, pending: Vec::new() };
        Ok(())
    }

    fn replace(&mut self) -> io::Result<()> {
        let mut disks = self.0.borrow_mut();
        disks.operation()?;
        let names = disks.names;
        disks.between.push(names);
        disks.names = [names[SUCCESSOR], None];
        self.1 = false;
        // The folder is synced by an operation of its own.
        disks.operation()?;
        disks.durable_names = disks.names;
        disks.between.clear();
        Ok(())
    }
}

/// A program whose variables are `v0`, `v1`, ... in another order in each version; all have one value.
fn directory(version: u64, variables: u32, sets: u32) -> Directory {
    let each = variables / sets;
    let entry = |n: u32| {
        let place = (u64::from(n) * 7 + version * 3) % u64::from(variables);
        Entry { name: format!("v{n}"), kind: 0, at: place as u32 * 8, bit: None }
    };
    Directory {
        sets: (0..sets)
            .map(|s| {
                let last = if s + 1 == sets { variables - each * (sets - 1) } else { each };
                SetPlace { start: s * each * 8, bytes: last * 8 }
            })
            .collect(),
        kinds: vec![Kind::Elem(Elem::Lint.code())],
        entries: (0..variables).map(entry).collect(),
        ranges: vec![Vec::new(); sets as usize],
    }
}

fn filled(directory: &Directory, sequence: u64, value: u64) -> Vec<Set> {
    let values = |bytes: u32| value.to_le_bytes().repeat(bytes as usize / 8);
    directory.sets.iter().map(|s| Set { sequence, values: values(s.bytes) }).collect()
}

/// The one value that all variables have; `None` if nothing was ever saved.
fn value_of(old: &Old) -> Result<Option<u64>, String> {
    let mut found = None;
    for entry in &old.directory.entries {
        let bytes = old.directory.value(entry, &old.sets);
        let value = u64::from_le_bytes(bytes.try_into().map_err(|_| "a value of another size")?);
        if *found.get_or_insert(value) != value {
            return Err(format!("{} is {value}, others are {found:?}", entry.name));
        }
    }
    Ok(found)
}

/// A run of a program version: opens the file as `Retain::open` does and saves rising values until the power fails. Gives
/// the last value whose save was finished and the last whose save was begun.
fn run(
    disk: Simulated,
    version: u64,
    (variables, sets): (u32, u32),
    saves: u64,
    (finished, begun): (&mut u64, &mut u64),
) -> Result<(), String> {
    let mut disk = disk;
    let found = match read(&mut disk) {
        Ok(found) => found,
        Err(_) => return Ok(()),
    };
    let old = match found {
        Found::Nothing => None,
        Found::Damaged => return Err("the file is damaged".into()),
        Found::Old(old) => Some(old),
    };
    let value = old.as_ref().map(value_of).transpose()?.flatten().unwrap_or(0);
    if value < *finished || value > *begun {
        return Err(format!("{value} came back, {finished} was finished and {begun} begun"));
    }
    // What was begun and came back counts, what did not is gone.
    (*finished, *begun) = (value, value);
    let directory = directory(version, variables, sets);
    let (mut start, _) = carry_over(old.as_ref(), &directory, &mut Vec::new());
    let same = old.as_ref().is_some_and(|o| o.directory == directory);
    let mut store = match old.as_ref().filter(|_| same) {
        Some(old) => Store::resume(disk, old),
        None => {
            start.iter_mut().for_each(|s| s.sequence = 1);
            match Store::create(disk, &directory, &start) {
                Ok(store) => store,
                Err(_) => return Ok(()),
            }
        }
    };
    for _ in 0..saves {
        *begun += 1;
        if store.save(&filled(&directory, *begun + 1, *begun)).is_err() {
            return Ok(());
        }
        *finished = *begun;
    }
    Ok(())
}

#[test]
fn power_cuts_tear_nothing_and_lose_no_finished_save() {
    let cuts: u64 = std::env::var("POWER_CUTS").ok().and_then(|n| n.parse().ok()).unwrap_or(3_000);
    let (mut done, mut seed, mut recoveries) = (0, 0, 0);
    while done < cuts {
        seed += 1;
        let mut random = Random::new(seed);
        let disks = Rc::new(RefCell::new(Disks::default()));
        // From values that fit into one sector to some that take many.
        let variables = [3, 60, 64, 200, 700][random.below(5) as usize];
        let sets = 1 + random.below(3) as u32;
        let (mut finished, mut begun, mut version) = (0, 0, 0);
        for _ in 0..2 + random.below(6) {
            if random.below(3) == 0 {
                version += 1;
            }
            // Few operations: the cut comes while the file is opened, made or moved.
            let left = if random.below(2) == 0 { random.below(9) } else { random.below(60) };
            disks.borrow_mut().left = left;
            recoveries += u64::from(left < 9);
            let disk = Simulated(Rc::clone(&disks), false);
            let saves = random.below(20);
            if let Err(e) = run(disk, version, (variables, sets), saves, (&mut finished, &mut begun)) {
                panic!("seed {seed}: {e}");
            }
            disks.borrow_mut().cut(&mut random);
            done += 1;
        }
        // With power, everything can be read.
        disks.borrow_mut().left = u64::MAX;
        let disk = Simulated(Rc::clone(&disks), false);
        if let Err(e) = run(disk, version, (variables, sets), 1, (&mut finished, &mut begun)) {
            panic!("seed {seed}, at the end: {e}");
        }
    }
    assert!(recoveries > cuts / 4);
}

/// The simulation can fail: a file that is overwritten in place, as some runtimes do, is torn by it.
#[test]
fn overwriting_in_place_is_torn_here() {
    let mut torn = 0;
    for seed in 1..200u64 {
        let mut random = Random::new(seed);
        let disks = Rc::new(RefCell::new(Disks { left: u64::MAX, ..Disks::default() }));
        let mut disk = Simulated(Rc::clone(&disks), false);
        let write = |disk: &mut Simulated, value: u8| disk.write_at(0, &[value; 4096]);
        let made =
            disk.create().and_then(|()| write(&mut disk, 1)).and_then(|()| disk.sync()).and_then(|()| disk.replace());
        made.and_then(|()| write(&mut disk, 2)).expect("there is power");
        disks.borrow_mut().cut(&mut random);
        let bytes = disk.read().ok().flatten().expect("the file");
        torn += u64::from(bytes.iter().any(|b| *b != bytes[0]));
    }
    assert!(torn > 20, "{torn}");
}
