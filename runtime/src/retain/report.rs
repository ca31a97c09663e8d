//! `plcc retain show` and `plcc retain diff`: what a retain file holds, and what would become of it.

use super::Problem;
use super::directory::{Directory, Entry, Fate, fates};
use super::file::{Old, Set, parse};
use super::live;
use crate::image::Image;
use crate::path::{Leaf, Resolver};
use std::collections::HashMap;
use std::fmt::Write;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

/// Every retained value, one a line: name, type, value.
pub fn show(path: &Path) -> Result<String, Problem> {
    let old = read(path)?;
    let mut out = String::new();
    for entry in &old.directory.entries {
        let kind = old.directory.kind(entry).text();
        // Writing to a String does not fail.
        let _ = writeln!(out, "{} : {kind} := {}", entry.name, text(&old.directory, entry, &old.sets));
    }
    Ok(out)
}

/// Values of two files that differ.
pub fn compare_values(a: &Path, b: &Path) -> Result<String, Problem> {
    let (a, b) = (read(a)?, read(b)?);
    let mut theirs: HashMap<String, &Entry> =
        b.directory.entries.iter().map(|e| (e.name.to_ascii_uppercase(), e)).collect();
    let mut out = String::new();
    for entry in &a.directory.entries {
        let kind = a.directory.kind(entry).text();
        let value = text(&a.directory, entry, &a.sets);
        match theirs.remove(&entry.name.to_ascii_uppercase()) {
            None => {
                let _ = writeln!(out, "- {} : {kind} := {value}", entry.name);
            }
            Some(other) => {
                let (other_kind, other_value) = (b.directory.kind(other).text(), text(&b.directory, other, &b.sets));
                if (&kind, &value) != (&other_kind, &other_value) {
                    let _ = writeln!(out, "~ {} : {kind} := {value} -> {other_kind} := {other_value}", entry.name);
                }
            }
        }
    }
    for entry in b.directory.entries.iter().filter(|e| theirs.contains_key(&e.name.to_ascii_uppercase())) {
        let kind = b.directory.kind(entry).text();
        let _ = writeln!(out, "+ {} : {kind} := {}", entry.name, text(&b.directory, entry, &b.sets));
    }
    Ok(out)
}

/// What becomes of a file's values in a program: kept, changed, dropped, new.
pub fn compare_program(path: &Path, image: &Image) -> Result<String, Problem> {
    let old = read(path)?;
    let directory = Directory::of(image, &Resolver::new(image)).map_err(|e| (2, e))?;
    let (fates, gone) = fates(&old, &directory);
    let (mut out, mut kept) = (String::new(), 0);
    for (entry, fate) in directory.entries.iter().zip(&fates) {
        let kind = directory.kind(entry).text();
        let _ = match fate {
            Fate::Kept(_) => {
                kept += 1;
                Ok(())
            }
            Fate::OtherType(before) => writeln!(out, "dropped  {} : {before}; it is {kind} now", entry.name),
            Fate::ValueGone(value) => writeln!(out, "dropped  {} := {value}; there is no such value now", entry.name),
            Fate::New => writeln!(out, "new      {} : {kind}", entry.name),
        };
    }
    for entry in gone.iter().map(|n| &old.directory.entries[*n]) {
        let value = text(&old.directory, entry, &old.sets);
        let _ = writeln!(out, "dropped  {} : {} := {value}", entry.name, old.directory.kind(entry).text());
    }
    let _ = writeln!(out, "kept     {kept} of {} variables", directory.entries.len());
    Ok(out)
}

fn read(path: &Path) -> Result<Old, Problem> {
    let fail = |e: std::io::Error| (3, format!("cannot read retain file `{}`: {e}", path.display()));
    let bytes = std::fs::read(path).map_err(fail)?;
    let meta = std::fs::metadata(path).map_err(fail)?;
    let mut old =
        parse(&bytes).ok_or_else(|| (3, format!("`{}` is no retain file, or it is damaged", path.display())))?;
    // A program that runs, or was killed, has newer values in memory.
    let live = live::read(&old.id, (meta.dev(), meta.ino()), &old.directory);
    for (set, live) in old.sets.iter_mut().zip(live) {
        if live.sequence > set.sequence {
            *set = live;
        }
    }
    Ok(old)
}

fn text(directory: &Directory, entry: &Entry, sets: &[Set]) -> String {
    let image = Image { types: vec![directory.kind(entry).desc()], ..Image::default() };
    let leaf = Leaf { offset: 0, bit: entry.bit, ty: 0, constant: false };
    Resolver::types_only(&image).text(&leaf, directory.value(entry, sets))
}
