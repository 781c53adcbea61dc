//! The maps of materials that are in memory.

use plume_exporters::ExportError;
use plume_exporters::scene::Material;

use crate::maps::Maps;

/// Bytes of maps in memory, above which those that were not needed for longest go.
const MOST_BYTES: usize = 1 << 31;

/// Maps by the number of their material, read when they are needed.
pub struct Library {
    materials: Vec<Material>,
    maps: Vec<Option<Loaded>>,
    most_bytes: usize,
    clock: u64,
}

struct Loaded {
    maps: Maps,
    used: u64,
}

impl Library {
    /// The maps of these materials, none of which is read yet.
    pub fn new(materials: &[Material]) -> Self {
        let maps = materials.iter().map(|_| None).collect();
        Self { materials: materials.to_vec(), maps, most_bytes: MOST_BYTES, clock: 0 }
    }

    /// Reads those of some materials, and forgets others if they are too many.
    ///
    /// # Errors
    /// If an image cannot be read.
    pub fn need(&mut self, numbers: &[u32]) -> Result<(), ExportError> {
        self.clock += 1;
        for number in numbers.iter().map(|number| *number as usize) {
            let maps = match self.maps[number].take() {
                Some(loaded) => loaded.maps,
                None => Maps::read(&self.materials[number])?,
            };
            self.maps[number] = Some(Loaded { maps, used: self.clock });
        }
        while self.bytes() > self.most_bytes {
            let old = self.maps.iter_mut().filter(|slot| slot.as_ref().is_some_and(|loaded| loaded.used < self.clock));
            let Some(oldest) = old.min_by_key(|slot| slot.as_ref().map(|loaded| loaded.used)) else { break };
            *oldest = None;
        }
        Ok(())
    }

    /// Those of a material, if they are in memory.
    pub fn maps(&self, number: u32) -> Option<&Maps> {
        self.maps[number as usize].as_ref().map(|loaded| &loaded.maps)
    }

    fn bytes(&self) -> usize {
        self.maps.iter().flatten().map(|loaded| loaded.maps.bytes()).sum()
    }
}

#[cfg(test)]
mod tests {
    use plume_exporters::ImageFormat;
    use plume_exporters::scene::Image;

    use super::*;

    #[test]
    fn the_oldest_maps_go_when_there_are_too_many() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.png");
        image::RgbImage::from_pixel(4, 4, image::Rgb([128; 3])).save(&path).unwrap();
        let image = || Image { path: path.clone(), format: ImageFormat::Png };
        let material = |name: &str| Material {
            name: name.to_owned(),
            base_color: image(),
            normal: image(),
            orm: image(),
            roughness: image(),
            height: None,
        };
        let mut library = Library::new(&["a", "b", "c"].map(material));
        library.most_bytes = 2 * 21 * 8;
        library.need(&[0]).unwrap();
        library.need(&[1]).unwrap();
        library.need(&[0]).unwrap();
        library.need(&[2]).unwrap();
        assert!(library.maps(0).is_some() && library.maps(1).is_none() && library.maps(2).is_some());
        library.need(&[0, 1, 2]).unwrap();
        assert!((0..3).all(|number| library.maps(number).is_some()), "what is needed now stays");
    }
}
