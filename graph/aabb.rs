//! Boxes along the axes.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Sub};

/// An axis-aligned box, faces included; in metres, or in whatever its coordinates are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aabb<T, const N: usize = 3> {
    /// Lowest corner.
    pub min: [T; N],
    /// Highest corner.
    pub max: [T; N],
}

impl<T: Copy + PartialOrd, const N: usize> Aabb<T, N> {
    /// The smallest box round these points; `None` without points.
    pub fn from_points(points: impl IntoIterator<Item = impl Into<[T; N]>>) -> Option<Self> {
        let mut points = points.into_iter().map(Into::into);
        let first = Self::from(points.next()?);
        Some(points.fold(first, Self::including))
    }

    /// The smallest box round this one and a point.
    pub fn including(self, point: [T; N]) -> Self {
        self.union(point.into())
    }

    /// The smallest box round both.
    pub fn union(self, other: Self) -> Self {
        Self {
            min: from_fn(|axis| lower(self.min[axis], other.min[axis])),
            max: from_fn(|axis| higher(self.max[axis], other.max[axis])),
        }
    }

    /// Whether a point lies in it.
    pub fn contains(&self, point: [T; N]) -> bool {
        self.intersects(&point.into())
    }

    /// Whether the two have a point in common.
    pub fn intersects(&self, other: &Self) -> bool {
        (0..N).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }
}

impl<T: Copy + PartialOrd + Add<Output = T> + Sub<Output = T>, const N: usize> Aabb<T, N> {
    /// The box with so much more on every side.
    pub fn padded(self, margin: T) -> Self {
        Self { min: self.min.map(|low| low - margin), max: self.max.map(|high| high + margin) }
    }

    /// How long it is along each axis.
    pub fn size(&self) -> [T; N] {
        from_fn(|axis| self.max[axis] - self.min[axis])
    }

    /// The axis along which it is longest, the first of equals.
    pub fn longest_axis(&self) -> usize {
        let size = self.size();
        (1..N).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest })
    }

    /// The point in the middle.
    pub fn center(&self) -> [T; N]
    where
        T: Div<Output = T> + From<u8>,
    {
        let size = self.size();
        from_fn(|axis| self.min[axis] + size[axis] / T::from(2))
    }

    /// The squared distance from a point; 0 inside.
    pub fn squared_distance(&self, point: [T; N]) -> T
    where
        T: Mul<Output = T> + Add<Output = T> + From<u8>,
    {
        // A loop, because a sum over an iterator is not always inlined, and searches spend their time here.
        let mut sum = T::from(0);
        for (axis, &at) in point.iter().enumerate() {
            let away = at - lower(higher(at, self.min[axis]), self.max[axis]);
            sum = sum + away * away;
        }
        sum
    }
}

/// The box that holds nothing but a point.
impl<T: Copy, const N: usize> From<[T; N]> for Aabb<T, N> {
    fn from(point: [T; N]) -> Self {
        Self { min: point, max: point }
    }
}

fn lower<T: PartialOrd>(a: T, b: T) -> T {
    if b < a { b } else { a }
}

fn higher<T: PartialOrd>(a: T, b: T) -> T {
    if b > a { b } else { a }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;

    const UNIT: Aabb<f64> = Aabb { min: [0.0; 3], max: [1.0; 3] };

    #[test]
    fn a_box_is_no_larger_than_its_points() {
        let points = [[1, 5], [-2, 3], [0, 9]];
        assert_eq!(Aabb::from_points(points), Some(Aabb { min: [-2, 3], max: [1, 9] }));
        assert_eq!(Aabb::from_points([Point3::new(1.0, 2.0, 3.0)]), Some(Aabb::from([1.0, 2.0, 3.0])));
        assert_eq!(Aabb::<i32>::from_points([[0; 3]; 0]), None);
    }

    #[test]
    fn boxes_grow() {
        assert_eq!(UNIT.including([0.5, 3.0, -1.0]), Aabb { min: [0.0, 0.0, -1.0], max: [1.0, 3.0, 1.0] });
        assert_eq!(UNIT.union(Aabb::from([2.0; 3])), Aabb { min: [0.0; 3], max: [2.0; 3] });
        assert_eq!(UNIT.padded(0.5), Aabb { min: [-0.5; 3], max: [1.5; 3] });
    }

    #[test]
    fn faces_belong_to_a_box() {
        assert!(UNIT.contains([1.0, 0.0, 0.5]) && !UNIT.contains([1.0, 0.0, 1.5]));
        assert!(UNIT.intersects(&Aabb { min: [1.0; 3], max: [2.0; 3] }));
        assert!(!UNIT.intersects(&Aabb { min: [0.0, 0.0, 1.1], max: [2.0; 3] }));
    }

    #[test]
    fn boxes_are_measured() {
        let slab = Aabb { min: [-1.0, 2.0, 0.0], max: [3.0, 6.0, 1.0] };
        assert_eq!((slab.size(), slab.center(), slab.longest_axis()), ([4.0, 4.0, 1.0], [1.0, 4.0, 0.5], 0));
        assert_eq!((slab.squared_distance([6.0, 4.0, 5.0]), slab.squared_distance([0.0, 3.0, 0.5])), (25.0, 0.0));
    }
}
