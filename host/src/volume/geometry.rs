//! Where samples lie in space, whichever way a format says it.

use super::{Axis, HeaderLine, Metadata};

/// Which way the three coordinates of a position grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// To the patient's left, back and head: DICOM, ITK, MetaImage.
    LeftPosteriorSuperior,
    /// To the patient's right, front and head: NIfTI, MNI.
    RightAnteriorSuperior,
    /// To the patient's left, front and head.
    LeftAnteriorSuperior,
    /// Nobody says: the axes of a scanner, a simulation or a microscope.
    Unnamed,
}

impl Space {
    /// The space that NRRD calls so, by its long or its short name; every other name is [`Space::Unnamed`].
    pub fn named(name: &str) -> Self {
        match name.trim().to_ascii_lowercase().as_str() {
            "left-posterior-superior" | "lps" | "left-posterior-superior-time" | "lpst" => {
                Self::LeftPosteriorSuperior
            }
            "right-anterior-superior" | "ras" | "right-anterior-superior-time" | "rast" => {
                Self::RightAnteriorSuperior
            }
            "left-anterior-superior" | "las" | "left-anterior-superior-time" | "last" => {
                Self::LeftAnteriorSuperior
            }
            _ => Self::Unnamed,
        }
    }

    /// Name in NRRD's field `space`; none for [`Space::Unnamed`].
    pub const fn name(self) -> Option<&'static str> {
        match self {
            Self::LeftPosteriorSuperior => Some("left-posterior-superior"),
            Self::RightAnteriorSuperior => Some("right-anterior-superior"),
            Self::LeftAnteriorSuperior => Some("left-anterior-superior"),
            Self::Unnamed => None,
        }
    }

    /// Whether the first two coordinates grow to the left and to the back; `None` where nobody says.
    const fn signs(self) -> Option<(bool, bool)> {
        match self {
            Self::LeftPosteriorSuperior => Some((true, true)),
            Self::RightAnteriorSuperior => Some((false, false)),
            Self::LeftAnteriorSuperior => Some((true, false)),
            Self::Unnamed => None,
        }
    }
}

/// Positions of the samples of a volume: sample (i, j, k) lies at `origin + i * directions[0] + j * directions[1] +
/// k * directions[2]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Which way coordinates grow.
    pub space: Space,
    /// Steps from one sample to the next along x, y and z.
    pub directions: [[f64; 3]; 3],
    /// Position of the first sample.
    pub origin: [f64; 3],
}

impl Geometry {
    /// Axes of the volume along those of an unnamed space.
    pub const fn along_axes(spacing: [f64; 3], origin: [f64; 3]) -> Self {
        let [x, y, z] = spacing;
        Self { space: Space::Unnamed, directions: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], origin }
    }

    /// The same positions in the coordinates of another space. Only signs change, so nothing is rounded; coordinates
    /// of an unnamed space stay as they are.
    #[must_use]
    pub fn in_space(&self, space: Space) -> Self {
        let flips = match (self.space.signs(), space.signs()) {
            (Some(from), Some(to)) => [from.0 != to.0, from.1 != to.1],
            _ => [false; 2],
        };
        let flipped = |vector: [f64; 3]| {
            let [x, y, z] = vector;
            // Adding zero makes the zero that a flip gives a positive one.
            [if flips[0] { -x + 0.0 } else { x }, if flips[1] { -y + 0.0 } else { y }, z]
        };
        Self { space, directions: self.directions.map(flipped), origin: flipped(self.origin) }
    }

    /// Distances between samples along x, y and z.
    pub fn spacing(&self) -> [f64; 3] {
        self.directions.map(|axis| axis.iter().map(|part| part * part).sum::<f64>().sqrt())
    }
}

impl Metadata {
    /// Where the samples lie, in the space that the file names.
    ///
    /// From `space directions` and `space origin`, in two dimensions too; else from `spacings`, with the first sample
    /// at `axis mins` or at zero. Axes that a file lacks go on with steps of 1. `None` where there is neither, or
    /// where numbers are missing.
    pub fn geometry(&self) -> Option<Geometry> {
        let space = self.field("space").map_or(Space::Unnamed, Space::named);
        let Some(found) = self.directions() else {
            let spacing = self.spacing()?;
            return Some(Geometry {
                space,
                ..Geometry::along_axes(spacing, self.axis_mins().unwrap_or_default())
            });
        };
        let mut directions = Geometry::along_axes([1.0; 3], [0.0; 3]).directions;
        for (direction, found) in directions.iter_mut().zip(found) {
            *direction = three(&found)?;
        }
        let origin = match self.origin() {
            Some(origin) => three(&origin)?,
            None => [0.0; 3],
        };
        Some(Geometry { space, directions, origin })
    }

    /// Says where the samples lie, in place of what was said before: `space`, or `space dimension` where it has no
    /// name, `space directions`, `space origin`; `spacings` and `axis mins` go, but for a spacing of time.
    pub fn set_geometry(&mut self, geometry: &Geometry) {
        let time_step = self.axis_entry("spacings", Axis::Time(0)).map(str::to_owned);
        for name in ["space", "space dimension", "spacings", "axis mins", "axis maxs"] {
            self.remove_field(name);
        }
        let rank = self.rank();
        let mut vectors = geometry.directions[..rank].iter().chain([&geometry.origin]);
        let is_flat = geometry.space == Space::Unnamed
            && vectors.all(|vector| vector[rank..].iter().all(|part| *part == 0.0));
        // Slices of no space have as many coordinates as axes.
        let dimension = if is_flat { rank } else { 3 };
        match geometry.space.name() {
            Some(name) => self.set_field("space", name),
            None => self.set_field("space dimension", &dimension.to_string()),
        }
        let directions = self.axes.iter().map(|axis| match axis.space() {
            Some(axis) => vector_text(&geometry.directions[axis][..dimension]),
            None => "none".to_owned(),
        });
        let directions: Vec<String> = directions.collect();
        self.set_field("space directions", &directions.join(" "));
        self.set_field("space origin", &vector_text(&geometry.origin[..dimension]));
        if let Some(step) = time_step {
            self.set_axis_entry("spacings", Axis::Time(0), &step);
        }
    }

    fn axis_mins(&self) -> Option<[f64; 3]> {
        let mut mins = [0.0; 3];
        for (axis, entry) in self.space_entries("axis mins")? {
            mins[axis] = entry.parse().ok().filter(|value: &f64| value.is_finite())?;
        }
        Some(mins)
    }
}

impl HeaderLine {
    /// Whether this says where samples lie, and a format that keeps a [`Geometry`] therefore holds it.
    pub fn is_geometry(&self) -> bool {
        const NAMES: [&str; 6] =
            ["space", "space dimension", "space directions", "space origin", "spacings", "axis mins"];
        matches!(self, Self::Field { name, .. } if NAMES.iter().any(|known| super::metadata::is_same_name(known, name)))
    }
}

/// A vector of one to three coordinates, with zeros for those that it lacks.
fn three(vector: &[f64]) -> Option<[f64; 3]> {
    match *vector {
        [x] => Some([x, 0.0, 0.0]),
        [x, y] => Some([x, y, 0.0]),
        [x, y, z] | [x, y, z, _] => Some([x, y, z]),
        _ => None,
    }
}

/// `(1,0,0.5)`: the shortest decimals that give the same numbers again.
pub(super) fn vector_text(vector: &[f64]) -> String {
    let parts: Vec<String> = vector.iter().map(|part| (part + 0.0).to_string()).collect();
    format!("({})", parts.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::FileFormat;

    fn oblique() -> Geometry {
        Geometry {
            space: Space::RightAnteriorSuperior,
            directions: [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.1, 2.5]],
            origin: [-12.25, 1e-7, 3.0],
        }
    }

    #[test]
    fn a_geometry_that_is_set_is_found_again() {
        let mut metadata = Metadata::plain(3, FileFormat::Nrrd);
        for line in [("spacings", "1 1 2"), ("axis mins", "0 0 1"), ("content", "head")] {
            metadata.set_field(line.0, line.1);
        }
        assert_eq!(metadata.geometry(), Some(Geometry::along_axes([1.0, 1.0, 2.0], [0.0, 0.0, 1.0])));
        metadata.axes.insert(0, Axis::Component(3));
        metadata.set_geometry(&oblique());
        assert_eq!(metadata.geometry(), Some(oblique()));
        assert_eq!(metadata.field("space directions"), Some("none (0.6,0.8,0) (-0.8,0.6,0) (0,0.1,2.5)"));
        assert_eq!(metadata.field("spacings"), None);
        assert_eq!(metadata.name(), Some("head"));
        let there_and_back = oblique().in_space(Space::LeftPosteriorSuperior);
        assert_eq!(there_and_back.origin, [12.25, -1e-7, 3.0]);
        assert_eq!(there_and_back.in_space(Space::RightAnteriorSuperior), oblique());
        metadata.set_geometry(&Geometry { space: Space::Unnamed, ..oblique() });
        assert_eq!((metadata.field("space"), metadata.field("space dimension")), (None, Some("3")));
    }

    #[test]
    fn signs_flip_exactly_and_zeros_stay_positive() {
        for (space, signs) in [
            (Space::LeftPosteriorSuperior, [-1.0, -1.0]),
            (Space::LeftAnteriorSuperior, [-1.0, 1.0]),
            (Space::Unnamed, [1.0, 1.0]),
            (Space::RightAnteriorSuperior, [1.0, 1.0]),
        ] {
            let flipped = oblique().in_space(space);
            assert_eq!(flipped.origin, [-12.25 * signs[0], 1e-7 * signs[1], 3.0], "{space:?}");
            assert!(flipped.directions[2][0].is_sign_positive());
        }
        for space in [Space::LeftPosteriorSuperior, Space::LeftAnteriorSuperior, Space::RightAnteriorSuperior]
        {
            assert_eq!(Space::named(space.name().unwrap()), space);
        }
        assert_eq!(Space::named(" LPS"), Space::LeftPosteriorSuperior);
        assert_eq!(Space::named("scanner-xyz"), Space::Unnamed);
    }

    #[test]
    fn slices_lie_in_space_too() {
        let mut slice = Metadata::plain(2, FileFormat::Nrrd);
        assert_eq!(slice.geometry(), None);
        slice.set_field("space dimension", "2");
        slice.set_field("space directions", "(0.5,0) (0,0.25)");
        slice.set_field("space origin", "(7,8)");
        assert_eq!(slice.geometry(), Some(Geometry::along_axes([0.5, 0.25, 1.0], [7.0, 8.0, 0.0])));
        slice.set_geometry(&slice.geometry().unwrap());
        assert_eq!(slice.field("space directions"), Some("(0.5,0) (0,0.25)"));
        slice.set_field("space origin", "(7,x)");
        assert_eq!(slice.geometry(), Some(Geometry::along_axes([0.5, 0.25, 1.0], [0.0; 3])));
    }
}
