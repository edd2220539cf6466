//! Tables for people.

use std::fmt::Write;

use super::{RUNS, Row, Table};

/// Names and units of the columns; the first two are text, the rest numbers.
const COLUMNS: [[&str; 2]; 12] = [
    ["wavelet", ""],
    ["", ""],
    ["levels", ""],
    ["time", "ms"],
    ["order-0", "%"],
    ["rate", ""],
    ["zeros", "%"],
    ["min", ""],
    ["max", ""],
    ["stream", "bytes"],
    ["stream", "%"],
    ["stream", "bits/sample"],
];

/// Where the text's figure goes: beside the code length that it is one of.
const REFERENCE_COLUMN: usize = 5;

/// Spaces between columns.
const GAP: &str = "   ";

/// All tables with a title each, aligned, and a legend of the columns at the end.
pub fn text(tables: &[Table]) -> String {
    let mut text = String::new();
    for table in tables {
        write_table(&mut text, table);
    }
    text += &legend();
    if tables.iter().any(|table| table.reference.is_some()) {
        text += "Table    order-0 in the dissertation, from another simulation of the same kind: to set beside, not to equal\n";
    }
    text
}

/// What the columns mean.
fn legend() -> String {
    format!(
        "\
time     forward transform on one core, best of {RUNS} runs
order-0  code length of the histogram of all coefficients, in percent of the samples' bytes (Diss eq. 3.71);
         the histogram itself is not counted, so no file has this length
rate     bytes of the samples / order-0 code length
zeros    coefficients that are zero; min, max: the range of all
stream   codestreams of the kernel, headers included; each was decoded and compared bit for bit
         (a .wlift file adds its index)
"
    )
}

fn write_table(text: &mut String, table: &Table) {
    let _ = writeln!(text, "{}: {}\n", table.title, table.description());
    let mut header = COLUMNS.map(|[name, _]| name.to_owned()).to_vec();
    let mut units = COLUMNS.map(|[_, unit]| unit.to_owned()).to_vec();
    if let Some(reference) = table.reference {
        header.insert(REFERENCE_COLUMN, reference.table.to_owned());
        units.insert(REFERENCE_COLUMN, "%".to_owned());
    }
    let mut lines = vec![header, units];
    lines.extend(table.rows.iter().map(|row| cells(table, row)));
    let widths: Vec<usize> = (0..lines[0].len())
        .map(|column| lines.iter().map(|line| line[column].len()).max().unwrap_or(0))
        .collect();
    for line in &lines {
        let cells = line.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match column {
            0 | 1 => format!("{cell:width$}"),
            _ => format!("{cell:>width$}"),
        });
        let _ = writeln!(text, "{}", cells.collect::<Vec<_>>().join(GAP).trim_end());
    }
    if let Some(best) = table.best() {
        let ratio = table.raw_bytes() as f64 / best.stream_bytes as f64;
        let _ =
            writeln!(text, "\nSmallest stream: {}, {} bytes, {ratio:.2}:1\n", best.name(), best.stream_bytes);
    }
}

fn cells(table: &Table, row: &Row) -> Vec<String> {
    let raw_bytes = table.raw_bytes();
    let mut cells = vec![
        row.name().to_owned(),
        row.wavelet.map_or("", |wavelet| wavelet.symbol()).to_owned(),
        row.levels.to_string(),
        row.forward.map_or("-".to_owned(), |time| format!("{:.2}", time.as_secs_f64() * 1e3)),
        format!("{:.1}", row.measure.percent_of(raw_bytes)),
        format!("{:.2}", row.measure.rate(raw_bytes)),
        format!("{:.1}", row.measure.zeros_percent()),
        row.measure.min.to_string(),
        row.measure.max.to_string(),
        row.stream_bytes.to_string(),
        format!("{:.1}", table.stream_percent(row)),
        format!("{:.3}", table.bits_per_sample(row)),
    ];
    if table.reference.is_some() {
        let percent = table.reference_percent(row);
        let cell = percent.map_or("-".to_owned(), |percent| format!("{percent:.1}"));
        cells.insert(REFERENCE_COLUMN, cell);
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::example;

    #[test]
    fn columns_are_aligned() {
        let text = text(&[example()]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "a <line> & more: 8 samples of i16, 16 bytes, in one brick");
        let end = lines[3].len();
        assert!(lines[3].ends_with("bits/sample"));
        for line in &lines[4..11] {
            assert_eq!(line.len(), end, "{line}");
        }
        let column = lines[2].find("Table 0.0").unwrap() + "Table 0.0".len();
        assert!(lines[9][..column].ends_with(" 10.5") && lines[10][..column].ends_with(" -"));
        assert!(lines[5].starts_with("quadratic    psi_Q        3   2.50"), "{}", lines[5]);
        assert!(lines[10].starts_with("none                      0      -"), "{}", lines[10]);
        assert_eq!(lines[12], "Smallest stream: haar, 2 bytes, 8.00:1");
    }

    #[test]
    fn without_a_reference_the_dissertation_is_not_mentioned() {
        let mut table = example();
        table.reference = None;
        let text = text(&[table]);
        assert!(!text.contains("dissertation"));
        assert!(text.lines().nth(2).unwrap().ends_with("stream"));
    }
}
