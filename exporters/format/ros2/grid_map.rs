//! `grid_map_msgs/msg/GridMap`: layers of numbers on the cells of a map.
//!
//! After Fankhauser and Hutter, "A universal grid map library" (2016): rows go down from the largest x, columns from the largest y, and
//! numbers are by columns. A cell without a number has NaN.

use super::{Cdr, HEADER, Kind, POINT, POSE, QUATERNION, TIME};

const INFO: Kind = Kind {
    name: "grid_map_msgs/msg/GridMapInfo",
    fields: "float64 resolution\nfloat64 length_x\nfloat64 length_y\ngeometry_msgs/Pose pose\n",
    parts: &[],
};
const DIMENSION: Kind =
    Kind { name: "std_msgs/msg/MultiArrayDimension", fields: "string label\nuint32 size\nuint32 stride\n", parts: &[] };
const LAYOUT: Kind = Kind {
    name: "std_msgs/msg/MultiArrayLayout",
    fields: "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n",
    parts: &[],
};
const ARRAY: Kind = Kind {
    name: "std_msgs/msg/Float32MultiArray",
    fields: "std_msgs/MultiArrayLayout layout\nfloat32[] data\n",
    parts: &[],
};

/// A map, or a part of one.
pub struct GridMap<'a> {
    /// The frame in which it is.
    pub frame: &'a str,
    /// Side of a cell in metres.
    pub cell_m: f64,
    /// Its middle in metres.
    pub middle_m: [f64; 2],
    /// Number of cells along x and y.
    pub size: [usize; 2],
    /// Names of its layers; where the first has no number, there is nothing.
    pub layers: &'a [&'a str],
}

impl GridMap<'_> {
    /// The kind of such messages.
    pub const KIND: Kind = Kind {
        name: "grid_map_msgs/msg/GridMap",
        fields: "std_msgs/Header header\ngrid_map_msgs/GridMapInfo info\nstring[] layers\nstring[] basic_layers\n\
            std_msgs/Float32MultiArray[] data\nuint16 outer_start_index\nuint16 inner_start_index\n",
        parts: &[&HEADER, &TIME, &INFO, &POSE, &POINT, &QUATERNION, &ARRAY, &LAYOUT, &DIMENSION],
    };

    /// The message, with the number of each layer at each cell, counted from the lowest x and y.
    pub fn encode(&self, value: impl Fn(usize, [usize; 2]) -> f32) -> Vec<u8> {
        let [rows, columns] = self.size;
        let [x, y] = self.middle_m;
        let mut cdr = Cdr::stamped(0, self.frame);
        cdr.f64s(&[self.cell_m, rows as f64 * self.cell_m, columns as f64 * self.cell_m]);
        cdr.f64s(&[x, y, 0.0, 0.0, 0.0, 0.0, 1.0]);
        for layers in [self.layers, &self.layers[..1]] {
            cdr.u32(layers.len() as u32);
            layers.iter().for_each(|layer| cdr.text(layer));
        }
        cdr.u32(self.layers.len() as u32);
        let cell = |number: usize| [rows - 1 - number % rows, columns - 1 - number / rows];
        for layer in 0..self.layers.len() {
            cdr.u32(2);
            for (label, size, stride) in [("column_index", columns, rows * columns), ("row_index", rows, rows)] {
                cdr.text(label);
                cdr.u32(size as u32);
                cdr.u32(stride as u32);
            }
            cdr.u32(0);
            cdr.f32s((0..rows * columns).map(|number| value(layer, cell(number))));
        }
        cdr.u16(0);
        cdr.u16(0);
        cdr.into_bytes()
    }
}
