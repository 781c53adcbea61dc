//! What the vertical lines through the cells of a grid cross.

/// Crossings of surfaces with the vertical lines through the centres of the cells of a grid.
///
/// Cell `[i, j]` is the square between `i` and `i + 1` times the side of a cell along x, and so along y with `j`: the grid is
/// fixed to the frame and not to the triangles.
pub struct Columns {
    cell_m: f64,
    crossings: Vec<Crossing>,
}

/// Air between a floor and what is over it, at the centre of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// The cell.
    pub cell: [i32; 2],
    /// Height of the floor in metres.
    pub floor_m: f32,
    /// Height of what is over it, in metres.
    pub ceiling_m: f32,
}

impl Gap {
    /// From floor to ceiling, in metres.
    pub fn height_m(&self) -> f32 {
        self.ceiling_m - self.floor_m
    }
}

/// Where a line, followed upwards, passes from air into something solid or out of it.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    pub cell: [i32; 2],
    pub z_m: f32,
    pub is_entry: bool,
}

impl Columns {
    /// A grid of cells with this side in metres.
    pub fn new(cell_m: f64) -> Self {
        Self { cell_m, crossings: Vec::new() }
    }

    /// Side of a cell in metres.
    pub fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// Adds triangles that are counter-clockwise from the air: corners in metres, and three indices a triangle.
    ///
    /// All together must enclose what is solid: the wall around the air, and closed bodies in it, which may overlap.
    pub fn add(&mut self, corners: &[[f32; 3]], indices: &[u32]) {
        for triangle in indices.as_chunks::<3>().0 {
            self.add_triangle(triangle.map(|corner| corners[corner as usize].map(f64::from)));
        }
    }

    fn add_triangle(&mut self, triangle: [[f64; 3]; 3]) {
        each_crossing(self.cell_m, triangle, &mut |crossing| self.crossings.push(crossing));
    }

    /// The crossings so far, in no order.
    pub(super) fn into_crossings(self) -> Vec<Crossing> {
        self.crossings
    }

    /// Adds crossings of triangles that were added to other columns of the same grid.
    pub(super) fn join(&mut self, crossings: impl Iterator<Item = Crossing>) {
        self.crossings.extend(crossings);
    }

    /// Whether a triangle, its corners in metres, is met by the line through the centre of any cell with this side in metres.
    pub(super) fn meet(cell_m: f64, triangle: [[f64; 3]; 3]) -> bool {
        let mut is_met = false;
        each_crossing(cell_m, triangle, &mut |_| is_met = true);
        is_met
    }

    /// The air in all columns, by cell and from below.
    pub fn into_gaps(mut self) -> Vec<Gap> {
        let by_height = |a: &Crossing, b: &Crossing| {
            a.cell.cmp(&b.cell).then(a.z_m.total_cmp(&b.z_m)).then(a.is_entry.cmp(&b.is_entry))
        };
        self.crossings.sort_unstable_by(by_height);
        let mut gaps = Vec::new();
        for column in self.crossings.chunk_by(|a, b| a.cell == b.cell) {
            // Every line begins in the rock.
            let (mut solids, mut floor_m) = (1, f32::NEG_INFINITY);
            for Crossing { cell, z_m, is_entry } in column.iter().copied() {
                if is_entry && solids == 0 && z_m > floor_m {
                    gaps.push(Gap { cell, floor_m, ceiling_m: z_m });
                }
                solids += if is_entry { 1 } else { -1 };
                if !is_entry && solids == 0 {
                    floor_m = z_m;
                }
            }
        }
        gaps
    }
}

fn each_crossing(cell_m: f64, [a, b, c]: [[f64; 3]; 3], found: &mut impl FnMut(Crossing)) {
    let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if twice_area == 0.0 {
        return;
    }
    // On the map all are taken counter-clockwise, so that where the surface folds both sides hit the same centres.
    let is_entry = twice_area < 0.0;
    let [b, c] = if is_entry { [c, b] } else { [b, c] };
    let bound = |axis: usize, of: fn(f64, f64) -> f64| of(of(a[axis], b[axis]), c[axis]) / cell_m;
    let first = [0, 1].map(|axis| (bound(axis, f64::min) - 0.5).floor() as i32);
    let last = [0, 1].map(|axis| (bound(axis, f64::max) - 0.5).ceil() as i32);
    for j in first[1]..=last[1] {
        for i in first[0]..=last[0] {
            let centre = [i, j].map(|n| (f64::from(n) + 0.5) * cell_m);
            let [of_a, of_b, of_c] = [side(b, c, centre), side(c, a, centre), side(a, b, centre)];
            let is_inside = holds(of_a, b, c) && holds(of_b, c, a) && holds(of_c, a, b);
            if is_inside {
                let z = (a[2] * of_a + b[2] * of_b + c[2] * of_c) / (of_a + of_b + of_c);
                found(Crossing { cell: [i, j], z_m: z as f32, is_entry });
            }
        }
    }
}

/// On which side of an edge a point of the map is: positive on the left. The same number with the other sign for the same edge
/// the other way round, to the last bit.
pub(super) fn side(from: [f64; 3], to: [f64; 3], [x, y]: [f64; 2]) -> f64 {
    if (to[0], to[1]) < (from[0], from[1]) {
        return -side(to, from, [x, y]);
    }
    (to[0] - from[0]) * (y - from[1]) - (to[1] - from[1]) * (x - from[0])
}

/// Whether a triangle on the left of an edge holds a point on this side of it. Points on an edge or a corner belong to one of
/// the triangles around it, as if they were moved a little to the left, and far less downwards.
pub(super) fn holds(side: f64, from: [f64; 3], to: [f64; 3]) -> bool {
    side > 0.0 || side == 0.0 && (to[1] > from[1] || to[1] == from[1] && to[0] < from[0])
}
