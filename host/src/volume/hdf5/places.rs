//! How far samples lie apart, by the variables of coordinates that NetCDF has for its axes.
//!
//! Source: *NetCDF Climate and Forecast Metadata Conventions*: a variable of one axis with the name of that.

use netcdf_reader::{NcDimension, NcFile};

use super::variable::{Variable, text_of};
use crate::volume::{Axis, Header};

/// Coordinates that are looked through at most.
const MOST_COORDINATES: u64 = 1 << 20;

/// How far a coordinate may be from its place, as a part of the step: floats of 32 bits round.
const TOLERANCE: f64 = 1e-3;

/// An axis whose coordinates are equally far apart.
struct Line {
    first: f64,
    step: f64,
    unit: Option<String>,
}

/// Says the steps along those axes that have equal ones, their units, and, where all of space have and go up, the
/// coordinates of the first sample.
pub(super) fn describe(file: &NcFile, variable: &Variable<'_>, header: &mut Header) {
    let metadata = &mut header.metadata;
    let axes: Vec<Axis> = metadata.axes.clone();
    let dimensions = variable.content.dimensions().iter().rev();
    let lines: Vec<(Axis, Option<Line>)> =
        axes.into_iter().zip(dimensions.map(|dimension| line(file, &variable.path, dimension))).collect();
    let of_space = || lines.iter().filter(|(axis, _)| axis.is_space());
    let is_placed = of_space().all(|(_, line)| line.as_ref().is_some_and(|line| line.step > 0.0));
    for (axis, line) in lines.iter().filter(|(axis, _)| !matches!(axis, Axis::Component(_))) {
        let Some(Line { first, step, unit }) = line else { continue };
        metadata.set_axis_entry("spacings", *axis, &step.abs().to_string());
        if is_placed && axis.is_space() {
            metadata.set_axis_entry("axis mins", *axis, &first.to_string());
        }
        if let Some(unit) = unit.as_ref().filter(|unit| !unit.contains('"')) {
            metadata.set_axis_entry("units", *axis, &format!("\"{unit}\""));
        }
    }
}

/// The coordinates along an axis, from the group of the variable, or one that this is in.
fn line(file: &NcFile, path: &str, dimension: &NcDimension) -> Option<Line> {
    if !(2..=MOST_COORDINATES).contains(&dimension.size) {
        return None;
    }
    let groups =
        std::iter::successors(path.rsplit_once('/').map_or(Some(""), |(group, _)| Some(group)), |group| {
            (!group.is_empty()).then(|| group.rsplit_once('/').map_or("", |(outer, _)| outer))
        });
    let names = groups.map(|group| format!("{group}/{}", dimension.name));
    let found = names.map(|name| name.trim_start_matches('/').to_owned());
    let name = found
        .into_iter()
        .find(|name| file.variable(name).is_ok_and(|found| found.shape() == [dimension.size]))?;
    let coordinates: Vec<f64> = file.read_variable_as_f64(&name).ok()?.into_iter().collect();
    let (first, last) = (*coordinates.first()?, *coordinates.last()?);
    let step = (last - first) / (coordinates.len() - 1) as f64;
    let is_regular = |(place, coordinate): (usize, &f64)| {
        (first + step * place as f64 - coordinate).abs() <= TOLERANCE * step.abs()
    };
    let is_line = step.is_finite() && step != 0.0 && coordinates.iter().enumerate().all(is_regular);
    let unit = file.variable(&name).ok()?.attribute("units").and_then(|unit| text_of(&unit.value));
    is_line.then_some(Line { first, step, unit })
}
