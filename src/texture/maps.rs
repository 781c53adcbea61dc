//! The maps of a chunk.

/// Range of a height map, in metres; a step is then 8 µm. Rock that the mesh smooths over is within 2 dm, except in a few
/// spots.
pub const HEIGHT_AMPLITUDE_M: f32 = 0.25;

/// One item per map of a chunk: sinks, bytes, file names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Maps<T> {
    /// Base colour, sRGB.
    pub base_color: T,
    /// Tangent-space normal, +Y up (OpenGL, glTF).
    pub normal: T,
    /// Occlusion, roughness and metalness (0) in red, green and blue.
    pub orm: T,
    /// Roughness alone, grey: the green of `orm`.
    pub roughness: T,
    /// Optional: height of the rock above the mesh, 16-bit grey from `-HEIGHT_AMPLITUDE_M` (black) to [`HEIGHT_AMPLITUDE_M`]
    /// (white). Always PNG.
    pub height: Option<T>,
}

impl<T> Maps<T> {
    /// The same with references.
    pub fn as_ref(&self) -> Maps<&T> {
        let Self { base_color, normal, orm, roughness, height } = self;
        Maps { base_color, normal, orm, roughness, height: height.as_ref() }
    }

    /// The same with mutable references.
    pub fn as_mut(&mut self) -> Maps<&mut T> {
        let Self { base_color, normal, orm, roughness, height } = self;
        Maps { base_color, normal, orm, roughness, height: height.as_mut() }
    }

    /// Pairs of the items of two; the height only where both have one.
    pub fn zip<U>(self, other: Maps<U>) -> Maps<(T, U)> {
        Maps {
            base_color: (self.base_color, other.base_color),
            normal: (self.normal, other.normal),
            orm: (self.orm, other.orm),
            roughness: (self.roughness, other.roughness),
            height: self.height.zip(other.height),
        }
    }

    /// Maps each item.
    pub fn map<U>(self, mut make: impl FnMut(T) -> U) -> Maps<U> {
        Maps {
            base_color: make(self.base_color),
            normal: make(self.normal),
            orm: make(self.orm),
            roughness: make(self.roughness),
            height: self.height.map(make),
        }
    }

    /// Maps each item.
    ///
    /// # Errors
    /// The first error of `make`.
    pub fn try_map<U, E>(self, mut make: impl FnMut(T) -> Result<U, E>) -> Result<Maps<U>, E> {
        Ok(Maps {
            base_color: make(self.base_color)?,
            normal: make(self.normal)?,
            orm: make(self.orm)?,
            roughness: make(self.roughness)?,
            height: self.height.map(make).transpose()?,
        })
    }
}

/// In the order of the fields.
impl<T> IntoIterator for Maps<T> {
    type Item = T;
    type IntoIter = std::iter::Chain<std::array::IntoIter<T, 4>, std::option::IntoIter<T>>;

    fn into_iter(self) -> Self::IntoIter {
        [self.base_color, self.normal, self.orm, self.roughness].into_iter().chain(self.height)
    }
}
