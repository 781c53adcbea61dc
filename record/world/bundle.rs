//! Rays through one point that are close to each other, and what all of them may meet.
//!
//! They are followed together, by the pyramid around them (Reshetov, Soupikov and Hurley, "Multi-level ray tracing algorithm", 2005;
//! Wald, Boulos and Shirley, "Ray tracing deformable scenes using dynamic bounding volume hierarchies", 2007): a box is opened once
//! for all, and a triangle is tested only for the rays that pass the rectangle around its image. Pyramids and rectangles leave out
//! nothing that a ray of its own would meet, so what comes of it is the same to the last bit.

use glam::Vec3A;
use nalgebra::{Point3, Vector3};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::BRANCHING;

use super::triangle::{Shear, Triangle};
use super::{Hit, World, single, slack};

/// The least cosine between a ray and the axis of its pyramid; where they are farther apart, the rays are parted.
const LEAST_COSINE: f64 = 0.7;
/// More than rounding makes of slopes and depths.
const SLACK: f64 = 1e-9;
/// Corners that are not farther ahead than this have no image, in metres.
const NEAR_M: f64 = 1e-3;
/// The end of a ray for which nothing else matters.
const NOTHING_MORE: f64 = f64::NEG_INFINITY;

impl World {
    /// The nearest surface on each ray from one point, closer than `most` lengths of its direction.
    pub fn hits(&self, origin: &Point3<f64>, directions: &[Vector3<f64>], most: f64) -> Vec<Option<Hit>> {
        let mut hits: Vec<Option<Hit>> = vec![None; directions.len()];
        let sheared: Vec<Shear> = directions.iter().map(Shear::along).collect();
        self.each_bundle(origin, directions, &mut |bundle| {
            self.follow(bundle, most, |ray, place| {
                let (distance, weights) = sheared[ray].meet(origin, &self.triangles[place])?;
                let hit = Hit { distance, face: self.boxes.primitive_indices[place], weights };
                (distance <= most && hit.precedes(hits[ray])).then(|| {
                    hits[ray] = Some(hit);
                    distance
                })
            });
        });
        hits
    }

    /// Which of these places a lamp does not reach.
    pub fn shaded(&self, lamp: &Point3<f64>, places: &[Point3<f64>]) -> Vec<bool> {
        let mut shaded = vec![false; places.len()];
        let directions: Vec<Vector3<f64>> = places.iter().map(|place| place - lamp).collect();
        let sheared: Vec<Shear> = directions.iter().map(|direction| Shear::along(&-direction)).collect();
        self.each_bundle(lamp, &directions, &mut |bundle| {
            self.follow(bundle, 1.0, |ray, place| {
                let (distance, _) = sheared[ray].meet(&places[ray], &self.triangles[place])?;
                (distance <= 1.0).then(|| {
                    shaded[ray] = true;
                    NOTHING_MORE
                })
            });
        });
        shaded
    }

    /// Parts rays into bundles that are narrow enough.
    fn each_bundle(&self, apex: &Point3<f64>, directions: &[Vector3<f64>], each: &mut impl FnMut(&Bundle)) {
        let mut parts: Vec<Vec<usize>> = vec![(0..directions.len()).collect()];
        while let Some(mut numbers) = parts.pop() {
            match Bundle::of(apex, directions, numbers.as_slice()) {
                Some(bundle) => each(&bundle),
                // A ray without a direction meets nothing.
                None if numbers.len() < 2 => {}
                None => {
                    parts.push(numbers.split_off(numbers.len() / 2));
                    parts.push(numbers);
                }
            }
        }
    }

    /// Lets rays of a bundle meet the triangles that may be before their ends, by place and roughly from near to far. A ray ends after
    /// `most` lengths of its direction, or where `meet` tells it to.
    fn follow(&self, bundle: &Bundle, most: f64, mut meet: impl FnMut(usize, usize) -> Option<f64>) {
        if self.boxes.nodes.is_empty() {
            return;
        }
        let mut ends: Vec<f64> = bundle.depths.iter().map(|depth| depth * most).collect();
        let mut far = slack(largest(&ends));
        let mut ahead = vec![(0.0, Part::Node(0))];
        while let Some((near, part)) = ahead.pop() {
            if near > far {
                continue;
            }
            let (first, count) = match part {
                Part::Node(index) => {
                    self.open(index, bundle, far, &mut ahead);
                    continue;
                }
                Part::Leaf(first, count) => (first as usize, count as usize),
            };
            for place in first..first + count {
                let Some(image) = bundle.image(&self.triangles[place]) else { continue };
                for ray in bundle.through(&image) {
                    let is_before = image.near <= ends[ray];
                    if let Some(end) = is_before.then(|| meet(bundle.numbers[ray], place)).flatten() {
                        ends[ray] = end * bundle.depths[ray];
                    }
                }
            }
            far = slack(largest(&ends));
        }
    }

    /// Adds the children of a node that a bundle may meet, the nearest last.
    fn open(&self, index: u32, bundle: &Bundle, far: f32, ahead: &mut Vec<(f32, Part)>) {
        let node = &self.boxes.nodes[index as usize];
        let first = ahead.len();
        for child in (0..BRANCHING).filter(|child| !node.is_child_empty(*child)) {
            let Some(near) = bundle.near(&node.child_aabb(child)).filter(|near| *near <= far) else { continue };
            let part = match node.is_leaf(child) {
                true => {
                    let (first, count) = node.child_primitives(child);
                    Part::Leaf(first, count)
                }
                false => Part::Node(node.child_node_index(child)),
            };
            ahead.push((near, part));
        }
        ahead[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    }
}

/// A part of the hierarchy of boxes.
#[derive(Clone, Copy)]
enum Part {
    Node(u32),
    /// The place of its first triangle, and how many there are.
    Leaf(u32, u32),
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
    /// Across and up for a length ahead.
    slopes: Vec<[f64; 2]>,
    /// The least and the greatest of them.
    window: [[f64; 2]; 2],
    /// The apex, the direction ahead and the inward normals of the sides, for boxes.
    from: Vec3A,
    ahead: Vec3A,
    sides: [Vec3A; 4],
}

/// What a triangle looks like from the apex.
struct Image {
    /// How far ahead its nearest corner is.
    near: f64,
    /// The rectangle of slopes around it.
    window: [[f64; 2]; 2],
}

impl Bundle {
    /// The bundle of some of the rays with these directions; `None` if they are too far apart.
    fn of(apex: &Point3<f64>, directions: &[Vector3<f64>], numbers: &[usize]) -> Option<Self> {
        let middle: Vector3<f64> = numbers.iter().map(|number| directions[*number].normalize()).sum();
        let axes = frame(&middle.try_normalize(1e-9)?);
        let mut depths = Vec::with_capacity(numbers.len());
        let mut slopes = Vec::with_capacity(numbers.len());
        let mut window = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for direction in numbers.iter().map(|number| &directions[*number]) {
            let [across, up, depth] = axes.map(|axis| axis.dot(direction));
            if depth < LEAST_COSINE * direction.norm() {
                return None;
            }
            let slope = [across / depth, up / depth];
            widen(&mut window, slope);
            depths.push(depth);
            slopes.push(slope);
        }
        let [low, high] = window;
        let [across, up, ahead] = axes;
        let sides = [across - ahead * low[0], ahead * high[0] - across, up - ahead * low[1], ahead * high[1] - up];
        Some(Self {
            apex: *apex,
            axes,
            numbers: numbers.to_vec(),
            depths,
            slopes,
            window,
            from: single(&apex.coords),
            ahead: single(&ahead),
            sides: sides.map(|side| single(&side.normalize())),
        })
    }

    /// How far ahead a box begins, if it is not wholly beside or behind. The box is larger than what it holds by more than single
    /// precision makes of this.
    fn near(&self, bounds: &Aabb) -> Option<f32> {
        let [low, high] = [bounds.min - self.from, bounds.max - self.from];
        let most = |along: Vec3A| (along * low).max(along * high).element_sum();
        if self.sides.iter().any(|side| most(*side) < 0.0) || most(self.ahead) < 0.0 {
            return None;
        }
        Some((self.ahead * low).min(self.ahead * high).element_sum())
    }

    /// What a triangle looks like; `None` if no ray can meet it.
    fn image(&self, triangle: &Triangle) -> Option<Image> {
        let corners = triangle.map(|corner| {
            let from = Point3::from(corner.map(f64::from)) - self.apex;
            self.axes.map(|axis| axis.dot(&from))
        });
        let near = corners.iter().map(|corner| corner[2]).fold(f64::INFINITY, f64::min) - SLACK;
        if near < NEAR_M {
            let is_behind = corners.iter().all(|corner| corner[2] < 0.0);
            return (!is_behind).then_some(Image { near, window: self.window });
        }
        let mut window = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        corners.iter().for_each(|[across, up, depth]| widen(&mut window, [across / depth, up / depth]));
        let [low, high] = &mut window;
        low.iter_mut().for_each(|slope| *slope -= SLACK);
        high.iter_mut().for_each(|slope| *slope += SLACK);
        let is_seen = (0..2).all(|axis| low[axis] <= self.window[1][axis] && high[axis] >= self.window[0][axis]);
        is_seen.then_some(Image { near, window })
    }

    /// The rays that pass the rectangle around an image.
    fn through(&self, image: &Image) -> impl Iterator<Item = usize> {
        let [low, high] = image.window;
        let is_inside =
            move |slope: &[f64; 2]| (0..2).all(|axis| low[axis] <= slope[axis] && slope[axis] <= high[axis]);
        self.slopes.iter().enumerate().filter(move |(_, slope)| is_inside(slope)).map(|(ray, _)| ray)
    }
}

/// Directions across, up and along an axis of length 1.
fn frame(ahead: &Vector3<f64>) -> [Vector3<f64>; 3] {
    let mut beside = Vector3::zeros();
    beside[ahead.iamin()] = 1.0;
    let across = beside.cross(ahead).normalize();
    [across, ahead.cross(&across), *ahead]
}

fn widen([low, high]: &mut [[f64; 2]; 2], slope: [f64; 2]) {
    for axis in 0..2 {
        low[axis] = low[axis].min(slope[axis]);
        high[axis] = high[axis].max(slope[axis]);
    }
}

fn largest(of: &[f64]) -> f64 {
    of.iter().copied().fold(NOTHING_MORE, f64::max)
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

    fn met(world: &World, origin: &Point3<f64>, ray: &Vector3<f64>, face: u32) -> Option<(f64, [f64; 2])> {
        Shear::along(ray).meet(origin, &world.corners_of(face))
    }

    #[test]
    fn rays_together_end_where_each_alone_does() {
        let (mut rays_with, mut rays_in_all) = (0, 0);
        each_soup(|world, origin, rng, slope| {
            let rays = rays(rng, slope);
            for (ray, found) in rays.iter().zip(world.hits(origin, &rays, 9.0)) {
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
            for (place, is_shaded) in places.iter().zip(world.shaded(lamp, &places)) {
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
