//! Samples of a field on the lattice that all chunks share.
//!
//! A sample is at `f32(index as f32 * voxel_m)`, index counted from the origin of the cave, so two chunks that use the same
//! sample evaluate the field at the same point. Only bricks of the lattice through which the wall may pass are kept; culled
//! ones contain no crossing, so the mesh does not depend on how well the field culls.

use crate::field::{Aabb, Field, Region};

/// Cells along the edge of a brick. Tuned: small enough to follow the wall, large enough for a batch.
pub(super) const BRICK: i32 = 16;
/// Samples along the edge of a brick.
const SIDE: usize = BRICK as usize + 1;
const SAMPLES: usize = SIDE * SIDE * SIDE;

/// A box of cells of the lattice, `max` exclusive. Its samples include both ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) min: [i32; 3],
    pub(super) max: [i32; 3],
}

impl Window {
    /// Width of the halo in cells: two per smoothing step, and two for the decisions on a cell. Bubbles must be smaller by
    /// two.
    pub(super) const HALO: i32 = 12;

    pub(super) fn with_halo(&self) -> Self {
        Self { min: self.min.map(|cell| cell - Self::HALO), max: self.max.map(|cell| cell + Self::HALO - 1) }
    }

    /// The closed box of the samples, in metres.
    pub(super) fn bounds(&self, voxel_m: f32) -> Aabb<f32> {
        let metres = |cell: i32| cell as f32 * voxel_m;
        Aabb { min: self.min.map(metres), max: self.max.map(metres) }
    }

    pub(super) fn contains(&self, cell: [i32; 3]) -> bool {
        (0..3).all(|i| self.min[i] <= cell[i] && cell[i] < self.max[i])
    }

    pub(super) fn intersect(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|i| self.min[i].max(other.min[i])),
            max: std::array::from_fn(|i| self.max[i].min(other.max[i])),
        }
    }

    /// Divides into blocks of `edge` cells, narrower at the upper ends.
    pub(super) fn blocks(&self, edge: i32) -> impl Iterator<Item = Self> + use<> {
        let whole = *self;
        let last = std::array::from_fn(|i| (whole.max[i] - whole.min[i] - 1) / edge);
        Self { min: [0; 3], max: last }.samples().map(move |block| {
            let min = std::array::from_fn(|i| whole.min[i] + block[i] * edge);
            Self { min, max: min.map(|cell| cell + edge) }.intersect(&whole)
        })
    }

    /// Every integer point of the box, ends included, x fastest.
    fn samples(&self) -> impl Iterator<Item = [i32; 3]> + use<> {
        let Self { min, max } = *self;
        (min[2]..=max[2])
            .flat_map(move |z| (min[1]..=max[1]).flat_map(move |y| (min[0]..=max[0]).map(move |x| [x, y, z])))
    }
}

/// The bricks of a window through which the wall may pass.
pub(super) struct Lattice {
    /// In the order z, y, x of the whole lattice, so that the relative order does not depend on the window.
    pub(super) bricks: Vec<Brick>,
    /// Indices into `bricks` by brick of the window, x fastest.
    slots: Vec<Option<u32>>,
    /// Bricks under the window, counted in bricks.
    span: Window,
}

/// A cube of cells with the samples at its corners.
pub(super) struct Brick {
    /// Lowest cell.
    pub(super) origin: [i32; 3],
    /// The cells of the brick in the window.
    pub(super) cells: Window,
    samples: Box<[f32; SAMPLES]>,
}

impl Brick {
    /// The sample at a corner, offset from the origin by 0 to [`BRICK`] along each axis.
    pub(super) fn sample(&self, offset: [usize; 3]) -> f32 {
        self.samples[at(offset)]
    }

    /// The samples along x at an offset along y and z.
    pub(super) fn row(&self, y: usize, z: usize) -> &[f32] {
        let start = at([0, y, z]);
        &self.samples[start..start + SIDE]
    }

    fn offset(&self, index: [i32; 3]) -> [usize; 3] {
        std::array::from_fn(|i| (index[i] - self.origin[i]) as usize)
    }
}

fn at([x, y, z]: [usize; 3]) -> usize {
    (z * SIDE + y) * SIDE + x
}

impl Lattice {
    /// Samples `field` wherever the wall may pass through `window`.
    pub(super) fn sample(field: &dyn Field, voxel_m: f32, window: &Window) -> Self {
        let mut lattice = Self::cull(field, voxel_m, window);
        let mut sampler = Sampler::new(field, voxel_m);
        for brick in &mut lattice.bricks {
            let own = lowest_samples(brick);
            sampler.fill(brick, own.samples());
        }
        for index in 0..lattice.bricks.len() {
            let missing = lattice.copy_apron(index);
            sampler.fill(&mut lattice.bricks[index], missing.into_iter());
        }
        lattice
    }

    /// The brick that contains a cell, if it was kept.
    pub(super) fn brick_of(&self, cell: [i32; 3]) -> Option<usize> {
        let brick = cell.map(|c| c.div_euclid(BRICK));
        let slot = self.span.contains(brick).then(|| self.slot(brick))?;
        self.slots[slot].map(|index| index as usize)
    }

    fn slot(&self, brick: [i32; 3]) -> usize {
        let [x, y, z] = std::array::from_fn(|i| (brick[i] - self.span.min[i]) as usize);
        let [nx, ny] = [0, 1].map(|i| (self.span.max[i] - self.span.min[i]) as usize);
        (z * ny + y) * nx + x
    }

    fn cull(field: &dyn Field, voxel_m: f32, window: &Window) -> Self {
        let span = Window {
            min: window.min.map(|cell| cell.div_euclid(BRICK)),
            max: window.max.map(|cell| (cell - 1).div_euclid(BRICK) + 1),
        };
        let mut lattice = Self { bricks: Vec::new(), slots: Vec::new(), span };
        let last = Window { min: span.min, max: span.max.map(|brick| brick - 1) };
        for brick in last.samples() {
            let origin = brick.map(|b| b * BRICK);
            let cells = Window { min: origin, max: origin.map(|c| c + BRICK) }.intersect(window);
            let kept = field.region(cells.bounds(voxel_m)) == Region::Mixed;
            lattice.slots.push(kept.then_some(lattice.bricks.len() as u32));
            if kept {
                let samples = Box::new([f32::INFINITY; SAMPLES]);
                lattice.bricks.push(Brick { origin, cells, samples });
            }
        }
        lattice
    }

    /// Copies the samples on the upper faces of a brick from its neighbours, and returns the missing ones.
    fn copy_apron(&mut self, index: usize) -> Vec<[i32; 3]> {
        let own = lowest_samples(&self.bricks[index]);
        let outside = |sample: &[i32; 3]| (0..3).any(|i| sample[i] > own.max[i]);
        let apron: Vec<_> = self.bricks[index].cells.samples().filter(outside).collect();
        let mut missing = Vec::new();
        for sample in apron {
            match self.brick_of(sample) {
                Some(home) => {
                    let value = self.bricks[home].sample(self.bricks[home].offset(sample));
                    let brick = &mut self.bricks[index];
                    brick.samples[at(brick.offset(sample))] = value;
                }
                None => missing.push(sample),
            }
        }
        missing
    }
}

/// The samples of a brick that are not among the lower ones of another brick.
fn lowest_samples(brick: &Brick) -> Window {
    let last = brick.origin.map(|cell| cell + BRICK - 1);
    let max = std::array::from_fn(|i| brick.cells.max[i].min(last[i]));
    Window { min: brick.cells.min, max }
}

/// Evaluates a field in batches.
struct Sampler<'a> {
    field: &'a dyn Field,
    voxel_m: f32,
    indices: Vec<[i32; 3]>,
    points: Vec<[f32; 3]>,
    values: Vec<f32>,
}

impl<'a> Sampler<'a> {
    fn new(field: &'a dyn Field, voxel_m: f32) -> Self {
        let (indices, points, values) = (Vec::new(), Vec::new(), Vec::new());
        Self { field, voxel_m, indices, points, values }
    }

    fn fill(&mut self, brick: &mut Brick, indices: impl Iterator<Item = [i32; 3]>) {
        self.indices.clear();
        self.indices.extend(indices);
        if self.indices.is_empty() {
            return;
        }
        let point = |index: &[i32; 3]| index.map(|i| i as f32 * self.voxel_m);
        self.points.clear();
        self.points.extend(self.indices.iter().map(point));
        self.values.clear();
        self.values.resize(self.points.len(), 0.0);
        let bounds = brick.cells.bounds(self.voxel_m);
        self.field.distances(bounds, &self.points, &mut self.values);
        for (&index, &value) in self.indices.iter().zip(&self.values) {
            brick.samples[at(brick.offset(index))] = value;
        }
    }
}
