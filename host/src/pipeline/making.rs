//! Base mesh and shrink-wrap, until the surface fits.

use super::care::{Care, of_face};
use super::fit::{Aim, Fit, MISSED, Measured};
use super::round::{End, Round, Rounds};
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
/// And none whose base mesh has less than so many times as many vertices.
const FINER: f64 = 1.05;

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

impl Fitted {
    fn round(&self) -> Round {
        let vertices = [self.base.positions.len(), self.wrapped.surface.positions.len()];
        Round::new(vertices, self.wrapped.surface.levels, &self.fit)
    }
}

/// A base mesh, and how often it is to be split.
struct Planned {
    base: BaseMesh,
    levels: u32,
}

impl Making<'_> {
    /// Makes surfaces over finer and finer base meshes until one fits, or there is no point in going on; the best of them.
    pub(super) fn fitted(mut self, done: &mut dyn FnMut(Stage)) -> Result<(Fitted, Rounds), BuildError> {
        let aim = Aim::new(self.contour, self.field, self.distance.grid().cell_edge());
        let unit = self.unit(&aim);
        // Collapses do not lead sharp edges back to themselves.
        self.constraints.recorded = self.constraints.features.edges.is_empty();
        let mut care = Care::none(self.contour);
        let error = self.options.error * aim.cell;
        let mut planned = self.planned(&care, Target { error, ..target(self.contour, self.options.share)? })?;
        care.reach(planned.base.mesh.positions.len());
        let (mut best, mut rounds, mut least): (Option<Fitted>, Vec<Round>, _) = (None, Vec::new(), [f64::MAX; 2]);
        let end = loop {
            done(Stage::Base);
            let (next, measured) = self.made(&aim, &planned)?;
            done(Stage::Wrap);
            let found = excesses(&measured.fit, unit);
            rounds.push(next.round());
            if best.as_ref().is_none_or(|best| all(found) < all(excesses(&best.fit, unit))) {
                best = Some(next);
            }
            if found == [1.0; 2] {
                break End::Fits;
            }
            if rounds.len() as u32 > self.options.rounds {
                break End::Asked;
            }
            if (0..2).all(|one| found[one] > LEFT * least[one]) {
                break End::NoGain;
            }
            least = [0, 1].map(|one| least[one].min(found[one]));
            // Where all in all it fits, only what is lost needs a finer base mesh.
            let rms = measured.fit.rms();
            let off = if rms <= RMS * unit { MOST * unit } else { (OFF * unit).min(FAR * rms) };
            if !care.take(&aim, &measured, planned.levels, off) {
                break End::Finest;
            }
            drop(measured);
            let (before, error) = (planned.base.mesh.positions.len(), planned.base.error);
            planned = self.planned(&care, Target { vertices: 0, error })?;
            if (planned.base.mesh.positions.len() as f64) < FINER * before as f64 {
                break End::Finest;
            }
        };
        best.map(|best| (best, Rounds { made: rounds, end })).ok_or(BuildError::Empty)
    }

    /// The base mesh that care asks for, and how often it can be split within what the finest mesh may have.
    ///
    /// With fewer levels the finest mesh has fewer vertices for one of the target where the base mesh is fine already, and
    /// the base mesh becomes finer elsewhere.
    fn planned(&mut self, care: &Care, target: Target) -> Result<Planned, BuildError> {
        let BuildOptions { levels, growth, share, .. } = *self.options;
        let of_levels = |splits: u32| f64::from(of_face(splits));
        let vertices = self.contour.positions.len() as f64;
        let limit = growth * vertices * (share * of_levels(levels)).max(1.0);
        let mut splits = levels;
        loop {
            self.constraints.most = care.most(levels, splits);
            let least: f64 = self.constraints.most.iter().map(|&most| 1.0 / f64::from(most)).sum();
            if splits > 1 && least * of_levels(splits) > limit {
                splits -= 1;
                continue;
            }
            let base = base_mesh(self.contour, &self.constraints, target)?;
            if splits > 1 && base.mesh.positions.len() as f64 * of_levels(splits) > limit {
                splits -= 1;
                continue;
            }
            return Ok(Planned { base, levels: splits });
        }
    }

    /// What distances from the target are to be told in, in cells' edges: the facets of a coarse mesh need not be told from
    /// smooth surfaces.
    fn unit(&self, aim: &Aim) -> f64 {
        self.field.map_or_else(|| (mean_edge(self.contour) / (2.0 * aim.cell)).max(1.0), |_| 1.0)
    }

    /// Makes a surface over a base mesh, and measures it.
    fn made(&self, aim: &Aim, planned: &Planned) -> Result<(Fitted, Measured), BuildError> {
        let Planned { base, levels } = planned;
        let lines = self.field.is_none().then(|| Lines::of_mesh(self.contour, &self.constraints.features));
        let target = match self.field {
            Some((field, isovalue)) => wrap::Target::Isosurface(field, isovalue.into()),
            None => wrap::Target::Triangles(&aim.tree),
        };
        let options = WrapOptions {
            levels: *levels,
            tolerance: self.options.tolerance,
            target,
            lines: lines.as_ref(),
            ..WrapOptions::default()
        };
        let mut wrapped = wrap(&base.mesh, self.distance, &options)?;
        let measured = self.placed(aim, base, &mut wrapped, &options)?;
        let fitted = Fitted { base: base.mesh.clone(), wrapped, fit: measured.fit.clone() };
        Ok((fitted, measured))
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

/// What two excesses come to.
fn all([rms, most]: [f64; 2]) -> f64 {
    rms * most
}

/// Mean length of the sides of triangles.
fn mean_edge(mesh: &TriangleMesh) -> f64 {
    let lengths = mesh.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
        a.distance(b) + b.distance(c) + c.distance(a)
    });
    lengths.sum::<f64>() / (3 * mesh.triangles.len().max(1)) as f64
}
