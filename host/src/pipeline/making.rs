//! Base mesh and shrink-wrap, until the surface fits.

use super::care::{Care, of_face};
use super::fit::{Aim, Fit, MISSED, Measured, ON, RMS};
use super::misfits::Misfits;
use super::round::{End, Round, Rounds};
use super::{BuildError, BuildOptions, Stage, target};
use crate::field::ScalarField;
use crate::mesh::{PolygonMesh, TriangleMesh};
use crate::simplify::{BaseMesh, Constraints, Target, base_mesh};
use crate::wrap::{self, Lines, Settling, WrapOptions, Wrapped};

/// Where it does not fit, the base mesh becomes finer around places farther than this, or …
const OFF: f64 = 0.25;
/// … than so many times the root mean square.
const FAR: f64 = 2.0;
/// No further round unless the last one left less than this of what the root mean square or the farthest is too large by, or
/// had fewer levels than the one before, which shows what it is good for only when the base mesh is finer.
const LEFT: f64 = 0.9;
/// And none whose base mesh has nearly as many vertices as the last one: but for so small a part of them, it is the same.
const SAME: f64 = 1e-4;
/// So many times the root mean square may be what it was for faces to be turned back where the surface does not fit.
const WORSE: f64 = 1.05;
/// At first, the finest mesh may have one in so many of the vertices that it may have in the end: what shows where care is to
/// be taken need not be fine.
const FIRST: f64 = 2.0;
/// The finest mesh has no more vertices than this, unless those options that bound it allow no less than that: two gigabytes.
const MANY: f64 = 2_097_152.0;

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

impl Planned {
    /// Whether this is no other surface than the last one.
    fn is_same(&self, last: &Self) -> bool {
        let [new, old] = [self, last].map(|planned| planned.base.mesh.positions.len() as f64);
        self.levels == last.levels && (new - old).abs() <= SAME * old
    }
}

impl Making<'_> {
    /// Makes surfaces over finer and finer base meshes until one fits, or there is no point in going on; the best of them.
    pub(super) fn fitted(mut self, done: &mut dyn FnMut(Stage)) -> Result<(Fitted, Rounds), BuildError> {
        let aim = Aim::new(self.contour, self.field, self.distance.grid().cell_edge());
        let unit = self.unit(&aim);
        // Collapses do not lead sharp edges back to themselves.
        self.constraints.recorded = self.constraints.features.edges.is_empty();
        let mut care = Care::none(self.contour);
        let BuildOptions { share, error, growth, rounds: more, .. } = *self.options;
        let first = Target { error: error * aim.cell, ..target(self.contour, share)? };
        let mut planned = self.planned(&care, first, growth / FIRST)?;
        care.reach(planned.base.mesh.positions.len());
        let mut best: Option<Fitted> = None;
        let (mut rounds, mut least) = (Vec::new(), [f64::MAX; 2]);
        let mut splits = None;
        let end = loop {
            done(Stage::Base);
            let (next, measured) = self.made(&aim, &planned)?;
            done(Stage::Wrap);
            let found = excesses(&measured.fit, unit);
            rounds.push(next.round());
            if best.as_ref().is_none_or(|best| is_better(found, excesses(&best.fit, unit))) {
                best = Some(next);
            }
            if found == [1.0; 2] {
                break End::Fits;
            }
            if rounds.len() as u32 > more {
                break End::Asked;
            }
            if splits == Some(planned.levels) && (0..2).all(|one| found[one] > LEFT * least[one]) {
                break End::NoGain;
            }
            splits = Some(planned.levels);
            least = [0, 1].map(|one| least[one].min(found[one]));
            // Where all in all it fits, only what is lost needs a finer base mesh.
            let rms = measured.fit.rms();
            let off = if rms <= RMS * unit { MISSED * unit } else { (OFF * unit).min(FAR * rms).max(ON) };
            if !care.take(&aim, &measured, planned.levels, off) {
                break End::Finest;
            }
            drop(measured);
            let next = self.planned(&care, Target { vertices: 0, error: planned.base.error }, growth)?;
            if next.is_same(&planned) {
                break End::Finest;
            }
            planned = next;
        };
        let mut best = best.ok_or(BuildError::Empty)?;
        let mut rounds = Rounds { made: rounds, end };
        if more > 0 && best.fit.rms() > RMS * unit && self.may_split(&planned) {
            planned.levels += 1;
            let next = self.made(&aim, &planned)?.0;
            done(Stage::Wrap);
            rounds.made.push(next.round());
            let [found, least] = [&next, &best].map(|one| excesses(&one.fit, unit));
            rounds.end = if found == [1.0; 2] { End::Fits } else { rounds.end };
            best = if is_better(found, least) { next } else { best };
        }
        if best.wrapped.report.inverted.corners > 0 {
            best = self.untangled(&aim, best)?;
            done(Stage::Wrap);
        }
        Ok((best, rounds))
    }

    /// Whether a base mesh that was split less often than asked for, so that the finest mesh is not much finer than the
    /// target, may be split once more where nothing else is left to do.
    fn may_split(&self, planned: &Planned) -> bool {
        let vertices = planned.base.mesh.positions.len() as f64 * f64::from(of_face(planned.levels + 1));
        planned.levels < self.options.levels && vertices <= MANY
    }

    /// Turns faces back that are turned over, unless the surface no longer fits then, or fits worse by a good deal.
    fn untangled(&self, aim: &Aim, mut fitted: Fitted) -> Result<Fitted, BuildError> {
        let Fitted { base, wrapped, fit } = &mut fitted;
        let levels = wrapped.surface.levels;
        let before = (wrapped.surface.positions.clone(), wrapped.report.clone());
        let lines = self.lines();
        Settling::new(base, levels, self.distance, &self.wrapping(aim, levels, lines.as_ref()))?
            .untangled(wrapped);
        let after = aim.measure(&wrapped.surface.level(levels)).fit;
        if after.rms() <= (WORSE * fit.rms()).max(RMS * self.unit(aim)) {
            *fit = after;
        } else {
            (wrapped.surface.positions, wrapped.report) = before;
        }
        Ok(fitted)
    }

    /// The base mesh that care asks for, and how often it can be split within what the finest mesh may have.
    ///
    /// With fewer levels the finest mesh has fewer vertices for one of the target where the base mesh is fine already, and
    /// the base mesh becomes finer elsewhere.
    fn planned(&mut self, care: &Care, target: Target, growth: f64) -> Result<Planned, BuildError> {
        let BuildOptions { levels, share, .. } = *self.options;
        let of_levels = |splits: u32| f64::from(of_face(splits));
        let asked = self.contour.positions.len() as f64 * (share * of_levels(levels)).max(1.0);
        let limit = if growth.is_finite() { (growth * asked).min(MANY.max(asked)) } else { growth };
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
        let lines = self.lines();
        let options = self.wrapping(aim, *levels, lines.as_ref());
        let mut wrapped = wrap::wrap(&base.mesh, self.distance, &options)?;
        let measured = self.settled(aim, base, &mut wrapped, &options)?;
        let fitted = Fitted { base: base.mesh.clone(), wrapped, fit: measured.fit.clone() };
        Ok((fitted, measured))
    }

    /// What the sharp edges of a base mesh are attracted to.
    fn lines(&self) -> Option<Lines> {
        self.field.is_none().then(|| Lines::of_mesh(self.contour, &self.constraints.features))
    }

    /// How a surface is wrapped.
    fn wrapping<'a>(&'a self, aim: &'a Aim, levels: u32, lines: Option<&'a Lines>) -> WrapOptions<'a> {
        let target = match self.field {
            Some((field, isovalue)) => wrap::Target::Isosurface(field, isovalue.into()),
            None => wrap::Target::Triangles(&aim.tree),
        };
        WrapOptions { levels, tolerance: self.options.tolerance, target, lines, ..WrapOptions::default() }
    }

    /// Measures a surface; where it does not fit, parts of it are placed another way, and vertices are drawn to crests.
    fn settled(
        &self,
        aim: &Aim,
        base: &BaseMesh,
        wrapped: &mut Wrapped,
        options: &WrapOptions,
    ) -> Result<Measured, BuildError> {
        let levels = wrapped.surface.levels;
        let mut measured = aim.measure(&wrapped.surface.level(levels));
        let look = |wrapped: &Wrapped, measured: &Measured, whole: bool| {
            Misfits::new(aim, wrapped, base.history.as_ref()?, measured, self.unit(aim), whole)
        };
        let misfits = look(wrapped, &measured, true);
        let may_draw = self.field.is_some() && self.options.rounds > 0;
        let is_rough = |measured: &Measured| may_draw && measured.fit.backward.rms > RMS;
        if misfits.is_none() && !is_rough(&measured) {
            return Ok(measured);
        }
        let mut settling = Settling::new(&base.mesh, levels, self.distance, options)?;
        if let (Some(misfits), Some(history)) = (misfits, &base.history) {
            let places = history.places(self.contour, &base.mesh, levels);
            measured = misfits.placed(aim, wrapped, &mut settling, &places, measured);
            // Where it is not worth it to place a component as a whole, it may be for what is bad of it.
            if misfits.has_whole
                && let Some(parts) = look(wrapped, &measured, false)
            {
                measured = parts.placed(aim, wrapped, &mut settling, &places, measured);
            }
        }
        if is_rough(&measured) && settling.drawn(wrapped, &aim.draws(&measured, RMS)) > 0 {
            measured = aim.measure(&wrapped.surface.level(levels));
        }
        Ok(measured)
    }
}

/// By how many times what fits a surface is off: its root mean square, and the farthest that is lost of its target.
fn excesses(fit: &Fit, unit: f64) -> [f64; 2] {
    [fit.rms() / (RMS * unit), fit.backward.most / (MISSED * unit)].map(|excess| excess.max(1.0))
}

/// Whether a surface that is too far off by so much is better than one over a coarser base mesh: if it fits, or by a good deal,
/// if that one fits all in all. The root mean square counts more than one place.
fn is_better(found: [f64; 2], best: [f64; 2]) -> bool {
    let all = |[rms, most]: [f64; 2]| rms * rms * most;
    found == [1.0; 2] || all(found) < all(best) * if best[0] > 1.0 { 1.0 } else { LEFT }
}

/// Mean length of the sides of triangles.
fn mean_edge(mesh: &TriangleMesh) -> f64 {
    let lengths = mesh.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
        a.distance(b) + b.distance(c) + c.distance(a)
    });
    lengths.sum::<f64>() / (3 * mesh.triangles.len().max(1)) as f64
}
