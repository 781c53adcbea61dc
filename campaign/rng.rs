//! Reproducible random numbers.

use rand::Rng as _;
use rand_pcg::Pcg64;
use sha2::{Digest, Sha256};

/// A stream of random numbers, one per attack, so that a change to one attack moves no other.
pub struct Rng(Pcg64);

impl Rng {
    /// The stream of the attack `name` in the campaign with this seed.
    pub fn new(seed: u64, name: &str) -> Self {
        let digest = Sha256::digest(format!("{seed} {name}"));
        let word = |at: usize| digest[at..at + 16].iter().fold(0, |word: u128, &byte| (word << 8) | u128::from(byte));
        Self(Pcg64::new(word(0), word(16)))
    }

    /// In `0..end`; 0 if `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        ((u128::from(self.0.next_u64()) * end as u128) >> 64) as usize
    }

    /// In `0.0..1.0`.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A random element.
    pub fn pick<'a, T>(&mut self, several: &'a [T]) -> &'a T {
        &several[self.below(several.len())]
    }
}
