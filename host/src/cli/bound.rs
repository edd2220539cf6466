//! Error bounds: on the command line, and in what is told of a file.

use std::str::FromStr;

use serde_json::{Map, Value, json};
use wavelift_host::bound::{BoundError, Tolerance};
use wavelift_host::codec::{Channel, Form, Summary, Values};
use wavelift_host::volume::ElementType;
use wavelift_kernel::Wavelet;

/// How far samples may move; nowhere unless given.
#[derive(Debug, clap::Args)]
pub(crate) struct BoundArgs {
    /// Let no sample move by more than E, in the unit of the samples [default: every bit is kept]
    #[arg(long, value_name = "E", allow_negative_numbers = true, value_parser = absolute)]
    #[arg(conflicts_with = "relative_error")]
    pub(crate) max_error: Option<Tolerance>,
    /// Let no sample move by more than R times the range of the finite values of the volume: 0.01 for a hundredth
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = relative)]
    pub(crate) relative_error: Option<Tolerance>,
}

impl BoundArgs {
    /// The one that is given.
    pub(crate) fn tolerance(&self) -> Option<Tolerance> {
        self.max_error.or(self.relative_error)
    }
}

fn absolute(text: &str) -> Result<Tolerance, BoundError> {
    Tolerance::absolute(number(text)?)
}

fn relative(text: &str) -> Result<Tolerance, BoundError> {
    Tolerance::relative(number(text)?)
}

fn number(text: &str) -> Result<f64, BoundError> {
    f64::from_str(text).map_err(|_| BoundError::NotANumber)
}

/// What scripts are told of one component of a time step, by name.
pub(crate) fn channel_fields(
    channel: &Channel,
    summary: &Summary,
    element: ElementType,
) -> Map<String, Value> {
    let range = summary.range(element);
    let fields = json!({
        "effort": channel.effort.name(),
        "wavelet": channel.wavelet.map_or("none", Wavelet::name),
        "levels": channel.levels,
        "readable_levels": channel.readable_levels,
        "min": range.map(|[min, _]| min),
        "max": range.map(|[_, max]| max),
    });
    let mut all = fields_of(channel, summary);
    if let Value::Object(fields) = fields {
        all.extend(fields);
    }
    all
}

/// What scripts are told of form and bound, by name.
fn fields_of(channel: &Channel, summary: &Summary) -> Map<String, Value> {
    let fields = json!({
        "form": channel.form.name(),
        "packed_values": channel.form.values().map(Values::count),
        "step": channel.form.step(),
        "slack": channel.form.slack(),
        "density": channel.form.scale().map(|scale| scale.density()),
        "max_error": channel.bound.map(|bound| bound.error),
        "relative_error": channel.bound.and_then(|bound| bound.relative),
        "exceptions": summary.exceptions,
        "exact_bricks": summary.exact_bricks,
    });
    if let Value::Object(fields) = fields { fields } else { Map::new() }
}

/// What people are told of form and bound, a line each.
pub(crate) fn lines(channel: &Channel, summary: &Summary) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(bound) = channel.bound {
        let asked = bound.relative.map_or_else(String::new, |fraction| format!(", {fraction} of the range"));
        lines.push(format!("bound     no sample is off by more than {:e}{asked}", bound.error));
    }
    match &channel.form {
        Form::Exact => {}
        Form::Packed(values) => lines.push(format!("packed    {} values", values.count())),
        Form::Steps(step) => lines.push(format!("scale     integers in steps of {step}")),
        Form::Near(slack) => lines.push(format!("scale     integers as they are, lattice within {slack}")),
        Form::Scaled { scale, .. } => lines.push(format!(
            "scale     integers, {} to 1{}; {} samples kept beside it, {} of {} bricks exact",
            scale.density(),
            channel.form.slack().map_or_else(String::new, |slack| format!(", lattice within {slack} steps")),
            summary.exceptions,
            summary.exact_bricks,
            summary.bricks.len()
        )),
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_numbers_above_zero() {
        assert_eq!(absolute("1e-3"), Tolerance::absolute(1e-3));
        assert_eq!(relative("0.5"), Tolerance::relative(0.5));
        for text in ["", "one", "NaN", "0", "-1", "inf", "1,5", "1e999"] {
            absolute(text).unwrap_err();
            relative(text).unwrap_err();
        }
    }
}
