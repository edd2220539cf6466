//! Tables for machines.

use serde_json::{Value, json as object};

use super::{RUNS, Row, Table};

/// One JSON document of all tables: an object with `version`, `runs` and `tables`.
///
/// Lengths are in bytes, times in milliseconds. A rate is `null` where all coefficients are equal, since their
/// histogram has no length; what a table lacks is `null` too.
pub fn json(tables: &[Table]) -> Value {
    object!({
        "version": env!("CARGO_PKG_VERSION"),
        "runs": RUNS,
        "tables": tables.iter().map(table).collect::<Vec<_>>(),
    })
}

fn table(table: &Table) -> Value {
    object!({
        "title": table.title,
        "extent": table.extent.axes(),
        "type": table.element.name(),
        "raw_bytes": table.raw_bytes(),
        "brick": table.brick,
        "bricks": table.bricks,
        "reference": table.reference.map(|reference| reference.table),
        "rows": table.rows.iter().map(|entry| row(table, entry)).collect::<Vec<_>>(),
    })
}

fn row(table: &Table, row: &Row) -> Value {
    let raw_bytes = table.raw_bytes();
    object!({
        "wavelet": row.name(),
        "symbol": row.wavelet.map(|wavelet| wavelet.symbol()),
        "levels": row.levels,
        "forward_ms": row.forward.map(|time| rounded(time.as_secs_f64() * 1e3)),
        "order0_bytes": row.measure.code_bytes(),
        "order0_percent": rounded(row.measure.percent_of(raw_bytes)),
        "order0_rate": rounded(row.measure.rate(raw_bytes)),
        "zeros_percent": rounded(row.measure.zeros_percent()),
        "min": row.measure.min,
        "max": row.measure.max,
        "stream_bytes": row.stream_bytes,
        "stream_percent": rounded(table.stream_percent(row)),
        "stream_bits_per_sample": rounded(table.bits_per_sample(row)),
        "reference_order0_percent": table.reference_percent(row),
    })
}

/// A figure in ten thousandths, which is finer than any of them means.
fn rounded(figure: impl Into<f64>) -> f64 {
    (figure.into() * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::example;

    #[test]
    fn every_figure_has_a_name() {
        let document = json(&[example()]);
        let table = &document["tables"][0];
        assert_eq!(table["extent"], object!([8, 1, 1]));
        assert_eq!(table["reference"], "Table 0.0");
        let row = &table["rows"][1];
        assert_eq!((&row["wavelet"], &row["symbol"]), (&object!("quadratic"), &object!("psi_Q")));
        assert_eq!((&row["forward_ms"], &row["levels"]), (&object!(2.5), &object!(3)));
        assert_eq!(
            (&row["min"], &row["max"], &row["zeros_percent"]),
            (&object!(-12), &object!(1000), &object!(50.0))
        );
        assert_eq!((&row["stream_bytes"], &row["stream_percent"]), (&object!(4), &object!(25.0)));
        assert_eq!(row["reference_order0_percent"], 50.0);
        let none = &table["rows"][6];
        assert!(none["symbol"].is_null() && none["forward_ms"].is_null());
    }

    #[test]
    fn an_infinite_rate_is_null() {
        let mut table = example();
        table.rows[0].measure = wavelift_kernel::metric::measure(&mut [3; 8]);
        assert!(json(&[table])["tables"][0]["rows"][0]["order0_rate"].is_null());
    }
}
