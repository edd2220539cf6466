//! The arrays of a file, and which of them is the data set.

use super::VtkError;
use crate::volume::error::excerpt;
use crate::volume::{ElementType, HeaderLine, Metadata};

/// Key of the pair that names arrays of the file that were not read.
pub(super) const LEFT_OUT: &str = "vtk.left_out";

/// Key of the pair that says as what an array is marked, unless as scalars.
const ATTRIBUTE: &str = "vtk.attribute";

/// Name of an array that has none.
const NO_NAME: &str = "samples";

/// As what an array of a point or cell is marked: words of XML files, and of legacy ones with their components.
///
/// The first of each kind is the active one, which VTK's filters work on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Attribute {
    Scalars,
    Vectors,
    Normals,
    Tensors,
    TextureCoordinates,
    /// An array without a mark: of a `FIELD` in legacy files.
    Field,
}

impl Attribute {
    pub(super) const ALL: [Self; 6] =
        [Self::Scalars, Self::Vectors, Self::Normals, Self::Tensors, Self::TextureCoordinates, Self::Field];

    /// Name in XML files.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Scalars => "Scalars",
            Self::Vectors => "Vectors",
            Self::Normals => "Normals",
            Self::Tensors => "Tensors",
            Self::TextureCoordinates => "TCoords",
            Self::Field => "Field",
        }
    }

    /// Whether samples of so many components can be marked so.
    const fn fits(self, components: u32) -> bool {
        match self {
            Self::Scalars => components >= 1 && components <= 4,
            Self::Vectors | Self::Normals => components == 3,
            Self::Tensors => components == 9,
            Self::TextureCoordinates => components >= 1 && components <= 3,
            Self::Field => true,
        }
    }
}

/// An array of values for points or cells.
#[derive(Clone, Debug)]
pub(super) struct Array<Data> {
    pub(super) name: String,
    /// `None` for texts, bits and the like, by the type's name.
    pub(super) element: Result<ElementType, String>,
    pub(super) components: u32,
    pub(super) of_cells: bool,
    pub(super) attribute: Attribute,
    /// Where the values are.
    pub(super) data: Data,
}

impl<Data> Array<Data> {
    /// Whether another piece of the same image has this array.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        (&self.name, self.of_cells, &self.element, self.components)
            == (&other.name, other.of_cells, &other.element, other.components)
    }
}

/// Takes the array of that name, or else the active scalars of points, the first array of points, or those of cells.
/// The lines are its name, its mark, and what was left out.
pub(super) fn choose<Data>(
    mut arrays: Vec<Array<Data>>,
    wanted: Option<&str>,
) -> Result<(Array<Data>, Vec<HeaderLine>), VtkError> {
    let rank =
        |array: &Array<Data>| (array.element.is_err(), array.of_cells, array.attribute != Attribute::Scalars);
    let found = match wanted {
        Some(name) => arrays.iter().position(|array| array.name == name),
        None => (0..arrays.len()).min_by_key(|&at| rank(&arrays[at])),
    };
    let Some(found) = found else {
        return Err(match wanted {
            Some(name) if !arrays.is_empty() => {
                VtkError::NoSuchArray { name: excerpt(name), names: names(&arrays) }
            }
            _ => VtkError::NoArrays,
        });
    };
    let array = arrays.remove(found);
    let mut lines =
        vec![HeaderLine::Field { name: "content".to_owned(), value: array.name.trim().to_owned() }];
    if array.name.trim().is_empty() {
        lines.clear();
    }
    let mut pair = |key: &str, value: String| lines.push(HeaderLine::KeyValue { key: key.to_owned(), value });
    if array.attribute != Attribute::Scalars {
        pair(ATTRIBUTE, array.attribute.name().to_owned());
    }
    if !arrays.is_empty() {
        pair(LEFT_OUT, names(&arrays));
    }
    Ok((array, lines))
}

fn names<Data>(arrays: &[Array<Data>]) -> String {
    let mut names: Vec<String> = arrays.iter().take(32).map(|array| excerpt(&array.name)).collect();
    if arrays.len() > names.len() {
        names.push(format!("and {} more", arrays.len() - names.len()));
    }
    names.join(", ")
}

/// Name that an array is written with.
pub(super) fn name_of(metadata: &Metadata) -> &str {
    metadata.name().filter(|name| !name.is_empty()).unwrap_or(NO_NAME)
}

/// As what samples of so many components are marked: as they were, else as scalars where these can be.
pub(super) fn attribute_of(metadata: &Metadata, components: u32) -> Attribute {
    let named = metadata.key_value(ATTRIBUTE);
    let found = Attribute::ALL.into_iter().find(|attribute| Some(attribute.name()) == named);
    let default = if components <= 4 { Attribute::Scalars } else { Attribute::Field };
    found.filter(|attribute| attribute.fits(components)).unwrap_or(default)
}

/// What remains of the metadata when those lines are taken out that [`choose`] and the grid make.
pub(super) fn without_own(metadata: &Metadata, is_of_grid: impl Fn(&HeaderLine) -> bool) -> Metadata {
    let mut rest = metadata.clone();
    rest.lines.retain(|line| {
        let own = match line {
            HeaderLine::Field { name, .. } => name.eq_ignore_ascii_case("content"),
            HeaderLine::KeyValue { key, .. } => key == ATTRIBUTE,
            HeaderLine::Comment(_) => false,
        };
        !own && !is_of_grid(line)
    });
    rest
}
