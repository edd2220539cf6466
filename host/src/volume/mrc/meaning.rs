//! From headers of MRC to the words of metadata, and back.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::MrcError;
use super::header::{BYTES, Mode, MrcHeader, field};
use crate::volume::{
    Axis, ByteOrder, ElementType, FileFormat, Geometry, Header, HeaderLine, Metadata, Origin, Space,
};

/// Key of the whole header, its extension included but for zeros at the end, in base64.
const HEADER: &str = "mrc.header";

/// Keys of the labels, texts of up to 80 letters, begin so, and end in a number.
const LABEL: &str = "mrc.label.";

/// Where the number of labels stands, where they begin, how long one is.
const LABELS: [usize; 3] = [220, 224, 80];

/// The unit of lengths.
const UNIT: &str = "\"angstrom\" \"angstrom\" \"angstrom\"";

/// The data set that a header speaks of, and whether its values are floats of 16 bits.
pub(super) fn read(file: &MrcHeader) -> Result<(Header, bool), MrcError> {
    let Mode { element, components, is_half } = file.mode()?;
    let counts: [i32; 3] = file.integers(field::COUNTS);
    let fault = || MrcError::Counts { found: counts.map(|count| count.to_string()).join(" x ") };
    let [x, y, z] = counts.map(u64::try_from);
    let (x, y, z) = (x.map_err(|_| fault())?, y.map_err(|_| fault())?, z.map_err(|_| fault())?);
    if [x, y, z].contains(&0) {
        return Err(fault());
    }
    let steps = steps(file, z);
    let mut metadata = Metadata::plain(3, FileFormat::Mrc);
    metadata.source = Origin { format: FileFormat::Mrc, byte_order: file.order, fortran_order: false };
    let mut sizes = vec![x, y, z / steps];
    if components > 1 {
        metadata.axes.insert(0, Axis::Component(components));
        sizes.insert(0, components.into());
    }
    if steps > 1 {
        metadata.axes.push(Axis::Time(steps));
        sizes.push(steps);
    }
    if components > 1 {
        metadata.set_axis_entry("kinds", Axis::Component(0), "complex");
    }
    if let Some(geometry) = geometry(file) {
        metadata.set_geometry(&geometry);
        metadata.set_field("space units", UNIT);
    }
    let [number, first, length] = LABELS;
    let labels = usize::try_from(file.integers::<1>(number)[0]).unwrap_or(0).min(10);
    for label in 0..labels {
        let text = String::from_utf8_lossy(&file.bytes[first + label * length..][..length]);
        metadata.set_key_value(&format!("{LABEL}{label}"), text.trim_end_matches(['\0', ' ']));
    }
    let end = file.bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    metadata.set_key_value(HEADER, &STANDARD.encode(&file.bytes[..end]));
    let header = Header::of_axes(&sizes, element, metadata).map_err(MrcError::Extent)?;
    Ok((header, is_half))
}

/// Volumes that follow each other in a stack of them, which space groups from 401 on are.
fn steps(file: &MrcHeader, z: u64) -> u64 {
    let [group] = file.integers(field::SPACE_GROUP);
    let [_, _, depth] = file.integers::<3>(field::SAMPLING);
    let depth = u64::try_from(depth).unwrap_or(0);
    if (401..=630).contains(&group) && depth > 0 && z.is_multiple_of(depth) { z / depth } else { 1 }
}

/// Where the samples lie, if the cell has a size and right angles.
fn geometry(file: &MrcHeader) -> Option<Geometry> {
    let (cell, angles) = (file.reals::<3>(field::CELL), file.reals::<3>(field::ANGLES));
    let (sampling, axes) = (file.integers::<3>(field::SAMPLING), file.integers::<3>(field::AXES));
    let is_right = angles == [90.0; 3] || angles == [0.0; 3];
    let has_size =
        cell.iter().all(|side| side.is_finite() && *side > 0.0) && sampling.iter().all(|count| *count > 0);
    if !is_right || !has_size {
        return None;
    }
    let mut sorted = axes;
    sorted.sort_unstable();
    // Where axes are not said, or not well, they are x, y, z.
    let axes = if sorted == [1, 2, 3] { axes.map(|axis| axis as usize - 1) } else { [0, 1, 2] };
    let mut directions = [[0.0; 3]; 3];
    for (direction, axis) in directions.iter_mut().zip(axes) {
        direction[axis] = f64::from(cell[axis]) / f64::from(sampling[axis]);
    }
    let origin = file.reals::<3>(field::ORIGIN).map(f64::from);
    let origin = if origin.iter().all(|place| place.is_finite()) { origin } else { [0.0; 3] };
    Some(Geometry { space: Space::Unnamed, directions, origin })
}

/// The header of a file of a data set, and what that has no place for.
pub(super) fn written(header: &Header, order: ByteOrder) -> Result<(MrcHeader, Vec<String>), String> {
    let metadata = &header.metadata;
    let kept =
        metadata.key_value(HEADER).and_then(|text| STANDARD.decode(text).ok()).and_then(MrcHeader::kept);
    let kept = kept.filter(|file| file.order == order);
    let is_own = kept.as_ref().is_some_and(|file| holds(file, header));
    let mut file = kept.unwrap_or_else(|| MrcHeader::empty(order));
    if !is_own {
        describe(&mut file, header)?;
    }
    let is_placed =
        places(metadata).is_some_and(|wanted| geometry(&file).is_some_and(|found| is_near(found, wanted)));
    let mut rest = metadata.clone();
    rest.lines.retain(|line| match line {
        HeaderLine::Field { name, value } => {
            let is = |known| crate::volume::metadata::is_same_name(known, name);
            // There is no place for the distance of time steps.
            let is_step = is("spacings") && header.steps > 1;
            let is_length = is("space units") || is("units") && header.steps == 1;
            let is_place = line.is_geometry() && !is("space") && !is_step || is_length;
            let is_kind = is("kinds") && value.starts_with("complex") && header.components == 2;
            !(is_placed && is_place || is_kind)
        }
        HeaderLine::KeyValue { key, .. } => key != HEADER && !key.starts_with(LABEL),
        HeaderLine::Comment(_) => true,
    });
    Ok((file, crate::volume::losses(&rest)))
}

/// Whether a header that was kept is that of the data set still.
fn holds(file: &MrcHeader, header: &Header) -> bool {
    let Ok((own, is_half)) = read(file) else { return false };
    let is_like = |own: &Header| {
        (own.extent, own.components, own.steps, own.element)
            == (header.extent, header.components, header.steps, header.element)
    };
    is_like(&own) && !is_half && places(&own.metadata) == places(&header.metadata)
}

/// Says anew what there is of samples and places; texts and what nobody here knows stay.
fn describe(file: &mut MrcHeader, header: &Header) -> Result<(), String> {
    let mode = match (header.element, header.components) {
        (ElementType::I8, 1) => 0,
        (ElementType::I16, 1) => 1,
        (ElementType::F32, 1) => 2,
        (ElementType::I16, 2) => 3,
        (ElementType::F32, 2) => 4,
        (ElementType::U16, 1) => 6,
        (element, 1) => return Err(format!("{element}, only i8, i16, u16 and f32: write .nrrd or .mha")),
        (element, components) => {
            return Err(format!("{components} components of {element}: write .nrrd or .mha"));
        }
    };
    let [x, y, z] = header.extent;
    let total = z.saturating_mul(header.steps);
    let [x, y, z, total] = [x, y, z, total].map(i32::try_from);
    let too_long = |_| "an axis of more than 2^31 - 1 samples".to_owned();
    let (x, y, z, total) =
        (x.map_err(too_long)?, y.map_err(too_long)?, z.map_err(too_long)?, total.map_err(too_long)?);
    // The extended header tells of each of the slices that there were.
    file.bytes.truncate(BYTES);
    file.set_integers(field::EXTENSION, [0]);
    file.set_integers(field::COUNTS, [x, y, total]);
    file.set_integers(field::MODE, [mode]);
    file.set_integers(field::STARTS, [0; 3]);
    file.set_integers(field::SAMPLING, [x, y, z]);
    file.set_integers(field::AXES, [1, 2, 3]);
    file.set_integers(field::SPACE_GROUP, [if header.steps > 1 { 401 } else { 1 }]);
    file.set_integers(field::IMOD_STAMP, [0]);
    // What was not looked for: the smallest is above the largest, the mean below both, the deviation below zero.
    file.set_reals(field::RANGE, [0.0, -1.0, -2.0]);
    file.set_reals(field::DEVIATION, [-1.0]);
    file.set_reals(field::ANGLES, [90.0; 3]);
    let placed = places(&header.metadata);
    let spacing = placed.map_or([0.0; 3], |placed| placed.spacing());
    let counts = [x, y, z].map(f64::from);
    file.set_reals(field::CELL, [0, 1, 2].map(|axis| (spacing[axis] * counts[axis]) as f32));
    file.set_reals(field::ORIGIN, placed.map_or([0.0; 3], |placed| placed.origin.map(|place| place as f32)));
    Ok(())
}

/// Where the samples lie, in ångström of a space without a name; lengths without a unit are taken as they are. `None` for
/// a unit that is not known.
fn places(metadata: &Metadata) -> Option<Geometry> {
    let Geometry { directions, origin, .. } = metadata.geometry()?;
    let units = metadata.field("space units").or_else(|| metadata.axis_entry("units", Axis::X));
    let unit = match units.and_then(|units| units.split('"').nth(1)) {
        Some(name) => angstrom(name)?,
        None => 1.0,
    };
    let scaled = |vector: [f64; 3]| vector.map(|part| part * unit);
    Some(Geometry { space: Space::Unnamed, directions: directions.map(scaled), origin: scaled(origin) })
}

/// Ångström of a unit.
fn angstrom(name: &str) -> Option<f64> {
    Some(match name {
        "" | "angstrom" | "Å" => 1.0,
        "nm" => 10.0,
        "um" | "µm" | "micron" | "microns" => 1e4,
        "mm" => 1e7,
        "cm" => 1e8,
        "m" => 1e10,
        _ => return None,
    })
}

/// Whether places are the same but for what floats of 32 bits round.
fn is_near(found: Geometry, wanted: Geometry) -> bool {
    let numbers = |of: Geometry| of.directions.into_iter().flatten().chain(of.origin);
    let near = |(found, wanted): (f64, f64)| (found - wanted).abs() <= 1e-6 * wanted.abs();
    numbers(found).zip(numbers(wanted)).all(near)
}
