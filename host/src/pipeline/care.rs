//! Where the base mesh must be finer for the surface to fit.
//!
//! Horns, legs and thin sheets are small beside the faces of a base mesh that is as coarse as the rest of a surface allows.
//! So the surface is measured, and where it does not fit a base vertex may stand for only a part as many vertices as the
//! finest mesh has for it, and so on.

use super::fit::{Aim, Measured};
use crate::mesh::{Surface, TriangleMesh};

/// A round leaves one in so many.
const PART: u32 = 4;

/// How many vertices of the target one of the base mesh may stand for.
pub(super) struct Care {
    most: Vec<u32>,
    /// How far around a place the base mesh becomes finer, in edges of the target.
    rings: usize,
}

impl Care {
    /// No care yet: any number.
    pub(super) fn none(target: &TriangleMesh) -> Self {
        Self { most: vec![u32::MAX; target.positions.len()], rings: 0 }
    }

    /// Care reaches as far as the faces of a base mesh of so many vertices.
    pub(super) fn reach(&mut self, base: usize) {
        let share = self.most.len() as f64 / base.max(1) as f64;
        self.rings = share.sqrt().ceil() as usize;
    }

    /// Takes more care where a surface, of a base mesh that was split so often, is farther than `limit` cells' edges from the
    /// target or the target from it; whether there is such a place and care can be taken.
    pub(super) fn take(&mut self, aim: &Aim, measured: &Measured, splits: u32, limit: f64) -> bool {
        let mut marked: Vec<bool> = measured.of_target.iter().map(|&distance| distance > limit).collect();
        for &(_, triangle) in measured.off.iter().filter(|(distance, _)| *distance > limit) {
            let corners = aim.mesh.triangles[triangle as usize];
            corners.iter().for_each(|&corner| marked[corner as usize] = true);
        }
        for _ in 0..if marked.contains(&true) { self.rings } else { 0 } {
            grow(aim.mesh.polygons(), &mut marked);
        }
        let mut taken = false;
        for (most, _) in self.most.iter_mut().zip(marked).filter(|(_, marked)| *marked) {
            let before = std::mem::replace(most, ((*most).min(of_face(splits)) / PART).max(1));
            taken |= *most < before;
        }
        taken
    }

    /// How many vertices one of the base mesh may stand for, where faces are to be split `levels` times but are only split
    /// `splits` times: if that is less often, no more than the finest mesh has for it.
    pub(super) fn most(&self, levels: u32, splits: u32) -> Vec<u32> {
        let of_all = if splits < levels { of_face(splits) } else { u32::MAX };
        self.most.iter().map(|&most| most.min(of_all)).collect()
    }
}

/// How many faces a face becomes.
pub(super) const fn of_face(splits: u32) -> u32 {
    4_u32.saturating_pow(splits)
}

/// Marks the vertices of all faces that have a marked one.
pub(super) fn grow<'a>(faces: impl Iterator<Item = &'a [u32]>, marked: &mut [bool]) {
    let before = marked.to_vec();
    for face in faces {
        if face.iter().any(|&corner| before[corner as usize]) {
            face.iter().for_each(|&corner| marked[corner as usize] = true);
        }
    }
}
