//! `wavelift info`.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use wavelift_host::codec::{Channel, Container, ContainerError, Head, Step, Summary};
use wavelift_host::volume::{HeaderLine, Metadata, sample_bytes};

use super::bound;
use super::compress::steps_document;
use super::exit::Failure;
use super::input::input_path;
use super::output::{print, print_json};

/// Tell what a compressed file holds, without decoding it
///
/// Extent, type, wavelet, levels, bricks, sizes, and the header of the volume's source.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  wavelift info head.wlift
  wavelift info head.wlift --json")]
pub(crate) struct Args {
    /// Compressed file
    #[arg(value_parser = input_path())]
    pub(crate) input: PathBuf,
    /// Write one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Tells what a compressed file holds.
///
/// # Errors
/// A [`Failure`] if it is not a whole container.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let contents = Container::open(&args.input).and_then(|container| Contents::of(&container));
    let contents = contents.map_err(|error| Failure::of_container(&args.input, &error))?;
    if args.json { print_json(&contents.document(&args.input)) } else { print(&contents.text()) }
}

/// All that a file says but its samples.
struct Contents {
    bytes: u64,
    head: Head,
    metadata: Metadata,
    steps: Vec<Step>,
    summaries: Vec<Vec<Summary>>,
}

impl Contents {
    fn of(container: &Container) -> Result<Self, ContainerError> {
        Ok(Self {
            bytes: container.bytes(),
            head: container.head().clone(),
            metadata: container.metadata()?.clone(),
            steps: (0..container.steps())
                .map(|step| container.step(step).cloned())
                .collect::<Result<_, _>>()?,
            summaries: container.summaries()?.to_vec(),
        })
    }

    /// Bits that a value takes.
    fn bits(&self) -> f64 {
        let Head { extent, components, .. } = self.head;
        let samples: f64 = extent.into_iter().map(|axis| axis as f64).product();
        8.0 * self.bytes as f64 / (samples * f64::from(components) * self.steps.len() as f64)
    }

    /// Bytes of the values.
    fn sample_bytes(&self) -> Option<u64> {
        let step =
            sample_bytes(self.head.extent, self.head.element)?.checked_mul(self.head.components.into())?;
        step.checked_mul(self.steps.len() as u64)
    }

    /// All of it, for scripts.
    fn document(&self, input: &Path) -> Value {
        let Self { head, metadata, steps, summaries, .. } = self;
        let mut document = json!({
            "input": input.display().to_string(),
            "program": head.program,
            "extent": head.extent,
            "components": head.components,
            "component_names": head.names,
            "type": head.element.name(),
            "sample_bytes": self.sample_bytes(),
            "bytes": self.bytes,
            "bits_per_sample": self.bits(),
            "bricks": summaries.iter().flatten().map(|summary| summary.bricks.len()).sum::<usize>(),
            "readable_levels": steps.iter().map(Step::readable_levels).min(),
            "source": {
                "format": metadata.source.format.name(),
                "byte_order": metadata.source.byte_order.name(),
                "fortran_order": metadata.source.fortran_order,
                "rank": metadata.rank(),
            },
            "name": metadata.name(),
            "spacing": metadata.spacing(),
            "origin": metadata.origin(),
            "header": metadata.lines.iter().map(entry).collect::<Vec<_>>(),
        });
        if let Value::Object(fields) = &mut document {
            fields.extend(steps_document(steps, summaries, head.element));
        }
        document
    }

    fn text(&self) -> String {
        let Self { head, metadata, steps, .. } = self;
        let [x, y, z] = head.extent;
        let source = metadata.source;
        let fortran = if source.fortran_order { ", Fortran order" } else { "" };
        let mut lines =
            vec![format!("extent    {x} x {y} x {z}, x fastest"), format!("type      {}", head.element)];
        if head.components > 1 {
            let names =
                if head.names.is_empty() { String::new() } else { format!(": {}", head.names.join(", ")) };
            lines.push(format!("values    {} of each sample{names}", head.components));
        }
        if steps.len() != 1 {
            lines.push(format!("steps     {} in time", steps.len()));
        }
        lines.extend(self.channel_lines());
        lines.push(format!("size      {} bytes, {:.3} bits a sample", self.bytes, self.bits()));
        lines.push(format!(
            "source    {}, {} endian{fortran}",
            source.format.name(),
            source.byte_order.name()
        ));
        lines.push(format!("program   wavelift {}", head.program));
        lines.extend(metadata.lines.iter().map(|line| match line {
            HeaderLine::Comment(text) => format!("          #{text}"),
            HeaderLine::Field { name, value } => format!("          {name}: {value}"),
            HeaderLine::KeyValue { key, value } => format!("          {key} := {value}"),
        }));
        lines.join("\n") + "\n"
    }

    /// How each component of each time step is coded; those that are coded like the one before are not told again.
    fn channel_lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let mut before = Vec::new();
        for (step, summaries) in self.steps.iter().zip(&self.summaries) {
            for (component, (channel, summary)) in step.channels.iter().zip(summaries).enumerate() {
                let told = self.lines_of(step, channel, summary);
                if told != before {
                    if self.head.components > 1 || self.steps.len() > 1 {
                        let name = step.name.as_ref().map_or_else(String::new, |name| format!(" ({name})"));
                        lines.push(format!(
                            "at        time step {}{name}, component {component}:",
                            step.number
                        ));
                    }
                    lines.extend(told.clone());
                    before = told;
                }
            }
        }
        lines
    }

    fn lines_of(&self, step: &Step, channel: &Channel, summary: &Summary) -> Vec<String> {
        let [a, b, c] = step.sides;
        let mut lines = vec![
            format!("effort    {}", channel.effort),
            match channel.wavelet {
                Some(wavelet) => format!("wavelet   {}, {} levels", wavelet.name(), channel.levels),
                None => "wavelet   none (no transform)".to_owned(),
            },
            match channel.readable_levels {
                0 => "levels    0, full resolution only".to_owned(),
                coarsest if channel.has_quick_levels() => {
                    format!("levels    0 to {coarsest} can be read, each from a part of the bricks' bytes")
                }
                coarsest => {
                    format!(
                        "levels    0 to {coarsest} can be read, but whole bricks are decoded for each: {QUICK}"
                    )
                }
            },
            format!("bricks    {} of {a} x {b} x {c}", summary.bricks.len()),
        ];
        lines.extend(bound::lines(channel, summary));
        if let Some([min, max]) = summary.range(self.head.element) {
            lines.push(format!("values    {min} to {max}"));
        }
        lines
    }
}

/// How to get levels that save time.
pub(crate) const QUICK: &str = "`compress --wavelet linear` makes quick ones";

fn entry(line: &HeaderLine) -> Value {
    match line {
        HeaderLine::Comment(text) => json!({ "comment": text }),
        HeaderLine::Field { name, value } => json!({ "field": name, "value": value }),
        HeaderLine::KeyValue { key, value } => json!({ "key": key, "value": value }),
    }
}
