//! Rays through one point that are close to each other, and what all of them may meet.
//!
//! They are followed together, by the pyramid around them (Reshetov, Soupikov and Hurley, "Multi-level ray tracing algorithm", 2005;
//! Wald, Boulos and Shirley, "Ray tracing deformable scenes using dynamic bounding volume hierarchies", 2007): a box is opened once
//! for all, and a triangle is tested only for the rays that pass the rectangle around its image. Pyramids and rectangles leave out
//! nothing that a ray of its own would meet, so what comes of it is the same to the last bit, and for every width of vectors.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};
use nalgebra::{Point3, Vector3};
use obvhs::cwbvh::BRANCHING;
use obvhs::cwbvh::node::CwBvhNode;

use super::triangle::{Shear, Triangle};
use super::{Hit, World, slack};

/// Most rays of a bundle.
const MOST: usize = 64;
/// Rays, or boxes, that are compared at once.
const LANES: usize = 8;
/// The least cosine between a ray and the axis of its pyramid; where they are farther apart, the rays are parted.
const LEAST_COSINE: f64 = 0.7;
/// More than rounding makes of slopes, which are about 1 at the most, in single precision.
const SLOPE_SLACK: f64 = 1e-6;
/// Corners that are not farther ahead than this have no image, in metres.
const NEAR_M: f64 = 1e-3;
/// The end of a ray for which nothing else matters.
const NOTHING_MORE: f64 = f64::NEG_INFINITY;

impl World {
    /// The nearest surface on each ray from one point, closer than `most` lengths of its direction.
    pub fn hits(&self, origin: &Point3<f64>, directions: &[Vector3<f64>], most: f64) -> Vec<Option<Hit>> {
        self.hits_by(Level::new(), origin, directions, most)
    }

    /// Which of these places a lamp does not reach.
    pub fn shaded(&self, lamp: &Point3<f64>, places: &[Point3<f64>]) -> Vec<bool> {
        self.shaded_by(Level::new(), lamp, places)
    }

    fn hits_by(&self, level: Level, origin: &Point3<f64>, rays: &[Vector3<f64>], most: f64) -> Vec<Option<Hit>> {
        let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
        let sheared: Vec<Shear> = rays.iter().map(Shear::along).collect();
        let meet = |ray: usize, place: usize| {
            let (distance, weights) = sheared[ray].meet(origin, &self.triangles[place])?;
            let hit = Hit { distance, face: self.boxes.primitive_indices[place], weights };
            (distance <= most && hit.precedes(hits[ray])).then(|| {
                hits[ray] = Some(hit);
                distance
            })
        };
        self.follow_all(level, origin, rays, most, meet);
        hits
    }

    fn shaded_by(&self, level: Level, lamp: &Point3<f64>, places: &[Point3<f64>]) -> Vec<bool> {
        let mut shaded = vec![false; places.len()];
        let rays: Vec<Vector3<f64>> = places.iter().map(|place| place - lamp).collect();
        let sheared: Vec<Shear> = rays.iter().map(|ray| Shear::along(&-ray)).collect();
        let meet = |ray: usize, place: usize| {
            let (distance, _) = sheared[ray].meet(&places[ray], &self.triangles[place])?;
            (distance <= 1.0).then(|| {
                shaded[ray] = true;
                NOTHING_MORE
            })
        };
        self.follow_all(level, lamp, &rays, 1.0, meet);
        shaded
    }

    /// Lets rays from an apex meet the triangles that may be before their ends, by number of the ray and place of the triangle, roughly
    /// from near to far. A ray ends after `most` lengths of its direction, or where `meet` tells it to.
    fn follow_all(
        &self,
        level: Level,
        apex: &Point3<f64>,
        rays: &[Vector3<f64>],
        most: f64,
        mut meet: impl FnMut(usize, usize) -> Option<f64>,
    ) {
        if self.boxes.nodes.is_empty() {
            return;
        }
        for bundle in bundles(apex, rays) {
            dispatch!(level, simd => self.follow(simd, &bundle, most, &mut meet));
        }
    }

    #[inline(always)]
    fn follow<S: Simd>(&self, simd: S, bundle: &Bundle, most: f64, meet: &mut impl FnMut(usize, usize) -> Option<f64>) {
        let mut ends = Ends::of(bundle, most);
        let mut far = ends.furthest(simd);
        let mut ahead = vec![(0.0, Part::Node(0))];
        while let Some((near, part)) = ahead.pop() {
            if near > far {
                continue;
            }
            let (first, count) = match part {
                Part::Node(index) => {
                    open(simd, &self.boxes.nodes[index as usize], bundle, far, &mut ahead);
                    continue;
                }
                Part::Leaf(first, count) => (first as usize, count as usize),
            };
            let mut has_moved = false;
            for place in first..first + count {
                let Some(image) = bundle.image(&self.triangles[place]) else { continue };
                let mut left = bundle.through(simd, &image, &ends);
                while left != 0 {
                    let ray = left.trailing_zeros() as usize;
                    left &= left - 1;
                    if let Some(end) = meet(bundle.numbers[ray], place) {
                        ends.0[ray] = slack(end * bundle.depths[ray]);
                        has_moved = true;
                    }
                }
            }
            if has_moved {
                far = ends.furthest(simd);
            }
        }
    }
}

/// Adds the children of a node that a bundle may meet, the nearest last.
#[inline(always)]
fn open<S: Simd>(simd: S, node: &CwBvhNode, bundle: &Bundle, far: f32, ahead: &mut Vec<(f32, Part)>) {
    let first = ahead.len();
    let (seen, near) = bundle.boxes(simd, node, far);
    for child in (0..BRANCHING).filter(|child| seen >> child & 1 == 1 && !node.is_child_empty(*child)) {
        let part = match node.is_leaf(child) {
            true => {
                let (first, count) = node.child_primitives(child);
                Part::Leaf(first, count)
            }
            false => Part::Node(node.child_node_index(child)),
        };
        // Few, so the simplest way to sort them is the fastest.
        let nearer = ahead[first..].iter().take_while(|(other, _)| *other >= near[child]).count();
        ahead.insert(first + nearer, (near[child], part));
    }
}

/// A part of the hierarchy of boxes.
#[derive(Clone, Copy)]
enum Part {
    Node(u32),
    /// The place of its first triangle, and how many there are.
    Leaf(u32, u32),
}

/// How far ahead each ray of a bundle ends, or a little farther; where there is no ray, nowhere.
struct Ends([f32; MOST]);

impl Ends {
    fn of(bundle: &Bundle, most: f64) -> Self {
        let mut ends = [f32::NEG_INFINITY; MOST];
        ends.iter_mut().zip(&bundle.depths).for_each(|(end, depth)| *end = slack(depth * most));
        Self(ends)
    }

    #[inline(always)]
    fn furthest<S: Simd>(&self, simd: S) -> f32 {
        let eight = self.0.as_chunks::<LANES>().0.iter().map(|ends| f32x8::from_slice(simd, ends));
        let largest = eight.fold(f32x8::splat(simd, f32::NEG_INFINITY), |all, ends| all.max(ends));
        largest.as_slice().iter().copied().fold(f32::NEG_INFINITY, f32::max)
    }
}

/// Rays on lines through an apex, and the pyramid around them.
struct Bundle {
    apex: Point3<f64>,
    /// Across, up and ahead: the frame of the pyramid.
    axes: [Vector3<f64>; 3],
    /// Which rays they are.
    numbers: Vec<usize>,
    /// How far ahead each gets with a length of its direction.
    depths: Vec<f64>,
    /// How far across and up each gets with a length ahead; zero where there is no ray.
    slopes: [[f32; MOST]; 2],
    /// The least and the greatest of them.
    window: [[f64; 2]; 2],
    /// Its direction, and the inward normals of its sides.
    ahead: [f32; 3],
    sides: [[f32; 3]; 4],
}

/// What a triangle looks like from the apex.
struct Image {
    /// How far ahead its nearest corner is.
    near: f64,
    /// The rectangle of slopes around it.
    window: [[f64; 2]; 2],
}

/// Parts rays into bundles that are narrow enough.
fn bundles(apex: &Point3<f64>, rays: &[Vector3<f64>]) -> Vec<Bundle> {
    let mut found = Vec::new();
    let mut parts: Vec<Vec<usize>> = vec![(0..rays.len()).collect()];
    while let Some(mut numbers) = parts.pop() {
        match Bundle::of(apex, rays, numbers.as_slice()) {
            Some(bundle) => found.push(bundle),
            // A ray without a direction meets nothing.
            None if numbers.len() < 2 => {}
            None => {
                parts.push(numbers.split_off(numbers.len() / 2));
                parts.push(numbers);
            }
        }
    }
    found
}

impl Bundle {
    /// The bundle of some of the rays with these directions; `None` if they are too many, or too far apart.
    fn of(apex: &Point3<f64>, directions: &[Vector3<f64>], numbers: &[usize]) -> Option<Self> {
        if numbers.len() > MOST {
            return None;
        }
        let middle: Vector3<f64> = numbers.iter().map(|number| directions[*number].normalize()).sum();
        let axes = frame(&middle.try_normalize(1e-9)?);
        let mut depths = Vec::with_capacity(numbers.len());
        let mut slopes = [[0.0; MOST]; 2];
        let mut window = NOTHING;
        for (ray, direction) in numbers.iter().map(|number| &directions[*number]).enumerate() {
            let [across, up, depth] = [0, 1, 2].map(|axis| axes[axis].dot(direction));
            if depth < LEAST_COSINE * direction.norm() {
                return None;
            }
            let slope = [across / depth, up / depth];
            widen(&mut window, slope);
            depths.push(depth);
            (0..2).for_each(|axis| slopes[axis][ray] = slope[axis] as f32);
        }
        let [low, high] = window;
        let [across, up, ahead] = axes;
        let sides = [across - ahead * low[0], ahead * high[0] - across, up - ahead * low[1], ahead * high[1] - up];
        let single = |vector: Vector3<f64>| vector.normalize().cast::<f32>().into();
        Some(Self {
            apex: *apex,
            axes,
            numbers: numbers.to_vec(),
            depths,
            slopes,
            window,
            ahead: single(ahead),
            sides: sides.map(single),
        })
    }

    /// Which of the boxes in a node it may meet, a bit each, and how far ahead they begin. Left out is what is wholly beside, behind or
    /// too far. Boxes are larger than what they hold by more than single precision makes of this.
    #[inline(always)]
    fn boxes<S: Simd>(&self, simd: S, node: &CwBvhNode, far: f32) -> (u64, [f32; LANES]) {
        let [p, extent] = [<[f32; 3]>::from(node.p), node.compute_extent().to_array()];
        let low = [&node.child_min_x, &node.child_min_y, &node.child_min_z];
        let high = [&node.child_max_x, &node.child_max_y, &node.child_max_z];
        let mut middle = [f32x8::splat(simd, 0.0); 3];
        let mut half = middle;
        for axis in 0..3 {
            let from = f32x8::splat(simd, p[axis] - self.apex[axis] as f32);
            let scale = f32x8::splat(simd, 0.5 * extent[axis]);
            let [low, high] = [eight(simd, low[axis]), eight(simd, high[axis])];
            middle[axis] = from + (low + high) * scale;
            half[axis] = (high - low) * scale;
        }
        let zero = f32x8::splat(simd, 0.0);
        let [begin, end] = span(simd, &self.ahead, &middle, &half);
        let mut seen = begin.simd_le(f32x8::splat(simd, far)) & end.simd_ge(zero);
        for side in &self.sides {
            seen &= span(simd, side, &middle, &half)[1].simd_ge(zero);
        }
        let mut near = [0.0; LANES];
        near.copy_from_slice(begin.as_slice());
        (seen.to_bitmask(), near)
    }

    /// What a triangle looks like; `None` if no ray can meet it.
    #[inline(always)]
    fn image(&self, triangle: &Triangle) -> Option<Image> {
        let [mut near, mut far] = [f64::INFINITY, f64::NEG_INFINITY];
        let mut window = NOTHING;
        for corner in triangle {
            let from = Vector3::from(corner.map(f64::from)) - self.apex.coords;
            let [across, up, depth] = [self.axes[0].dot(&from), self.axes[1].dot(&from), self.axes[2].dot(&from)];
            near = near.min(depth);
            far = far.max(depth);
            widen(&mut window, [across / depth, up / depth]);
        }
        if near < NEAR_M {
            return (far >= 0.0).then_some(Image { near: near.min(0.0), window: self.window });
        }
        let [low, high] = &mut window;
        low.iter_mut().for_each(|slope| *slope -= SLOPE_SLACK);
        high.iter_mut().for_each(|slope| *slope += SLOPE_SLACK);
        let is_seen = (0..2).all(|axis| low[axis] <= self.window[1][axis] && high[axis] >= self.window[0][axis]);
        is_seen.then_some(Image { near, window })
    }

    /// The rays, a bit each, that pass the rectangle around an image and do not end before it.
    #[inline(always)]
    fn through<S: Simd>(&self, simd: S, image: &Image, ends: &Ends) -> u64 {
        let splat = |value: f64| f32x8::splat(simd, value as f32);
        let [low, high] = image.window.map(|slopes| slopes.map(splat));
        let near = splat(image.near);
        let mut rays = 0;
        for first in (0..MOST).step_by(LANES) {
            let [across, up] = [0, 1].map(|axis| f32x8::from_slice(simd, &self.slopes[axis][first..first + LANES]));
            let end = f32x8::from_slice(simd, &ends.0[first..first + LANES]);
            let is_inside = low[0].simd_le(across) & across.simd_le(high[0]) & low[1].simd_le(up) & up.simd_le(high[1]);
            rays |= (is_inside & near.simd_le(end)).to_bitmask() << first;
        }
        rays
    }
}

/// From where to where boxes reach along a direction.
#[inline(always)]
fn span<S: Simd>(simd: S, direction: &[f32; 3], middle: &[f32x8<S>; 3], half: &[f32x8<S>; 3]) -> [f32x8<S>; 2] {
    let [mut place, mut reach] = [f32x8::splat(simd, 0.0); 2];
    for axis in 0..3 {
        place += middle[axis] * f32x8::splat(simd, direction[axis]);
        reach += half[axis] * f32x8::splat(simd, direction[axis].abs());
    }
    [place - reach, place + reach]
}

/// Eight bytes as numbers.
#[inline(always)]
fn eight<S: Simd>(simd: S, bytes: &[u8; LANES]) -> f32x8<S> {
    let mut numbers = [0.0; LANES];
    for lane in 0..LANES {
        numbers[lane] = f32::from(bytes[lane]);
    }
    f32x8::from_slice(simd, &numbers)
}

/// No slopes at all.
const NOTHING: [[f64; 2]; 2] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];

/// Directions across, up and along an axis of length 1.
fn frame(ahead: &Vector3<f64>) -> [Vector3<f64>; 3] {
    let mut beside = Vector3::zeros();
    beside[ahead.iamin()] = 1.0;
    let across = beside.cross(ahead).normalize();
    [across, ahead.cross(&across), *ahead]
}

#[inline(always)]
fn widen([low, high]: &mut [[f64; 2]; 2], slope: [f64; 2]) {
    for axis in 0..2 {
        low[axis] = low[axis].min(slope[axis]);
        high[axis] = high[axis].max(slope[axis]);
    }
}

#[cfg(test)]
mod tests {
    use plume_graph::rng::Rng;
    use plume_graph::seed::stream;

    use super::*;

    /// Triangles of all sizes within ten metres of a place, also around its middle and behind it.
    fn soup(rng: &mut Rng, middle: [f32; 3]) -> World {
        let mut world = World::default();
        for face in 0..400_u32 {
            let size = libm::exp2(rng.between(-4.0, 2.5));
            let corner: [f64; 3] = std::array::from_fn(|_| rng.between(-10.0, 10.0));
            for _ in 0..3 {
                let offset: [f64; 3] = std::array::from_fn(|_| rng.between(-size, size));
                world.corners.push([0, 1, 2].map(|axis| middle[axis] + (corner[axis] + offset[axis]) as f32));
            }
            world.faces.push([0, 1, 2].map(|corner| 3 * face + corner));
        }
        world.build();
        world
    }

    /// Rays around a direction, which differ by up to a slope.
    fn rays(rng: &mut Rng, slope: f64) -> Vec<Vector3<f64>> {
        let some = |rng: &mut Rng, most: f64| Vector3::from_fn(|_, _| rng.between(-most, most));
        let ahead = some(rng, 1.0).normalize();
        (0..64).map(|_| (ahead + some(rng, slope)).normalize()).collect()
    }

    fn each_soup(mut each: impl FnMut(&World, &Point3<f64>, &mut Rng, f64)) {
        for seed in 0..40 {
            let mut rng = Rng::new(stream(seed, "soup", 0));
            let middle = [[0.0; 3], [600.0, -40.0, 7.0]][seed as usize % 2];
            let world = soup(&mut rng, middle);
            let origin = Point3::from(middle.map(f64::from)) + rays(&mut rng, 1.0)[0];
            for slope in [0.0, 0.005, 0.05, 0.5, 3.0] {
                each(&world, &origin, &mut rng, slope);
            }
        }
    }

    /// Narrower vectors than those of this machine.
    fn levels() -> Vec<Level> {
        let level = Level::new();
        #[cfg(target_arch = "x86_64")]
        return [level.as_sse2().map(Level::Sse2), level.as_avx2().map(Level::Avx2)].into_iter().flatten().collect();
        #[cfg(not(target_arch = "x86_64"))]
        vec![level]
    }

    fn met(world: &World, origin: &Point3<f64>, ray: &Vector3<f64>, face: u32) -> Option<(f64, [f64; 2])> {
        Shear::along(ray).meet(origin, &world.corners_of(face))
    }

    #[test]
    fn rays_together_end_where_each_alone_does() {
        let (mut rays_with, mut rays_in_all) = (0, 0);
        each_soup(|world, origin, rng, slope| {
            let rays = rays(rng, slope);
            let found = world.hits(origin, &rays, 9.0);
            for level in levels() {
                assert!(found == world.hits_by(level, origin, &rays, 9.0));
            }
            for (ray, found) in rays.iter().zip(found) {
                let hits = (0..world.faces() as u32).filter_map(|face| Some((met(world, origin, ray, face)?.0, face)));
                let nearest = hits.filter(|hit| hit.0 <= 9.0).min_by(|a, b| a.partial_cmp(b).unwrap());
                assert_eq!(found.map(|hit| (hit.distance, hit.face)), nearest, "{slope}");
                assert_eq!(world.hit(origin, ray, 9.0), found);
                rays_with += usize::from(found.is_some());
                rays_in_all += 1;
            }
        });
        assert!(rays_with > rays_in_all / 4, "{rays_with} of {rays_in_all}");
    }

    #[test]
    fn a_place_is_shaded_if_anything_is_between() {
        let (mut dark, mut places_in_all) = (0, 0);
        each_soup(|world, lamp, rng, slope| {
            let places: Vec<Point3<f64>> =
                rays(rng, slope).iter().map(|ray| lamp + ray * rng.between(0.1, 9.0)).collect();
            let shaded = world.shaded(lamp, &places);
            for level in levels() {
                assert!(shaded == world.shaded_by(level, lamp, &places));
            }
            for (place, is_shaded) in places.iter().zip(shaded) {
                let way = lamp - place;
                let is_between = |face| met(world, place, &way, face).is_some_and(|(distance, _)| distance <= 1.0);
                assert_eq!(is_shaded, (0..world.faces() as u32).any(is_between), "{slope}");
                dark += usize::from(is_shaded);
                places_in_all += 1;
            }
        });
        assert!(dark > places_in_all / 10, "{dark} of {places_in_all}");
    }
}
