//! A spatial index of capsules.

use super::Aabb;
use super::passage::Capsule;
use rustc_hash::FxHashMap;

/// Edge of a bucket in metres; tuned to a few capsules each.
const BUCKET_M: f32 = 8.0;

/// Capsules by the buckets of space that they influence.
#[derive(Debug)]
pub(super) struct Index {
    capsules: Vec<Capsule>,
    buckets: FxHashMap<[i32; 3], Vec<u32>>,
}

impl Index {
    /// Indexes capsules with an influence up to `reach_m` outside their walls.
    pub fn new(capsules: Vec<Capsule>, reach_m: f32) -> Self {
        let mut buckets: FxHashMap<[i32; 3], Vec<u32>> = FxHashMap::default();
        for (i, capsule) in (0..).zip(&capsules) {
            for bucket in buckets_of(capsule.bounds().padded(reach_m)) {
                buckets.entry(bucket).or_default().push(i);
            }
        }
        Self { capsules, buckets }
    }

    /// Every capsule that influences the box and possibly some more, in their order.
    pub fn near(&self, bounds: Aabb<f32>) -> Vec<&Capsule> {
        self.numbers(bounds).into_iter().map(|i| &self.capsules[i as usize]).collect()
    }

    /// The same with their numbers.
    pub fn numbered(&self, bounds: Aabb<f32>) -> Vec<(usize, &Capsule)> {
        self.numbers(bounds).into_iter().map(|i| (i as usize, &self.capsules[i as usize])).collect()
    }

    fn numbers(&self, bounds: Aabb<f32>) -> Vec<u32> {
        if buckets_of(bounds).nth(self.buckets.len()).is_some() {
            return (0..self.capsules.len() as u32).collect();
        }
        let mut found: Vec<u32> =
            buckets_of(bounds).filter_map(|bucket| self.buckets.get(&bucket)).flatten().copied().collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}

fn buckets_of(bounds: Aabb<f32>) -> impl Iterator<Item = [i32; 3]> {
    let bucket = |coordinate: f32| (coordinate / BUCKET_M).floor() as i32;
    let range = move |i: usize| bucket(bounds.min[i])..=bucket(bounds.max[i]);
    range(2).flat_map(move |z| range(1).flat_map(move |y| range(0).map(move |x| [x, y, z])))
}
