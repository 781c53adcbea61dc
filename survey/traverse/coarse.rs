//! A coarse correction for large systems, which propagates over long distances in one step.
//!
//! Conjugate gradients propagate a misclosure by one station per iteration. Stations are grouped into patches that move as
//! one (Nicolaides 1987: "Deflation of conjugate gradients"), and the system of the patches is solved exactly by
//! elimination. Added to the diagonal preconditioner, this takes a tenth of the iterations or less.

use std::collections::VecDeque;

use nalgebra::{Matrix3, Vector3};

use super::loops::{Block, Network};

/// Stations per patch, if the patches can be eliminated. Tuned.
const LEAST_SIZE: usize = 24;
/// Most neighbours of a patch during elimination: memory grows with their square. Tuned.
const MOST_NEIGHBORS: usize = 160;

/// The eliminated patches.
pub(super) struct Coarse {
    /// The patch of each station.
    patch_of: Vec<usize>,
    patches: Network,
}

impl Coarse {
    /// The correction for stations coupled to others and to fixed ones. `None` if no patches are found that can be
    /// eliminated.
    pub(super) fn of(blocks: &[Vec<Block>], firm: &[Matrix3<f64>]) -> Option<Self> {
        let sizes = std::iter::successors(Some(LEAST_SIZE), |size| Some(2 * size));
        sizes.take_while(|size| *size < blocks.len()).find_map(|size| {
            let patch_of = patches(blocks, size);
            let count = patch_of.iter().max()? + 1;
            let mut patches = Network::new(count);
            for (station, &patch) in patch_of.iter().enumerate() {
                patches.block(patch, count, firm[station]);
                for &(other, block) in blocks[station].iter().filter(|(other, _)| patch_of[*other] != patch) {
                    patches.block(patch, patch_of[other], block);
                }
            }
            patches.eliminate(MOST_NEIGHBORS);
            patches.is_eliminated().then_some(Self { patch_of, patches })
        })
    }

    /// Adds the correction of its patch to each station for this right-hand side.
    pub(super) fn add_corrections(&self, rhs: &[Vector3<f64>], corrections: &mut [Vector3<f64>]) {
        let mut of_patch = vec![Vector3::zeros(); self.patch_of.iter().max().map_or(0, |last| last + 1)];
        rhs.iter().zip(&self.patch_of).for_each(|(weighted, &patch)| of_patch[patch] += weighted);
        let of_patch = self.patches.solved(of_patch);
        corrections.iter_mut().zip(&self.patch_of).for_each(|(by, &patch)| *by += of_patch[patch]);
    }
}

/// The patch of each station: stations with their neighbours, at most `size` per patch.
fn patches(blocks: &[Vec<Block>], size: usize) -> Vec<usize> {
    const NONE: usize = usize::MAX;
    let mut patch_of = vec![NONE; blocks.len()];
    let mut patch = 0;
    for first in 0..blocks.len() {
        if patch_of[first] != NONE {
            continue;
        }
        let (mut ahead, mut taken) = (VecDeque::from([first]), 1);
        patch_of[first] = patch;
        while let Some(station) = ahead.pop_front() {
            for &(other, _) in &blocks[station] {
                if taken < size && patch_of[other] == NONE {
                    patch_of[other] = patch;
                    taken += 1;
                    ahead.push_back(other);
                }
            }
        }
        patch += 1;
    }
    patch_of
}
