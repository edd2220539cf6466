//! From the fields of a NIfTI header to the words of metadata, and back.

use super::NiftiError;
use super::fields::{Fields, PREFIX, Version};
use super::header::{NiftiHeader, datatype_of, layout_of, name_of_type};
use super::orientation::{Placement, is_same, placement, set_placement};
use crate::volume::{
    Axis, ByteOrder, ElementType, FileFormat, Header, HeaderLine, Metadata, Origin, name_of,
};

/// Key of the field `dim`, which a header does not keep otherwise: axes of one sample, and how components lie.
const DIM: &str = "nifti.dim";

/// Key of the field `datatype`.
const DATATYPE: &str = "nifti.datatype";

/// Key of the version, 1 or 2.
const VERSION: &str = "nifti.version";

/// Keys of extensions begin so, and end in a number.
const EXTENSION: &str = "nifti.extension.";

/// Units of space and time: the code in `xyzt_units`, and the word.
const SPACE_UNITS: [(u8, &str); 3] = [(1, "m"), (2, "mm"), (3, "um")];
const TIME_UNITS: [(u8, &str); 6] =
    [(8, "s"), (16, "ms"), (24, "us"), (32, "Hz"), (40, "ppm"), (48, "rad/s")];

/// Axes of a file, fastest first: `lead` values that lie together, then those of `dim`, the fifth and all behind it
/// components as well.
fn file_axes(dim: &[u64], lead: u32) -> Option<Vec<Axis>> {
    let mut axes: Vec<Axis> = (lead > 1).then_some(Axis::Component(lead)).into_iter().collect();
    for (index, &count) in dim.iter().enumerate() {
        axes.push(match index {
            0..3 => Axis::SPACE[index],
            3 => Axis::Time(count),
            _ => Axis::Component(u32::try_from(count).ok()?),
        });
    }
    Some(axes)
}

/// The data set that a header speaks of, and the axes of its file.
pub(super) fn read(file: &NiftiHeader) -> Result<(Header, Vec<Axis>), NiftiError> {
    let code = file.datatype;
    let (element, lead) = layout_of(code).ok_or(NiftiError::Type { code, name: name_of_type(code) })?;
    let too_large = || NiftiError::Extent(crate::volume::ExtentError::TooLarge);
    let axes = file_axes(&file.dim, lead).ok_or_else(too_large)?;
    let mut metadata = Metadata::plain(file.dim.len().min(3) as u8, FileFormat::Nifti);
    metadata.source = Origin { format: FileFormat::Nifti, byte_order: file.order, fortran_order: false };
    let rank = metadata.rank();
    let components = crate::volume::axis::components(&axes).ok_or_else(too_large)?;
    let steps = file.dim.get(3).copied().unwrap_or(1);
    if components > 1 {
        metadata.axes.insert(0, Axis::Component(components));
    }
    if steps > 1 {
        metadata.axes.push(Axis::Time(steps));
    }
    let counts: Vec<u64> = metadata
        .axes
        .iter()
        .map(|axis| match axis {
            Axis::Component(count) => u64::from(*count),
            Axis::Time(count) => *count,
            axis => file.dim[axis.space().unwrap_or(0)],
        })
        .collect();
    describe(file, &mut metadata, rank);
    let header = Header::of_axes(&counts, element, metadata).map_err(NiftiError::Extent)?;
    Ok((header, axes))
}

/// Says in the words of metadata all that a header says beside extent and type.
fn describe(file: &NiftiHeader, metadata: &mut Metadata, rank: usize) {
    let fields = &file.fields;
    let units = fields.numbers::<1>("xyzt_units")[0] as u8;
    let unit = |table: &'static [(u8, &'static str)], mask| {
        table.iter().find(move |(code, _)| *code == units & mask)
    };
    let (space, time) = (unit(&SPACE_UNITS, 7), unit(&TIME_UNITS, 56));
    let quoted = |text: &str| format!("\"{text}\"");
    let placement = placement(fields);
    if let Some(Placement::Spaced(spacing)) = &placement {
        for axis in &Axis::SPACE[..rank] {
            let step = spacing[axis.space().unwrap_or(0)].to_string();
            metadata.set_axis_entry("spacings", *axis, &step);
            if let Some((_, unit)) = space {
                metadata.set_axis_entry("units", *axis, &quoted(unit));
            }
        }
    }
    if metadata.axes.iter().any(|axis| matches!(axis, Axis::Time(_))) {
        let [.., step, _, _, _] = fields.numbers::<8>("pixdim");
        metadata.set_axis_entry("spacings", Axis::Time(0), &step.to_string());
        if let Some((_, unit)) = time {
            metadata.set_axis_entry("units", Axis::Time(0), &quoted(unit));
        }
    }
    if let Some(Placement::Oriented(geometry)) = &placement {
        metadata.set_geometry(geometry);
        if let Some((_, unit)) = space {
            metadata.set_field("space units", &vec![quoted(unit); 3].join(" "));
        }
    }
    let kind = match file.datatype {
        128 => Some("RGB-color"),
        2304 => Some("RGBA-color"),
        32 | 1792 => Some("complex"),
        _ => None,
    };
    if let Some(kind) =
        kind.filter(|_| file.dim.get(4..).is_none_or(|more| more.iter().all(|count| *count == 1)))
    {
        metadata.set_axis_entry("kinds", Axis::Component(0), kind);
    }
    keep(file, metadata);
}

/// Keeps what is in the header as pairs, so that it can be written again as it was.
fn keep(file: &NiftiHeader, metadata: &mut Metadata) {
    let dim: Vec<String> = file.dim.iter().map(u64::to_string).collect();
    let version = if file.version == Version::One { "1" } else { "2" };
    for (key, value) in [(VERSION, version), (DIM, &dim.join(" ")), (DATATYPE, &file.datatype.to_string())] {
        metadata.set_key_value(key, value);
    }
    for (name, value) in file.fields.iter() {
        metadata.set_key_value(&format!("{PREFIX}{name}"), value);
    }
    for (number, extension) in file.extensions.iter().enumerate() {
        metadata.set_key_value(&format!("{EXTENSION}{number}"), extension);
    }
}

/// A header for a data set, the axes of its file, and what it has no place for.
pub(super) fn written(
    header: &Header,
    order: ByteOrder,
    is_pair: bool,
) -> Result<(NiftiHeader, Vec<Axis>, Vec<String>), String> {
    let metadata = &header.metadata;
    let (datatype, lead) = datatype_for(header);
    let dim = dim_for(header, lead)?;
    let version = match metadata.key_value(VERSION) {
        Some("2") => Version::Two,
        _ if dim.iter().any(|&count| count > i16::MAX as u64) => Version::Two,
        _ => Version::One,
    };
    let axes = file_axes(&dim, lead).ok_or("so many components")?;
    let mut fields = Fields::of_metadata(metadata);
    place(metadata, &mut fields, dim.len().min(3));
    set_units(metadata, &mut fields);
    adopt(metadata, &mut fields);
    let extensions = (0..).map_while(|number| metadata.key_value(&format!("{EXTENSION}{number}")));
    let extensions = extensions.map(str::to_owned).collect();
    let file = NiftiHeader { version, order, is_pair, dim, datatype, offset: 0, fields, extensions };
    Ok((file, axes, losses(metadata)))
}

/// Type, and values that lie together: as they were, else colours of bytes together, else single values.
fn datatype_for(header: &Header) -> (i16, u32) {
    let kept = header.metadata.key_value(DATATYPE).and_then(|text| text.parse().ok());
    if let Some((code, (element, lead))) = kept.and_then(|code| Some((code, layout_of(code)?)))
        && element == header.element
        && header.components.is_multiple_of(lead)
    {
        return (code, lead);
    }
    let kind = header.metadata.axis_entry("kinds", Axis::Component(0));
    match (header.element, header.components) {
        (ElementType::U8, 3) => (128, 3),
        (ElementType::U8, 4) => (2304, 4),
        (ElementType::F32, 2) if kind == Some("complex") => (32, 2),
        (ElementType::F64, 2) if kind == Some("complex") => (1792, 2),
        (element, _) => (datatype_of(element), 1),
    }
}

/// Samples along each axis: as many axes as there were, if those of time and components still hold the data set.
fn dim_for(header: &Header, lead: u32) -> Result<Vec<u64>, String> {
    let components = u64::from(header.components / lead);
    let kept: Option<Vec<u64>> = header
        .metadata
        .key_value(DIM)
        .and_then(|text| text.split(' ').map(|word| word.parse().ok()).collect());
    let others = |dim: &[u64]| {
        dim.get(4..).unwrap_or_default().iter().try_fold(1_u64, |product, &count| product.checked_mul(count))
    };
    let needed = header.extent.iter().rposition(|&count| count > 1).map_or(1, |axis| axis + 1);
    let mut dim = match kept {
        Some(dim)
            if (needed..=7).contains(&dim.len())
                && dim.get(3).copied().unwrap_or(1) == header.steps
                && others(&dim) == Some(components) =>
        {
            dim
        }
        _ if components > 1 => vec![1, 1, 1, header.steps, components],
        _ if header.steps > 1 => vec![1, 1, 1, header.steps],
        _ => vec![1; header.rank()],
    };
    for (count, &extent) in dim.iter_mut().zip(&header.extent) {
        *count = extent;
    }
    match dim.iter().find(|&&count| count > i64::MAX as u64) {
        Some(count) => Err(format!("an axis of {count} samples")),
        None => Ok(dim),
    }
}

/// Leaves positions as they were if they still are those of the metadata, and says them anew if not.
fn place(metadata: &Metadata, fields: &mut Fields, rank: usize) {
    let is_oriented = metadata.field("space directions").is_some();
    let now = metadata.geometry().map(|geometry| match is_oriented {
        true => Placement::Oriented(geometry),
        false => Placement::Spaced(geometry.spacing()),
    });
    if !is_same(&placement(fields), &now, rank) {
        set_placement(fields, now.as_ref());
    }
    if fields.text("pixdim").is_none() {
        fields.set_numbers("pixdim", &[1.0; 8]);
    }
    if let Some(step) = metadata.time_step() {
        let mut pixdim: [f64; 8] = fields.numbers("pixdim");
        pixdim[4] = step;
        fields.set_numbers("pixdim", &pixdim);
    }
}

fn set_units(metadata: &Metadata, fields: &mut Fields) {
    let unit = |entry: Option<&str>, table: &[(u8, &str)]| {
        let word = entry?.trim_matches('"').replace(['µ', 'μ'], "u");
        table.iter().find(|(_, known)| *known == word).map(|(code, _)| *code)
    };
    let first = metadata.field("space units").and_then(|units| units.split_whitespace().next());
    let space = unit(first.or_else(|| metadata.axis_entry("units", Axis::X)), &SPACE_UNITS);
    let time = unit(metadata.axis_entry("units", Axis::Time(0)), &TIME_UNITS);
    let old = fields.numbers::<1>("xyzt_units")[0] as u8;
    let units = (old & !63) | space.unwrap_or(old & 7) | time.unwrap_or(old & 56);
    if units != old {
        fields.set("xyzt_units", units.to_string());
    }
}

/// Fields of the scale of values, and DICOM's keys for it.
const SCALE: [(&str, &str); 2] = [("scl_slope", "dicom.0028,1053"), ("scl_inter", "dicom.0028,1052")];

/// Takes over what other formats say in words of their own: a name, and the scale of DICOM's values.
fn adopt(metadata: &Metadata, fields: &mut Fields) {
    let scale = SCALE.map(|(name, key)| (name, metadata.key_value(key)));
    for (name, found) in scale.into_iter().chain([("descrip", metadata.name())]) {
        if let (None, Some(text)) = (fields.text(name), found) {
            fields.set(name, text.trim().to_owned());
        }
    }
}

/// What is neither in a field nor in an extension.
fn losses(metadata: &Metadata) -> Vec<String> {
    let mut rest = metadata.clone();
    let is_oriented = metadata.geometry().is_some();
    let is_colour =
        |value: &str| value.split(' ').any(|kind| matches!(kind, "RGB-color" | "RGBA-color" | "complex"));
    rest.lines.retain(|line| match line {
        HeaderLine::Field { name, value } => {
            let is = |known| crate::volume::metadata::is_same_name(known, name);
            let is_held = is("space units") && is_known(value)
                || is("units")
                || is("spacings")
                || is("content") && value.len() < 80;
            !(is_held
                || is_oriented && line.is_geometry()
                || is("kinds") && (is_colour(value) || is_plain(value)))
        }
        HeaderLine::KeyValue { key, value } => {
            let name = key.strip_prefix(PREFIX);
            let is_own = name.is_some_and(Fields::is_name) || key.starts_with(EXTENSION);
            let is_scale = SCALE.iter().any(|(_, known)| known == key) && value.trim().parse::<f64>().is_ok();
            !is_own && !is_scale && ![VERSION, DIM, DATATYPE].contains(&key.as_str())
        }
        HeaderLine::Comment(_) => true,
    });
    crate::volume::losses(&rest)
}

/// Whether units of space are those that there are codes for.
fn is_known(units: &str) -> bool {
    let mut units = units.split('"').skip(1).step_by(2).map(|unit| unit.replace(['µ', 'μ'], "u"));
    units.all(|unit| SPACE_UNITS.iter().any(|(_, known)| *known == unit))
}

/// Whether kinds say no more than which axes there are.
fn is_plain(kinds: &str) -> bool {
    kinds.split(' ').all(|kind| matches!(kind, "domain" | "space" | "time" | "vector" | "none" | "list"))
}

/// Names a field as it stands in metadata.
pub(super) fn loss_of(name: &str) -> String {
    name_of(&HeaderLine::KeyValue { key: format!("{PREFIX}{name}"), value: String::new() })
}
