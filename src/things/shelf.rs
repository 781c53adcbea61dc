//! All shapes side by side, as a field to be meshed and a surface to be baked.

use std::sync::Arc;

use nalgebra::Vector3;

use super::halls::Hall;
use super::kind::{KindRow, Kinds, Shape, Shapes};
use super::replica::Replica;
use crate::field::{Aabb, Field, Region, Surface, Texel};
use crate::material::{
    BLOCK, CoarseBlock, Footprint, Ground, Look, Material, Sites, SurfaceSamples, by_axis, roughness,
};
use crate::noise::Source;
use plume_graph::rng::Rng;
use plume_graph::seed::{salt, stream};

/// Side of the cube that each shape has for itself, in metres.
pub(super) const CELL_M: f32 = 1.0;
/// Shapes in a row of the shelf.
pub(super) const ROW: usize = 8;
/// The first slot of solids and of models.
pub(super) const SOLIDS: usize = 1 << 10;
/// Side of the cube that each solid or model has for itself, in metres: those cubes are in the second layer.
const HALL_M: f32 = 4.4;
/// Solids in a row.
const HALLS: usize = 4;
/// Height from which on the slots are those of solids, in metres.
const SOLIDS_M: f32 = 0.5 * HALL_M;
/// How far noise roughens a shape, in metres. Tuned.
const ROUGH_M: f32 = 0.006;
/// Distance from the surface beyond which there is no noise, in metres: it could not move the surface.
const NEAR_M: f32 = 0.04;
/// Wavelength of that noise in metres.
const ROUGH_LENGTH_M: f32 = 0.06;
/// Lipschitz constant of a shape with its noise. Tuned: `prototypes_are_closed` holds for twice as many shapes.
const STEEPEST: f32 = 1.8;
/// Largest distance from the middle of a cell at which a shape may be, in metres.
const REACH_M: f32 = 0.46;
/// Upward component of the normal from which on dust lies on something, and at which there is most of it. Tuned.
const DUSTY: [f32; 2] = [0.45, 0.9];
/// How far below the middle of a stone the floor has soiled it, in metres: from nothing to most. Tuned.
const SOILED_M: [f32; 2] = [0.03, 0.10];
/// Most of the colour of the floor on a stone. Tuned.
const MOST_DUST: f32 = 0.7;

/// What the shapes are made of.
pub struct Dress<'a> {
    /// The kinds that occur.
    pub kinds: Kinds<'a>,
    /// The models of those kinds that are model files, in their order.
    pub replicas: &'a [Arc<Replica>],
    /// The rock with one setting replaced, or as it is.
    pub material: &'a dyn Fn(Option<(&'static str, f64)>) -> Arc<dyn Material>,
    /// Its look.
    pub look: &'a Look,
    /// The seed of the cave.
    pub seed: u64,
}

/// All shapes that occur in a rock.
pub struct Shelf {
    slots: Vec<Slot>,
    pub(super) halls: Vec<Hall>,
    /// The rock as it is.
    material: Arc<dyn Material>,
    look: Look,
    pub(super) source: Source,
}

/// A shape on the shelf.
struct Slot {
    shape: Shape,
    material: Arc<dyn Material>,
    is_loose: bool,
    look: Look,
}

/// Humidity of loose stones, given that of the wall: dry until half of the wall is wet, since the copies of a stone in a streak of
/// water would shine wherever they lie.
fn humidity_of_stones(humidity: f32) -> f32 {
    (2.0 * humidity - 1.0).max(0.0)
}

/// Humidity of what hangs, given that of the wall: it hangs where water drips.
fn humidity_of_dripstone(humidity: f32) -> f32 {
    let dry = 1.0 - humidity;
    1.0 - dry * dry * dry
}

impl Shelf {
    /// The shelf of this rock. The shapes are the same for every seed.
    pub fn new(dress: &Dress) -> Self {
        let (mut fields, mut halls) = (Vec::new(), Vec::new());
        let mut replicas = dress.replicas.iter().cloned();
        let material = (dress.material)(None);
        let (wall, is_crusted) = (dress.look.humidity, material.is_crusted_by_drips());
        for (_, row, number) in slots(dress.kinds) {
            let mut rng = Rng::new(stream(0, row.name, u64::from(number)));
            let is_loose = row.place.is_loose();
            let humidity = match is_loose {
                true => humidity_of_stones(wall),
                false if is_crusted => humidity_of_dripstone(wall),
                false => wall,
            };
            let look = Look { humidity, ..dress.look.clone() };
            match row.shapes {
                Shapes::Own { make, .. } => {
                    let material = (dress.material)(row.rock_setting);
                    fields.push(Slot { shape: make(&mut rng), material, is_loose, look });
                }
                Shapes::Solid { make, .. } => halls.push(Hall::Solid(make(&mut rng))),
                Shapes::File => halls.extend(replicas.next().map(Hall::Replica)),
                Shapes::Of(_) => {}
            }
        }
        Self {
            slots: fields,
            halls,
            material,
            look: dress.look.clone(),
            source: Source::new(salt(dress.seed, "things")),
        }
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.slots.len() + self.halls.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The box of all shapes.
    pub fn bounds(&self) -> Aabb<f32> {
        let rows = self.slots.len().div_ceil(ROW);
        Aabb { min: [0.0; 3], max: [ROW as f32 * CELL_M, rows as f32 * CELL_M, CELL_M] }
    }

    /// Upper bound of the depth of a point in the shape that is in the slot of `origin`, wherever the point is, without noise: its depth
    /// where it is not far from it. `None` for solids and models.
    pub(super) fn shape_at(&self, origin: [f32; 3], point: [f32; 3]) -> Option<f32> {
        let slot = slot_at(origin)?;
        let nearest = within_reach(slot, point);
        let local = std::array::from_fn(|axis| nearest[axis] - middle_of(slot)[axis]);
        let depth_m = (self.slots.get(slot)?.shape)(local);
        let beyond_m = (Vector3::from(point) - Vector3::from(nearest)).norm();
        // The way from the nearest point of the cube to the shape leads away from this point, or at a right angle to that.
        Some(if beyond_m > 0.0 { -libm::hypotf(beyond_m, depth_m.min(0.0)) } else { depth_m })
    }

    /// Where the surface near a point is that of the shape in the slot of `origin`: at the point, or where it is nearest to it.
    pub(super) fn surface_at(&self, origin: [f32; 3], point: [f32; 3]) -> [f32; 3] {
        let slot = slot_at(origin).filter(|slot| *slot < self.slots.len());
        slot.map_or(point, |slot| within_reach(slot, point))
    }

    /// The slot at a point, and the point relative to its middle.
    fn local(&self, point: [f32; 3]) -> Option<(&Slot, [f32; 3])> {
        let slot = self.slots.get(slot_at(point)?)?;
        let middle = middle_of(slot_at(point)?);
        Some((slot, std::array::from_fn(|axis| point[axis] - middle[axis])))
    }

    /// The field without noise.
    fn plain(&self, point: [f32; 3]) -> f32 {
        let Some((slot, local)) = self.local(point) else { return -CELL_M };
        let beyond = local.iter().fold(0.0, |most: f32, c| most.max(c.abs() - REACH_M));
        // Within reach of the next shape there is only air.
        if beyond > 0.0 { -0.04 - beyond } else { (slot.shape)(local) }
    }
}

/// A slot of the shelf, the kind whose shape is there, and the number of that. Solids and models have slots of their own, far from
/// those of fields.
pub(super) fn slots<'a>(kinds: Kinds<'a>) -> impl Iterator<Item = (usize, KindRow<'a>, u32)> {
    let rows: Vec<KindRow<'a>> = kinds.rows().collect();
    let numbered = |first: usize, count: fn(&KindRow) -> u32| {
        let of_row = move |row: KindRow<'a>| (0..count(&row)).map(move |number| (row, number));
        let all = rows.clone().into_iter().flat_map(of_row).enumerate();
        all.map(move |(slot, (row, number))| (first + slot, row, number))
    };
    let fields = |row: &KindRow| if let Shapes::Own { count, .. } = row.shapes { count } else { 0 };
    let solids = |row: &KindRow| match row.shapes {
        Shapes::Solid { count, .. } => count,
        Shapes::File => 1,
        _ => 0,
    };
    numbered(0, fields).chain(numbered(SOLIDS, solids))
}

/// The slot of a point in the box of the shelf.
pub(super) fn slot_at(point: [f32; 3]) -> Option<usize> {
    let (cell_m, row, first) = if point[2] < SOLIDS_M { (CELL_M, ROW, 0) } else { (HALL_M, HALLS, SOLIDS) };
    let [x, y, z] = point.map(|c| (c / cell_m).floor() as i32);
    let is_inside = (0..row as i32).contains(&x) && y >= 0 && z == i32::from(first > 0);
    is_inside.then(|| first + y as usize * row + x as usize)
}

/// The middle of a slot, which is the origin of its shape.
pub(super) fn middle_of(slot: usize) -> [f32; 3] {
    let (cell_m, row, z, slot) =
        if slot < SOLIDS { (CELL_M, ROW, 0.5, slot) } else { (HALL_M, HALLS, 1.5, slot - SOLIDS) };
    [(slot % row) as f32 + 0.5, (slot / row) as f32 + 0.5, z].map(|c| c * cell_m)
}

/// The point of the cube around a shape that is nearest to a point.
fn within_reach(slot: usize, point: [f32; 3]) -> [f32; 3] {
    let middle = middle_of(slot);
    std::array::from_fn(|axis| point[axis].clamp(middle[axis] - REACH_M, middle[axis] + REACH_M))
}

impl Field for Shelf {
    fn region(&self, bounds: Aabb<f32>) -> Region {
        let (centre, radius_m) =
            (bounds.center(), 0.5 * libm::sqrtf(bounds.size().map(|side| side * side).iter().sum()));
        // Between cells the field jumps, from air to air.
        let cell = |corner: [f32; 3], inwards: f32| corner.map(|c| ((c + inwards) / CELL_M).floor());
        let crosses = cell(bounds.min, 1e-3) != cell(bounds.max, -1e-3);
        let value = self.plain(centre);
        match value {
            deep if !crosses && deep < -radius_m * STEEPEST - ROUGH_M => Region::Air,
            high if !crosses && high > radius_m * STEEPEST + ROUGH_M => Region::Rock,
            _ => Region::Mixed,
        }
    }

    fn distances(&self, _: Aabb<f32>, points: &[[f32; 3]], out: &mut [f32]) {
        for (out, &point) in out.iter_mut().zip(points) {
            *out = self.plain(point);
        }
        let near: Vec<usize> = (0..out.len()).filter(|&n| out[n].abs() < NEAR_M).collect();
        let points: Vec<[f32; 3]> = near.iter().map(|&n| points[n]).collect();
        for (n, rough) in near.into_iter().zip(roughness(self.source, &points, ROUGH_LENGTH_M)) {
            out[n] += ROUGH_M * rough.clamp(-1.0, 1.0);
        }
    }

    fn normals(&self, bounds: Aabb<f32>, points: &[[f32; 3]], out: &mut [[f32; 3]]) {
        /// Step of the central differences.
        const STEP_M: f32 = 1.0 / 256.0;
        let moved = |axis: usize, by: f32| -> Vec<f32> {
            let points: Vec<[f32; 3]> = points
                .iter()
                .map(|point| {
                    let mut moved = *point;
                    moved[axis] += by;
                    moved
                })
                .collect();
            let mut values = vec![0.0; points.len()];
            self.distances(bounds, &points, &mut values);
            values
        };
        let sides = [0, 1, 2].map(|axis| [moved(axis, -STEP_M), moved(axis, STEP_M)]);
        for (n, out) in out.iter_mut().enumerate() {
            let descent = sides.each_ref().map(|[low, high]| low[n] - high[n]);
            let length = descent.iter().map(|c| c * c).sum::<f32>().sqrt();
            *out = if length > 0.0 { descent.map(|c| c / length) } else { [0.0, 0.0, 1.0] };
        }
    }
}

impl Surface for Shelf {
    fn texels(&self, _: Aabb<f32>, texel_m: f32, points: &[[f32; 3]], normals: &[[f32; 3]], out: &mut [Texel]) {
        let mut block = CoarseBlock::new(GROUND, self.source);
        let is_used = |slot: &usize| *slot < self.slots.len() || self.hall(*slot).is_some();
        let slot = |at: usize| slot_at(points[at]).filter(is_used);
        let mut start = 0;
        while start < points.len() {
            let end =
                (start..points.len().min(start + BLOCK)).take_while(|&at| slot(at) == slot(start)).count() + start;
            let range = start..end;
            if let Some(slot) = slot(start) {
                let at = [&points[range.clone()], &normals[range.clone()]];
                match slot < SOLIDS {
                    true => self.paint(slot, texel_m, at, &mut block, &mut out[range]),
                    false => self.paint_hall(slot, texel_m, at, &mut out[range]),
                }
            }
            start = end;
        }
        self.soil(texel_m, points, normals, &mut block, out);
    }
}

/// The floor on which the dust of stones is computed: it is bare.
const GROUND: Ground = Ground { roughness_m: 0.0, natural: 0.0 };

impl Shelf {
    /// The surface of at most [`BLOCK`] points of a slot, with their normals: that of the wall.
    fn paint(&self, slot: usize, texel_m: f32, at: [&[[f32; 3]]; 2], block: &mut CoarseBlock, out: &mut [Texel]) {
        let [points, normals] = at;
        let Slot { material, look, .. } = &self.slots[slot];
        let mut wall = SurfaceSamples::default();
        let columns = by_axis(normals);
        material.coarse(&on_wall(points, normals, self.source), block);
        block.shape_as(&columns);
        material.surface_samples(block, look, Footprint { texel_m }, &columns, &mut wall);
        for (lane, texel) in out.iter_mut().enumerate() {
            *texel = Texel {
                color: wall.color.map(|column| column[lane]),
                normal: wall.normal.map(|column| column[lane]),
                roughness: wall.roughness[lane],
                occlusion: wall.occlusion[lane],
                height_m: 0.0,
            };
        }
    }

    /// Share of the floor's colour at a point: where dust has settled, and on stones also where the floor is near.
    fn soil_at(&self, point: [f32; 3], normal: [f32; 3]) -> f32 {
        let between = |[low, high]: [f32; 2], x: f32| ((x - low) / (high - low)).clamp(0.0, 1.0);
        let Some(slot) = slot_at(point) else { return 0.0 };
        let near_floor = match (self.slots.get(slot), self.hall(slot)) {
            (Some(Slot { is_loose: true, .. }), _) => between(SOILED_M, 0.5 * CELL_M - point[2].rem_euclid(CELL_M)),
            (_, Some(Hall::Solid(_))) => 0.0,
            _ => return 0.0,
        };
        MOST_DUST * between(DUSTY, normal[2]).max(near_floor)
    }

    /// Soils what lies or stands about with the floor: in full blocks of the points that it soils, wherever they are.
    fn soil(
        &self,
        texel_m: f32,
        points: &[[f32; 3]],
        normals: &[[f32; 3]],
        block: &mut CoarseBlock,
        out: &mut [Texel],
    ) {
        let share = |at: usize| self.soil_at(points[at], normals[at]);
        let soiled: Vec<(usize, f32)> =
            (0..points.len()).map(|at| (at, share(at))).filter(|(_, share)| *share > 0.0).collect();
        let look = Look { humidity: humidity_of_stones(self.look.humidity), ..self.look.clone() };
        let mut floor = SurfaceSamples::default();
        for soiled in soiled.chunks(BLOCK) {
            let of = |all: &[[f32; 3]]| soiled.iter().map(|&(at, _)| all[at]).collect::<Vec<_>>();
            let columns = by_axis(&of(normals));
            self.material.coarse(&on_floor(&of(points), self.source), block);
            self.material.surface_samples(block, &look, Footprint { texel_m }, &columns, &mut floor);
            for (lane, &(at, share)) in soiled.iter().enumerate() {
                let texel = &mut out[at];
                let mixed = |wall: f32, floor: f32| wall + (floor - wall) * share;
                texel.color = std::array::from_fn(|channel| mixed(texel.color[channel], floor.color[channel][lane]));
                texel.roughness = mixed(texel.roughness, floor.roughness[lane]);
            }
        }
    }
}

/// Sites on the wall of a wide passage, high above its floor.
fn on_wall(points: &[[f32; 3]], normals: &[[f32; 3]], source: Source) -> Sites {
    let mut sites = Sites::new(GROUND, source);
    sites.place(points);
    let columns = by_axis(normals);
    for (gradient, normal) in sites.wall.gradient.iter_mut().zip(columns) {
        *gradient = normal.map(|c| -c);
    }
    sites.height.value.fill(3.0);
    sites.height.gradient[2].fill(1.0);
    sites.half_width.value.fill(2.0);
    sites
}

/// Sites on the floor of a wide passage.
fn on_floor(points: &[[f32; 3]], source: Source) -> Sites {
    let mut sites = Sites::new(GROUND, source);
    sites.place(points);
    sites.wall.value.fill(-2.0);
    sites.wall.gradient[2].fill(1.0);
    sites.height.gradient[2].fill(1.0);
    sites.up.value.fill(-1.0);
    sites.half_width.value.fill(2.0);
    sites
}
