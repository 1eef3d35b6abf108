//! `sunshine bench compare`: two files of `sunshine bench run` side by side.

use super::record::{Measured, Record, Row};
use crate::bench_arguments::CompareArguments;
use crate::failure::Failure;
use std::fmt::Write;
use thesis::{Table, seconds};

/// Reads both files and returns the table.
pub fn run(arguments: &CompareArguments) -> Result<String, Failure> {
    let old = Record::read(&arguments.old)?;
    let new = Record::read(&arguments.new)?;
    Ok(comparison(&old, &new))
}

fn comparison(old: &Record, new: &Record) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(text, "old: {old}\nnew: {new}");
    if !old.machine.is_same(&new.machine) {
        text.push_str("the machines differ: ratios are those of the machines, too\n");
    }
    let mut table = Table::new([
        "scene",
        "device",
        "samples",
        "read  ",
        "compile  ",
        "upload  ",
        "first  ",
        "render  ",
        "memory",
        "old Msamples/s",
        "new Msamples/s",
    ]);
    for row in &new.rows {
        if let Some(before) = old.rows.iter().find(|before| is_same(before, row)) {
            table.push(ratios(before, row));
        }
    }
    if table.rows.is_empty() {
        text.push_str("\nno row of one file is in the other\n");
    } else {
        let _ = write!(text, "\nratios new : old, below 1 is faster or smaller\n\n{table}");
        text.push_str(
            "\n* the repeats of old and new do not overlap\n? measured once, so that the spread is not known\n",
        );
    }
    missing(&mut text, "old", old, new);
    missing(&mut text, "new", new, old);
    text
}

/// Whether two rows measure the same.
fn is_same(a: &Row, b: &Row) -> bool {
    let key = |row: &Row| (row.width, row.height, row.depth, row.samples);
    a.scene == b.scene && a.device == b.device && key(a) == key(b)
}

fn ratios(old: &Row, new: &Row) -> [String; 11] {
    let (before, after) = (&old.seconds, &new.seconds);
    // Lossless up to petabytes.
    let memory = |row: &Row| row.peak_memory_bytes.map_or(0.0, |bytes| bytes as f64);
    [
        new.scene.clone(),
        new.device.clone(),
        new.samples.to_string(),
        marked(&before.read, &after.read),
        marked(&before.compile, &after.compile),
        format!("{} ?", ratio(before.upload, after.upload)),
        format!("{} ?", ratio(before.first, after.first)),
        marked(&before.render, &after.render),
        ratio(memory(old), memory(new)),
        seconds(old.samples_per_second / 1e6),
        seconds(new.samples_per_second / 1e6),
    ]
}

fn marked(old: &Measured, new: &Measured) -> String {
    let mark = match old.is_apart_from(new) {
        Some(true) => '*',
        Some(false) => ' ',
        None => '?',
    };
    format!("{} {mark}", ratio(old.best, new.best))
}

fn ratio(old: f64, new: f64) -> String {
    let ratio = new / old;
    // Times of 0 come from coarse clocks.
    if old > 0.0 && new > 0.0 && ratio.is_finite() { format!("{ratio:.2}") } else { "-".to_owned() }
}

/// Names the rows of a file that the other does not have.
fn missing(text: &mut String, name: &str, record: &Record, other: &Record) {
    for row in record.rows.iter().filter(|row| !other.rows.iter().any(|known| is_same(known, row))) {
        let Row { scene, device, samples, width, height, depth, .. } = row;
        let _ = writeln!(
            text,
            "only in {name}: {scene} on {device}, {samples} samples, {width}x{height}, depth {depth}"
        );
    }
}
