//! `cargo xtask bench`: what wavelift takes and gives, in the same run as rival codecs where Python has them.
//!
//! Sizes, speeds and memory come from programs that are started here: `tests/benches/speed` for wavelift, and
//! `xtask/rivals.py`. Times never fail anything; a wrong answer does.

mod labels;
mod machine;
mod picture;
mod programs;
mod record;
mod report;
mod rival;
mod summary;
mod volumes;

use std::path::{Path, PathBuf};

use clap::Args;
use machine::Machine;
use programs::Speed;
use record::{Record, Row};
use rival::Rival;
use summary::Summary;

use crate::shell::Failures;

/// Where records are kept.
const FOLDER: &str = "bench";

#[derive(Args)]
pub(crate) struct Options {
    /// Folder with a MANIFEST.tsv of volumes to measure beside the built-in ones; may be given more than once
    #[arg(long, value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Measure these volumes only
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Leave out the rivals that take long
    #[arg(long)]
    quick: bool,
    /// A codec and a program, which FILE X Y Z TYPE follow, that prints its bytes and seconds each way
    #[arg(long, value_name = "NAME=PROGRAM")]
    rival: Vec<Rival>,
    /// Write a dated record, and the pictures, into bench/
    #[arg(long)]
    record: bool,
}

/// Measures, prints the report, and keeps it if it is to be kept.
pub(crate) fn run(options: &Options) -> Failures {
    let record = match measure(options) {
        Ok(record) => record,
        Err(error) => return vec![error],
    };
    println!("{}", report::markdown(&record));
    let wrong = record.coding.iter().filter(|row| !row.right);
    let mut failures: Failures = wrong
        .map(|row| format!("{}, {}: {} gives other samples back", row.volume, row.task, row.codec))
        .collect();
    if options.record {
        failures.extend(keep(&record).err());
    }
    failures
}

fn measure(options: &Options) -> Result<Record, String> {
    let volumes = volumes::list(options)?;
    let list = programs::write_list(&volumes, "volumes.json")?;
    let speed = Speed::build()?;
    let mut record = Record {
        date: machine::today(),
        machine: Machine::here(),
        notes: vec![],
        volumes,
        coding: vec![],
        refused: vec![],
        lifting: vec![],
        memory: vec![],
        instructions: vec![],
    };
    for arguments in [["volumes", &list].as_slice(), &["memory"], &["lifting"]] {
        take(&mut record, speed.rows(arguments)?);
    }
    match programs::rivals(&list, options.quick) {
        Ok(rows) => take(&mut record, rows),
        Err(why) => leave_out(&mut record, "rivals in Python", &why),
    }
    for rival in &options.rival {
        let rows = record.volumes.iter().map(|volume| rival.measure(volume)).collect();
        take(&mut record, rows);
    }
    match speed.instructions(&record.volumes, &record.coding) {
        Ok(counts) => record.instructions = counts,
        Err(why) => leave_out(&mut record, "instructions", &why),
    }
    record.volumes.iter_mut().for_each(|volume| volume.path.clear());
    Ok(record)
}

/// Tells why something is not measured, and notes that it is not: the reason is of this machine.
fn leave_out(record: &mut Record, what: &str, why: &str) {
    eprintln!("{what} not measured: {why}");
    record.notes.push(format!("{what} not measured"));
}

/// Puts rows where they belong.
fn take(record: &mut Record, rows: Vec<Row>) {
    for row in rows {
        match row {
            Row::Coding(row) => record.coding.push(row),
            Row::Refused(row) => record.refused.push(row),
            Row::Lifting(row) => record.lifting.push(row),
            Row::Memory(row) => record.memory.push(row),
        }
    }
}

/// Writes the record, as data and in words, and a picture of every task.
fn keep(record: &Record) -> Result<(), String> {
    let write = |name: String, text: String| {
        let path = Path::new(FOLDER).join(name);
        let written = std::fs::create_dir_all(FOLDER).and_then(|()| std::fs::write(&path, text));
        written.map_err(|error| format!("{}: {error}", path.display()))?;
        println!("{}", path.display());
        Ok::<(), String>(())
    };
    let json = serde_json::to_string_pretty(record).map_err(|error| error.to_string())?;
    write(format!("{}.json", record.date), json + "\n")?;
    write(format!("{}.md", record.date), report::markdown(record))?;
    for summary in Summary::of_tasks(record) {
        write(format!("{}.svg", summary.task.replace(' ', "-")), picture::svg(&summary) + "\n")?;
    }
    Ok(())
}

/// A record of three codecs on two volumes, the last of which takes one only.
#[cfg(test)]
fn example() -> Record {
    use record::{Coding, Instructions, Lifting, Memory, Refused};
    use volumes::Listed;

    let listed = |name: &str, element: &str, extent| Listed {
        name: name.to_owned(),
        path: String::new(),
        extent,
        element: element.to_owned(),
        bounds: vec![],
    };
    let coding = |volume: &str, codec: &str, bytes| Coding {
        volume: volume.to_owned(),
        task: "lossless".to_owned(),
        codec: codec.to_owned(),
        bytes,
        encode_seconds: 1.0,
        decode_seconds: 0.5,
        encode_memory: record::is_ours(codec).then_some(10),
        decode_memory: record::is_ours(codec).then_some(20),
        right: true,
    };
    let memory = Memory {
        extent: [64; 3],
        way: "fast".to_owned(),
        encoder: 7600,
        decoder: 7600,
        scratch: 5168,
        samples: 1_048_576,
        output: 9,
    };
    let [volume, codec, why] = ["one", "pcodec", "bytes"].map(str::to_owned);
    Record {
        date: "2026-11-22".to_owned(),
        machine: Machine::example(),
        notes: vec!["a note".to_owned()],
        volumes: vec![listed("one", "u8", [20, 10, 1]), listed("two", "u16", [10, 5, 2])],
        coding: vec![
            coding("one", "wavelift default", 100),
            coding("two", "wavelift default", 200),
            coding("one", "JPEG-LS", 200),
            coding("two", "JPEG-LS", 400),
            coding("two", "pcodec", 300),
        ],
        refused: vec![Refused { volume, codec, why }],
        lifting: vec![Lifting {
            wavelet: "haar".to_owned(),
            extent: [64; 3],
            copy_seconds: 1e-3,
            forward_seconds: 5e-3,
            inverse_seconds: 6e-3,
        }],
        memory: vec![memory],
        instructions: vec![Instructions {
            volume: "one".to_owned(),
            codec: "wavelift default".to_owned(),
            encode: 4400.0,
            decode: 600.0,
        }],
    }
}
