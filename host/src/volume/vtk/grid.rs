//! Where the points of an image lie: VTK's numbers, and NRRD's words for them.
//!
//! Sources: *VTK File Formats* (Kitware) for extents, origin and spacing; class `vtkImageData` for the direction
//! matrix, whose columns are the directions of the axes: point (i, j, k) lies at origin + D diag(spacing) (i, j, k),
//! where i, j, k count from the start of the extent's numbering, not of the extent. *Definition of the NRRD file
//! format* (Teem) for `space directions` and `space origin`, which is the place of the first sample.

use crate::volume::metadata::is_same_name;
use crate::volume::{Header, HeaderLine, Metadata};

/// Key of the pair that keeps what NRRD has no words for.
const KEY: &str = "vtk.grid";

const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// A regular grid of points, and whether samples belong to them or to the cells between them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    /// First index along each axis.
    pub(super) start: [i64; 3],
    /// Points along each axis.
    pub(super) points: [u64; 3],
    /// Place of the point with index 0, 0, 0.
    pub(super) origin: [f64; 3],
    pub(super) spacing: [f64; 3],
    /// Row by row.
    pub(super) direction: [f64; 9],
    pub(super) of_cells: bool,
}

impl Grid {
    /// A grid of so many points with spacing 1 from the origin on.
    pub(super) const fn plain(points: [u64; 3]) -> Self {
        let (start, origin, spacing) = ([0; 3], [0.0; 3], [1.0; 3]);
        Self { start, points, origin, spacing, direction: IDENTITY, of_cells: false }
    }

    /// Samples along each axis: an axis of one point has one cell.
    pub(super) fn samples(&self) -> [u64; 3] {
        self.points.map(|points| if self.of_cells { points.saturating_sub(1).max(1) } else { points })
    }

    /// Number of samples, if 64 bits count the bytes of so many.
    pub(super) fn count(&self) -> Option<u64> {
        let count = self.samples().into_iter().try_fold(1, u64::checked_mul);
        count.filter(|&count| count > 0 && count <= u64::MAX / 8)
    }

    /// Whether the axes of the grid are those of space.
    pub(super) fn is_upright(&self) -> bool {
        self.direction == IDENTITY
    }

    /// Step in space along each axis.
    fn steps(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|axis| {
            std::array::from_fn(|row| {
                let part = self.direction[3 * row + axis];
                if part == 0.0 { 0.0 } else { part * self.spacing[axis] }
            })
        })
    }

    /// Place of the first point.
    pub(super) fn first_point(&self) -> [f64; 3] {
        self.place(0.0)
    }

    /// Place of the first sample: a point, or the middle of a cell.
    fn first(&self) -> [f64; 3] {
        self.place(if self.of_cells { 0.5 } else { 0.0 })
    }

    /// Place of what lies so many points behind the first one, along each axis that has more than one.
    fn place(&self, behind: f64) -> [f64; 3] {
        let steps = self.steps();
        let mut place = self.origin;
        for (axis, step) in steps.into_iter().enumerate() {
            let by = self.start[axis] as f64 + if self.points[axis] > 1 { behind } else { 0.0 };
            if by != 0.0 {
                place.iter_mut().zip(step).for_each(|(value, step)| *value += by * step);
            }
        }
        place
    }

    /// The grid in NRRD's words, and all of it in a pair where they do not tell all.
    pub(super) fn lines(&self) -> Vec<HeaderLine> {
        let field = |name: &str, value: String| HeaderLine::Field { name: name.to_owned(), value };
        let steps = self.steps().map(|step| format!("({})", joined(&step, ",")));
        let mut lines = vec![
            field("space dimension", "3".to_owned()),
            field("space directions", steps.join(" ")),
            field("space origin", format!("({})", joined(&self.first(), ","))),
        ];
        if self.of_cells || self.start != [0; 3] || !self.is_upright() {
            lines.push(HeaderLine::KeyValue { key: KEY.to_owned(), value: self.text() });
        }
        lines
    }

    fn text(&self) -> String {
        let of = if self.of_cells { "cells" } else { "points" };
        format!(
            "{of} {} {} {} {} {}",
            joined(&self.start, " "),
            joined(&self.points, " "),
            joined(&self.origin, " "),
            joined(&self.spacing, " "),
            joined(&self.direction, " ")
        )
    }

    fn from_text(text: &str) -> Option<Self> {
        let mut words = text.split_whitespace();
        let of_cells = words.next()? == "cells";
        let mut numbers = words.map(str::parse::<f64>);
        let mut next = || numbers.next().and_then(Result::ok);
        let start = three(|| next().map(|value| value as i64))?;
        let points = three(|| next().map(|value| value as u64))?;
        let (origin, spacing) = (three(&mut next)?, three(&mut next)?);
        let rows = [three(&mut next)?, three(&mut next)?, three(&mut next)?];
        let direction = std::array::from_fn(|at| rows[at / 3][at % 3]);
        Some(Self { start, points, origin, spacing, direction, of_cells })
    }

    /// The grid of a data set: the one it was read from if it still has its samples in the same places, else one
    /// that NRRD's words describe. Axes that these say nothing of have spacing 1.
    pub(super) fn of(header: &Header) -> Self {
        let metadata = &header.metadata;
        let kept = metadata.key_value(KEY).and_then(Self::from_text);
        let same = |grid: &Self| {
            let there = Metadata { lines: grid.lines(), ..metadata.clone() };
            grid.samples() == header.extent
                && there.directions() == metadata.directions()
                && there.origin() == metadata.origin()
        };
        if let Some(grid) = kept.filter(same) {
            return grid;
        }
        let mut grid = Self::plain(header.extent);
        if let Some(spacing) = metadata.spacing() {
            grid.spacing = spacing;
        }
        for (axis, step) in metadata.directions().unwrap_or_default().iter().take(3).enumerate() {
            grid.turn(axis, step);
        }
        for (value, given) in grid.origin.iter_mut().zip(metadata.origin().unwrap_or_default()) {
            *value = given;
        }
        grid
    }

    /// Gives an axis its step in space, unless that has no length.
    fn turn(&mut self, axis: usize, step: &[f64]) {
        let along = step.iter().filter(|part| **part != 0.0).count();
        let length = match along {
            1 => step.iter().map(|part| part.abs()).sum(),
            _ => step.iter().map(|part| part * part).sum::<f64>().sqrt(),
        };
        if along == 0 || !length.is_finite() || length == 0.0 || step.len() > 3 {
            return;
        }
        self.spacing[axis] = length;
        for row in 0..3 {
            self.direction[3 * row + axis] = step.get(row).map_or(0.0, |part| part / length);
        }
    }

    /// Whether a line is one of those that the grid is made from.
    pub(super) fn has_line(line: &HeaderLine) -> bool {
        const FIELDS: [&str; 4] = ["space dimension", "space directions", "space origin", "spacings"];
        match line {
            HeaderLine::Field { name, .. } => FIELDS.iter().any(|field| is_same_name(field, name)),
            HeaderLine::KeyValue { key, .. } => key == KEY,
            HeaderLine::Comment(_) => false,
        }
    }
}

fn three<T>(mut next: impl FnMut() -> Option<T>) -> Option<[T; 3]> {
    Some([next()?, next()?, next()?])
}

/// Numbers as text, each with as few digits as tell it from its neighbours.
pub(super) fn joined<T: ToString>(numbers: &[T], between: &str) -> String {
    let texts: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    texts.join(between)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{ElementType, FileFormat};

    fn header(grid: &Grid) -> Header {
        let mut metadata = Metadata::plain(3, FileFormat::VtkXml);
        metadata.lines = grid.lines();
        Header::scalar(grid.samples(), ElementType::U8, metadata)
    }

    #[test]
    fn grids_come_back_from_their_lines() {
        let mut grid = Grid::plain([4, 3, 1]);
        assert_eq!(Grid::of(&header(&grid)), grid);
        grid.spacing = [0.1, 3.0, 1e-7];
        grid.origin = [-1.0 / 3.0, 1e30, 0.0];
        assert_eq!(grid.lines().len(), 3);
        assert_eq!(Grid::of(&header(&grid)), grid);
        grid.direction = [0.6, -0.8, 0.0, 0.8, 0.6, 0.0, 0.0, 0.0, -1.0];
        grid.start = [5, -7, 0];
        assert_eq!(Grid::of(&header(&grid)), grid);
        grid.of_cells = true;
        assert_eq!(header(&grid).extent, [3, 2, 1]);
        assert_eq!(Grid::of(&header(&grid)), grid);
    }

    #[test]
    fn the_first_sample_lies_where_vtk_says() {
        let mut grid = Grid::plain([4, 3, 2]);
        grid.direction = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        (grid.spacing, grid.origin, grid.start) = ([2.0, 3.0, 5.0], [10.0, 20.0, 30.0], [1, 2, 0]);
        // D diag(spacing) (1, 2, 0) = D (2, 6, 0) = (-6, 2, 0).
        assert_eq!(grid.first(), [4.0, 22.0, 30.0]);
        assert_eq!(grid.steps(), [[0.0, 2.0, 0.0], [-3.0, 0.0, 0.0], [0.0, 0.0, 5.0]]);
        grid.of_cells = true;
        assert_eq!(grid.first(), [2.5, 23.0, 32.5]);
    }

    #[test]
    fn samples_that_moved_have_a_grid_of_their_own() {
        let mut grid = Grid::plain([4, 3, 2]);
        (grid.start, grid.spacing) = ([1, 0, 0], [2.0, 1.0, 1.0]);
        let mut moved = header(&grid);
        moved.metadata = moved.metadata.of_part([1, 0, 0], 1);
        moved.extent = [3, 3, 2];
        let found = Grid::of(&moved);
        assert_eq!((found.start, found.points, found.origin), ([0; 3], [3, 3, 2], [4.0, 0.0, 0.0]));
        assert_eq!(found.spacing, [2.0, 1.0, 1.0]);
    }
}
