//! Output of `dump3d` of Survex for a file.

use nalgebra::Point3;

/// Passages that Survex lists in a file, as pairs of places.
pub fn dumped_passages(dump: &str) -> Vec<[Point3<f64>; 2]> {
    let legs = dump.lines().filter_map(|line| line.strip_prefix("LEG "));
    let passages = legs.filter(|leg| !["SPLAY", "SURFACE", "DUPLICATE"].iter().any(|flag| leg.contains(flag)));
    let places = passages.map(|leg| {
        let x: Vec<f64> = leg.split(' ').take(6).map(|x| x.parse().expect("a coordinate")).collect();
        [Point3::new(x[0], x[1], x[2]), Point3::new(x[3], x[4], x[5])]
    });
    places.filter(|[a, b]| a != b).collect()
}
