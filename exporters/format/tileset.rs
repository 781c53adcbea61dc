//! Trees of tiles as JSON: 3D Tiles 1.1 (OGC 22-025r4, <https://docs.ogc.org/cs/22-025r4/22-025r4.html>), Z up, metres.
//!
//! A viewer shows a tile until its error appears larger than some pixels, and then its children. The error of a tile without
//! content is the size of what is missing.

use std::io;

use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use crate::error::ExportError;
use crate::package::Package;

/// Bounds are rounded outwards to millimetres, and errors up to tenths of them.
const PER_M: f64 = 1000.0;
const ERROR_PER_M: f64 = 10_000.0;
/// Least extent of a bounding box in metres; a flat one is not valid.
const THIN_M: f64 = 0.001;

/// An axis-aligned box in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    min: [f64; 3],
    max: [f64; 3],
}

impl Bounds {
    /// The box between two corners.
    pub fn new([min, max]: [[f32; 3]; 2]) -> Self {
        let min = min.map(|metres| (f64::from(metres) * PER_M).floor() / PER_M);
        let max = max.map(|metres| (f64::from(metres) * PER_M).ceil() / PER_M);
        Self { min, max: [0, 1, 2].map(|axis| max[axis].max(min[axis] + THIN_M)) }
    }

    /// The box around both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            min: [0, 1, 2].map(|axis| self.min[axis].min(other.min[axis])),
            max: [0, 1, 2].map(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    fn middle(&self, axis: usize) -> f64 {
        0.5 * (self.min[axis] + self.max[axis])
    }

    fn extent_m(&self, axis: usize) -> f64 {
        self.max[axis] - self.min[axis]
    }

    fn diagonal_m(&self) -> f64 {
        (0..3).map(|axis| self.extent_m(axis) * self.extent_m(axis)).sum::<f64>().sqrt()
    }
}

impl Serialize for Bounds {
    /// The centre, then half of each axis.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let tidy = |metres: f64| (metres * 2.0 * PER_M).round() / (2.0 * PER_M);
        let mut numbers = [0.0; 12];
        for axis in 0..3 {
            numbers[axis] = tidy(self.middle(axis));
            numbers[3 + 4 * axis] = tidy(0.5 * self.extent_m(axis));
        }
        json!({ "box": numbers }).serialize(serializer)
    }
}

/// A tile with everything below it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Tile {
    #[serde(rename = "boundingVolume")]
    bounds: Bounds,
    #[serde(rename = "geometricError")]
    error_m: f64,
    refine: Refine,
    #[serde(skip_serializing_if = "Option::is_none")]
    content: Option<Content>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    children: Vec<Tile>,
}

/// How children relate to the content of their parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
enum Refine {
    Add,
    Replace,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct Content {
    uri: String,
}

impl Tile {
    /// The levels of detail of one thing: files, relative to that of the tileset, with their errors in metres, the coarsest
    /// first. A level has at least the error of the next finer one.
    ///
    /// # Panics
    /// If there is none.
    pub fn levels(bounds: Bounds, levels: impl DoubleEndedIterator<Item = (String, f64)>) -> Self {
        let finer = |finer: Option<Self>, (uri, error_m): (String, f64)| {
            let error_m = (error_m * ERROR_PER_M).ceil() / ERROR_PER_M;
            let error_m = finer.as_ref().map_or(error_m, |finer| finer.error_m.max(error_m));
            let content = Some(Content { uri });
            Some(Self { bounds, error_m, refine: Refine::Replace, content, children: finer.into_iter().collect() })
        };
        levels.rev().fold(None, finer).expect("there is a level")
    }

    /// Some tiles, of which none is seen from where all of them together are less than the error of a viewer.
    ///
    /// # Panics
    /// If there is none.
    pub fn group(children: Vec<Self>) -> Self {
        let bounds = children.iter().map(|tile| tile.bounds).reduce(Bounds::and).expect("there is a tile");
        let error_m = children.iter().map(|tile| tile.error_m).fold(bounds.diagonal_m(), f64::max);
        let error_m = (error_m * PER_M).ceil() / PER_M;
        Self { bounds, error_m, refine: Refine::Add, content: None, children }
    }

    /// This tile as one that is in a tileset of its own, at `uri`.
    #[must_use]
    pub fn in_file(self, uri: String) -> Self {
        Self { content: Some(Content { uri }), children: Vec::new(), ..self }
    }

    /// A tree over tiles, halved along the longest side until `most` are left, which `close` makes into one.
    ///
    /// # Errors
    /// Those of `close`.
    pub fn tree(
        mut tiles: Vec<Self>,
        most: usize,
        close: &mut dyn FnMut(Vec<Self>) -> Result<Self, ExportError>,
    ) -> Result<Self, ExportError> {
        if tiles.len() <= most {
            return close(tiles);
        }
        let bounds = tiles.iter().map(|tile| tile.bounds).reduce(Bounds::and).expect("there are more than none");
        let longest = (0..3).max_by(|a, b| bounds.extent_m(*a).total_cmp(&bounds.extent_m(*b))).unwrap_or(0);
        tiles.sort_by(|a, b| a.bounds.middle(longest).total_cmp(&b.bounds.middle(longest)));
        let second = tiles.split_off(tiles.len() / 2);
        let halves = [tiles, second].map(|half| Self::tree(half, most, close));
        Ok(Self::group(halves.into_iter().collect::<Result<_, _>>()?))
    }

    /// Writes a tileset with this tile at its root; `extras` are for applications, if there are any.
    ///
    /// # Errors
    /// Those of the package.
    pub fn write(&self, path: &str, extras: Option<Value>, out: &mut dyn Package) -> Result<(), ExportError> {
        let mut tileset = json!({
            "asset": { "version": "1.1" },
            "geometricError": self.error_m,
            "root": self,
        });
        if let Some(extras) = extras {
            tileset["extras"] = extras;
        }
        out.write(path, |file| Ok(serde_json::to_writer(file, &tileset).map_err(io::Error::from)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(from_m: f32) -> Bounds {
        Bounds::new([[from_m, 0.0, 0.0], [from_m + 1.0, 1.0, 0.0]])
    }

    fn tile(number: u8) -> Tile {
        Tile::levels(bounds(f32::from(number)), [(format!("{number}.glb"), 0.0)].into_iter())
    }

    #[test]
    fn a_finer_level_replaces_a_coarser_one() {
        let levels =
            [("far", 0.05), ("near", 0.0625), ("close", 0.0)].map(|(name, error_m)| (name.to_owned(), error_m));
        let tile = Tile::levels(bounds(0.0), levels.into_iter());
        let value = serde_json::to_value(&tile).unwrap();
        assert_eq!(value["content"]["uri"], "far");
        assert_eq!((value["geometricError"].as_f64(), &value["refine"]), (Some(0.0625), &json!("REPLACE")));
        assert_eq!(
            value["children"][0]["children"][0],
            json!({
                "boundingVolume": { "box": [0.5, 0.5, 0.0005, 0.5, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0005] },
                "geometricError": 0.0, "refine": "REPLACE", "content": { "uri": "close" },
            })
        );
    }

    #[test]
    fn a_tree_has_every_tile_once_inside_its_ancestors() {
        fn leaves(tile: &Tile, found: &mut Vec<String>) {
            found.extend(tile.content.as_ref().map(|content| content.uri.clone()));
            for child in &tile.children {
                assert_eq!(tile.bounds.and(child.bounds), tile.bounds);
                assert!(tile.error_m >= child.error_m);
                leaves(child, found);
            }
        }
        let mut sizes = Vec::new();
        let tree = Tile::tree((0..50).rev().map(tile).collect(), 8, &mut |tiles| {
            sizes.push(tiles.len());
            Ok(Tile::group(tiles))
        });
        let mut found = Vec::new();
        leaves(&tree.unwrap(), &mut found);
        assert_eq!(found, (0..50).map(|number| format!("{number}.glb")).collect::<Vec<_>>());
        assert!(sizes.iter().all(|size| (4..=8).contains(size)), "{sizes:?}");
    }
}
