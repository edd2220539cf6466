//! Base mesh and shrink-wrap, until the surface fits.

use super::care::Care;
use super::fit::{Aim, Fit, MISSED, Measured};
use super::{BuildError, BuildOptions, Stage, target};
use crate::field::ScalarField;
use crate::mesh::{PolygonMesh, TriangleMesh};
use crate::simplify::{BaseMesh, Constraints, Target, base_mesh};
use crate::wrap::{self, Lines, Settling, WrapOptions, Wrapped, wrap};

/// A surface fits whose distance from the target is at most this, root mean square, in cells' edges.
const RMS: f64 = 0.05;
/// And a place of it that is at most so far: what is farther counts as missed.
const MOST: f64 = MISSED;
/// Where it does not fit, the base mesh becomes finer around places farther than this, or …
const OFF: f64 = 0.25;
/// … than so many times the root mean square.
const FAR: f64 = 2.0;
/// Components are placed by way of the collapses where that leaves less than this of what their distances are too large by.
const WORTH: f64 = 0.7;
/// No further round unless the last one left less than this of what the root mean square or the farthest is too large by.
const LEFT: f64 = 0.9;

/// What a surface is made of.
pub(super) struct Making<'a> {
    pub(super) contour: &'a TriangleMesh,
    pub(super) constraints: Constraints,
    pub(super) field: Option<(&'a ScalarField, f32)>,
    pub(super) distance: &'a ScalarField,
    pub(super) options: &'a BuildOptions,
}

/// A surface, the base mesh under it, and how well it fits.
pub(super) struct Fitted {
    pub(super) base: PolygonMesh,
    pub(super) wrapped: Wrapped,
    pub(super) fit: Fit,
}

impl Making<'_> {
    /// Makes surfaces over finer and finer base meshes until one fits; the best of them.
    pub(super) fn fitted(mut self, done: &mut dyn FnMut(Stage)) -> Result<Fitted, BuildError> {
        let aim = Aim::new(self.contour, self.field, self.distance.grid().cell_edge());
        // Collapses do not lead sharp edges back to themselves.
        self.constraints.recorded = self.constraints.features.edges.is_empty();
        let (mut fitted, measured, error) =
            self.made(&aim, target(self.contour, self.options.share)?, done)?;
        let mut care = Care::none(self.contour, fitted.base.positions.len());
        let mut measured = measured;
        let unit = self.unit(&aim);
        let mut least = excesses(&measured.fit, unit);
        for _ in 0..self.options.rounds {
            // Where all in all it fits, only what is lost needs a finer base mesh.
            let rms = measured.fit.rms();
            let off = if rms <= RMS * unit { MOST * unit } else { (OFF * unit).min(FAR * rms) };
            if least == [1.0; 2] || !care.take(&aim, &measured, off) {
                break;
            }
            self.constraints.most = care.most(self.options.levels);
            let next;
            (next, measured, _) = self.made(&aim, Target { vertices: 0, error }, done)?;
            let found = excesses(&next.fit, unit);
            let all = |fit: &Fit| excesses(fit, unit).iter().product::<f64>();
            if all(&next.fit) < all(&fitted.fit) {
                fitted = next;
            }
            if (0..2).all(|one| found[one] > LEFT * least[one]) {
                break;
            }
            least = [0, 1].map(|one| least[one].min(found[one]));
        }
        Ok(fitted)
    }

    /// What distances from the target are to be told in, in cells' edges: the facets of a coarse mesh need not be told from
    /// smooth surfaces.
    fn unit(&self, aim: &Aim) -> f64 {
        self.field.map_or_else(|| (mean_edge(self.contour) / (2.0 * aim.cell)).max(1.0), |_| 1.0)
    }

    /// Makes a surface; its measures and the error of its base mesh, too.
    fn made(
        &self,
        aim: &Aim,
        target: Target,
        done: &mut dyn FnMut(Stage),
    ) -> Result<(Fitted, Measured, f64), BuildError> {
        let base = base_mesh(self.contour, &self.constraints, target)?;
        done(Stage::Base);
        let lines = self.field.is_none().then(|| Lines::of_mesh(self.contour, &self.constraints.features));
        let target = match self.field {
            Some((field, isovalue)) => wrap::Target::Isosurface(field, isovalue.into()),
            None => wrap::Target::Triangles(&aim.tree),
        };
        let BuildOptions { levels, tolerance, .. } = *self.options;
        let options =
            WrapOptions { levels, tolerance, target, lines: lines.as_ref(), ..WrapOptions::default() };
        let mut wrapped = wrap(&base.mesh, self.distance, &options)?;
        let measured = self.placed(aim, &base, &mut wrapped, &options)?;
        done(Stage::Wrap);
        Ok((Fitted { base: base.mesh, wrapped, fit: measured.fit.clone() }, measured, base.error))
    }

    /// Places the components that do not fit by way of the collapses, where that is much better; and measures the surface.
    fn placed(
        &self,
        aim: &Aim,
        base: &BaseMesh,
        wrapped: &mut Wrapped,
        options: &WrapOptions,
    ) -> Result<Measured, BuildError> {
        let levels = wrapped.surface.levels;
        let mut surface = wrapped.surface.level(levels);
        let measured = aim.measure(&surface);
        let Some(history) = &base.history else { return Ok(measured) };
        let ones = aim.components_of(&surface, history);
        let limits = [RMS, MOST].map(|limit| limit * self.unit(aim));
        let before = aim.excesses(&ones, &measured, limits);
        let misfits: Vec<bool> = ones.iter().map(|&one| before[one as usize] > 1.0).collect();
        if !misfits.contains(&true) {
            return Ok(measured);
        }
        let places = history.places(self.contour, &base.mesh, levels);
        let mut settling = Settling::new(&base.mesh, levels, self.distance, options)?;
        surface.positions.copy_from_slice(settling.settled(&wrapped.surface.positions, &places, &misfits));
        let settled = aim.measure(&surface);
        let after = aim.excesses(&ones, &settled, limits);
        let worth = |&one: &u32| after[one as usize] < WORTH * before[one as usize];
        let better: Vec<bool> = ones.iter().map(worth).collect();
        if !better.contains(&true) {
            return Ok(measured);
        }
        settling.finish(wrapped, &better);
        if better == misfits {
            return Ok(settled);
        }
        surface.positions.copy_from_slice(&wrapped.surface.positions);
        Ok(aim.measure(&surface))
    }
}

/// By how many times what fits a surface is off: its root mean square, and the farthest that is lost of its target.
fn excesses(fit: &Fit, unit: f64) -> [f64; 2] {
    [fit.rms() / (RMS * unit), fit.backward.most / (MOST * unit)].map(|excess| excess.max(1.0))
}

/// Mean length of the sides of triangles.
fn mean_edge(mesh: &TriangleMesh) -> f64 {
    let lengths = mesh.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
        a.distance(b) + b.distance(c) + c.distance(a)
    });
    lengths.sum::<f64>() / (3 * mesh.triangles.len().max(1)) as f64
}
