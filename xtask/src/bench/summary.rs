//! Geometric means over volumes: of sizes, of speeds, and of sizes beside each other.

use super::record::{Coding, Record, is_ours};

/// Means of one codec at one task, over the volumes that it coded.
pub(super) struct Mean {
    pub(super) codec: String,
    pub(super) volumes: usize,
    pub(super) bits_per_sample: f64,
    /// Megabytes (10^6 bytes) of samples a second.
    pub(super) encode: f64,
    pub(super) decode: f64,
}

/// What was measured at one task.
pub(super) struct Summary<'a> {
    record: &'a Record,
    pub(super) task: &'a str,
    rows: Vec<&'a Coding>,
    /// Codecs in the order they were measured in, wavelift's first.
    pub(super) codecs: Vec<&'a str>,
}

impl<'a> Summary<'a> {
    pub(super) fn new(record: &'a Record, task: &'a str) -> Self {
        let rows: Vec<&Coding> = record.coding.iter().filter(|row| row.task == task).collect();
        let codecs = distinct(rows.iter().map(|row| row.codec.as_str()));
        Self { record, task, rows, codecs }
    }

    /// A summary of every task that was measured.
    pub(super) fn of_tasks(record: &'a Record) -> Vec<Self> {
        let tasks = distinct(record.coding.iter().map(|row| row.task.as_str()));
        tasks.into_iter().map(|task| Self::new(record, task)).collect()
    }

    /// wavelift at its efforts.
    pub(super) fn ours(&self) -> Vec<&'a str> {
        self.codecs.iter().copied().filter(|codec| is_ours(codec)).collect()
    }

    /// Volumes of the task, in the order of the list.
    pub(super) fn volumes(&self) -> Vec<&'a str> {
        distinct(self.rows.iter().map(|row| row.volume.as_str()))
    }

    pub(super) fn row(&self, volume: &str, codec: &str) -> Option<&'a Coding> {
        self.rows.iter().copied().find(|row| row.volume == volume && row.codec == codec)
    }

    pub(super) fn bits_per_sample(&self, row: &Coding) -> f64 {
        8.0 * row.bytes as f64 / self.of_volume(row, |volume| volume.samples())
    }

    /// Megabytes of samples a second that `seconds` come to.
    pub(super) fn speed(&self, row: &Coding, seconds: f64) -> f64 {
        self.of_volume(row, |volume| volume.bytes()) / seconds.max(1e-9) / 1e6
    }

    fn of_volume(&self, row: &Coding, count: impl Fn(&super::volumes::Listed) -> u64) -> f64 {
        self.record
            .volumes
            .iter()
            .find(|volume| volume.name == row.volume)
            .map_or(1.0, |volume| count(volume) as f64)
    }

    pub(super) fn mean(&self, codec: &str) -> Mean {
        let rows: Vec<&Coding> = self.rows.iter().copied().filter(|row| row.codec == codec).collect();
        let mean = |figure: &dyn Fn(&Coding) -> f64| geometric_mean(rows.iter().map(|row| figure(row)));
        Mean {
            codec: codec.to_owned(),
            volumes: rows.len(),
            bits_per_sample: mean(&|row| self.bits_per_sample(row)),
            encode: mean(&|row| self.speed(row, row.encode_seconds)),
            decode: mean(&|row| self.speed(row, row.decode_seconds)),
        }
    }

    /// Bytes of `codec` for each byte of `other`, over the volumes that both coded.
    pub(super) fn ratio(&self, codec: &str, other: &str) -> f64 {
        let pairs = self.volumes().into_iter().filter_map(|volume| {
            let (row, other) = (self.row(volume, codec)?, self.row(volume, other)?);
            Some(row.bytes as f64 / other.bytes as f64)
        });
        geometric_mean(pairs)
    }
}

/// The geometric mean; not a number of nothing.
fn geometric_mean(figures: impl Iterator<Item = f64>) -> f64 {
    let logs: Vec<f64> = figures.map(f64::ln).collect();
    (logs.iter().sum::<f64>() / logs.len() as f64).exp()
}

/// Each once, in the order of first appearance.
pub(super) fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = vec![];
    for name in names {
        if !found.contains(&name) {
            found.push(name);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::example;
    use super::*;

    #[test]
    fn means_are_geometric_and_ratios_over_common_volumes() {
        let record = example();
        let summary = Summary::new(&record, "lossless");
        assert_eq!(summary.codecs, ["wavelift default", "JPEG-LS", "pcodec"]);
        assert_eq!(summary.ours(), ["wavelift default"]);
        let ours = summary.mean("wavelift default");
        assert_eq!(ours.volumes, 2);
        // 100 of 200 bytes (u8) and 200 of 200 bytes (u16): 4 and 16 bits a sample.
        assert!((ours.bits_per_sample - 8.0).abs() < 1e-9, "{}", ours.bits_per_sample);
        assert!((summary.ratio("JPEG-LS", "wavelift default") - 2.0).abs() < 1e-9);
        assert!((summary.ratio("pcodec", "wavelift default") - 1.5).abs() < 1e-9);
        assert!((ours.encode - 200e-6).abs() < 1e-12, "{}", ours.encode);
    }
}
