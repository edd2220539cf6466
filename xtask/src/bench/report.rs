//! A record in words: Markdown that is read as well on a terminal.

use super::record::{Coding, Record, title};
use super::summary::{Summary, distinct};

const MEGABYTE: f64 = 1e6;

/// The whole record.
pub(super) fn markdown(record: &Record) -> String {
    let mut text = heading(record);
    for summary in Summary::of_tasks(record) {
        text += &format!("\n## {}\n\n{}", title(summary.task), means(&summary));
        let decimals = |figure: f64, places: usize| format!("{figure:.places$}");
        text += &format!(
            "\nBits per sample:\n\n{}",
            each(&summary, &|row| decimals(summary.bits_per_sample(row), 3))
        );
        let encode = |row: &Coding| decimals(summary.speed(row, row.encode_seconds), 1);
        text += &format!("\nEncoding, MB/s:\n\n{}", each(&summary, &encode));
        let decode = |row: &Coding| decimals(summary.speed(row, row.decode_seconds), 1);
        text += &format!("\nDecoding, MB/s:\n\n{}", each(&summary, &decode));
    }
    text + &memory(record) + &lifting(record) + &instructions(record)
}

fn heading(record: &Record) -> String {
    let machine = &record.machine;
    let mut text = format!(
        "# Measured on {}\n\n\
         wavelift at {}, {}, on {} ({} cores, {}).\n\n\
         Times are CPU time on one thread, the least of several runs; a megabyte is 10^6 bytes of samples. Every answer\n\
         was checked. Image codecs code slice by slice.\n",
        record.date, machine.commit, machine.rustc, machine.processor, machine.cores, machine.system
    );
    for note in &record.notes {
        text += &format!("\nNote: {note}.\n");
    }
    for codec in distinct(record.refused.iter().map(|row| row.codec.as_str())) {
        let volumes =
            distinct(record.refused.iter().filter(|row| row.codec == codec).map(|row| row.volume.as_str()));
        text += &format!("\nNote: {codec} does not take {}.\n", volumes.join(", "));
    }
    text
}

/// One line a codec: means, and its size beside wavelift's.
fn means(summary: &Summary<'_>) -> String {
    let ours = summary.ours();
    let mut header: Vec<String> =
        ["codec", "volumes", "bits/sample", "encode MB/s", "decode MB/s"].map(str::to_owned).to_vec();
    header.extend(ours.iter().map(|codec| format!("size / {codec}")));
    let rows = summary.codecs.iter().map(|codec| {
        let mean = summary.mean(codec);
        let mut cells = vec![mean.codec, mean.volumes.to_string()];
        cells.extend([format!("{:.3}", mean.bits_per_sample)]);
        cells.extend([mean.encode, mean.decode].map(|speed| format!("{speed:.1}")));
        cells.extend(ours.iter().map(|our| format!("{:.3}", summary.ratio(codec, our))));
        cells
    });
    let text = "Geometric means over the volumes that a codec takes; sizes beside each other over those that both take.\n\n";
    text.to_owned() + &table(&header, &rows.collect::<Vec<_>>())
}

/// One line a volume, one column a codec.
fn each(summary: &Summary<'_>, figure: &dyn Fn(&Coding) -> String) -> String {
    let mut header = vec!["volume".to_owned()];
    header.extend(summary.codecs.iter().map(|codec| (*codec).to_owned()));
    let rows = summary.volumes().into_iter().map(|volume| {
        let cell = |codec: &&str| summary.row(volume, codec).map_or_else(|| "-".to_owned(), figure);
        [vec![volume.to_owned()], summary.codecs.iter().map(cell).collect()].concat()
    });
    table(&header, &rows.collect::<Vec<_>>())
}

/// What the host takes for a volume, and the kernel for a brick.
fn memory(record: &Record) -> String {
    let header = ["volume", "codec", "samples", "encoding", "decoding"].map(str::to_owned);
    let megabytes = |bytes: u64| format!("{:.2} MB", bytes as f64 / MEGABYTE);
    let rows = record.coding.iter().filter_map(|row| {
        let volume = record.volumes.iter().find(|volume| volume.name == row.volume)?;
        let [encode, decode] = [row.encode_memory?, row.decode_memory?].map(megabytes);
        Some(vec![row.volume.clone(), row.codec.clone(), megabytes(volume.bytes()), encode, decode])
    });
    let host = table(&header, &rows.collect::<Vec<_>>());
    let header =
        ["extent", "way", "encoder's state", "decoder's state", "scratch", "samples", "longest codestream"]
            .map(str::to_owned);
    let rows = record.memory.iter().map(|row| {
        let [x, y, z] = row.extent;
        let bytes = [row.encoder, row.decoder, row.scratch, row.samples, row.output];
        [vec![format!("{x}x{y}x{z}"), row.way.clone()], bytes.map(|bytes| bytes.to_string()).to_vec()]
            .concat()
    });
    let kernel = table(&header, &rows.collect::<Vec<_>>());
    format!(
        "\n## Memory\n\nBytes that the kernel is lent to code u16 samples of an extent, on one thread:\n\n{kernel}\n\
         Most that the host allocates at once beside the samples it is given; what comes out is counted:\n\n{host}"
    )
}

fn lifting(record: &Record) -> String {
    let Some(first) = record.lifting.first() else { return String::new() };
    let header = ["wavelet", "copy, ms", "forward, ms", "inverse, ms", "forward / copy", "inverse / copy"];
    let rows = record.lifting.iter().map(|row| {
        let seconds = [row.copy_seconds, row.forward_seconds, row.inverse_seconds];
        let mut cells = vec![row.wavelet.clone()];
        cells.extend(seconds.map(|seconds| format!("{:.3}", 1e3 * seconds)));
        cells.extend([seconds[1], seconds[2]].map(|seconds| format!("{:.1}", seconds / row.copy_seconds)));
        cells
    });
    let [x, y, z] = first.extent;
    let table = table(&header.map(str::to_owned), &rows.collect::<Vec<_>>());
    format!(
        "\n## Lifting\n\n{x}x{y}x{z} samples of 32 bits, all levels, beside a copy of the same memory:\n\n{table}"
    )
}

fn instructions(record: &Record) -> String {
    if record.instructions.is_empty() {
        return String::new();
    }
    let header = ["volume", "codec", "encoding", "decoding"].map(str::to_owned);
    let rows = record.instructions.iter().map(|row| {
        let [encode, decode] = [row.encode, row.decode].map(|count| format!("{count:.0}"));
        vec![row.volume.clone(), row.codec.clone(), encode, decode]
    });
    format!("\n## Instructions per sample\n\n{}", table(&header, &rows.collect::<Vec<_>>()))
}

/// A table, names to the left and figures to the right.
fn table(header: &[String], rows: &[Vec<String>]) -> String {
    let letters = |cell: &String| cell.chars().count();
    let width = |column: usize| {
        let cells = std::iter::once(&header[column]).chain(rows.iter().map(|row| &row[column]));
        cells.map(letters).max().unwrap_or(0).max(4)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let has_names = |column: usize| rows.iter().any(|row| row[column].starts_with(char::is_alphabetic));
    let named: Vec<bool> = (0..header.len()).map(has_names).collect();
    let line = |cells: &[String]| {
        let padded = cells.iter().zip(&widths).zip(&named).map(|((cell, &width), &named)| {
            if named { format!(" {cell:<width$} |") } else { format!(" {cell:>width$} |") }
        });
        format!("|{}\n", padded.collect::<String>())
    };
    let rules = widths
        .iter()
        .zip(&named)
        .map(|(&width, &named)| if named { "-".repeat(width) } else { "-".repeat(width - 1) + ":" });
    line(header) + &line(&rules.collect::<Vec<_>>()) + &rows.iter().map(|row| line(row)).collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use super::*;

    #[test]
    fn a_report_has_every_codec_and_volume() {
        let text = markdown(&example());
        for part in [
            "| JPEG-LS ",
            "| pcodec ",
            "| one ",
            "Integers without loss",
            "| haar ",
            "64x64x64",
            "Note: a note.",
            "Note: pcodec does not take one.",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(text.contains("| two    |           16.000 |  32.000 | 24.000 |"), "{text}");
    }

    #[test]
    fn tables_are_aligned() {
        let cells = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        let text = table(&cells(["name", "figure"]), &[cells(["ψ", "1"]), cells(["longer", "12"])]);
        assert_eq!(
            text,
            "| name   | figure |\n| ------ | -----: |\n| ψ      |      1 |\n| longer |     12 |\n"
        );
    }
}
