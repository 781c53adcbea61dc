//! The maps of a chunk.

/// The furthest from the mesh that a height map can say, in metres; a step of it is then 8 µm. Rock that the mesh smooths
/// over lies within 2 dm, but for a few spots.
pub const HEIGHT_AMPLITUDE_M: f32 = 0.25;

/// One thing per map of a chunk: sinks, bytes, file names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Maps<T> {
    /// Base colour, sRGB.
    pub base_color: T,
    /// Tangent-space normal, +Y up (OpenGL, glTF).
    pub normal: T,
    /// Occlusion, roughness and metalness (none) in red, green and blue.
    pub orm: T,
    /// Roughness alone, grey: the green of `orm`.
    pub roughness: T,
    /// Where it is asked for: how far the rock lies before the mesh, 16 bits of grey from `-HEIGHT_AMPLITUDE_M` (black) to
    /// [`HEIGHT_AMPLITUDE_M`] (white). Always PNG.
    pub height: Option<T>,
}

impl<T> Maps<T> {
    /// The same of references.
    pub fn as_ref(&self) -> Maps<&T> {
        let Self { base_color, normal, orm, roughness, height } = self;
        Maps { base_color, normal, orm, roughness, height: height.as_ref() }
    }

    /// The same of references that can be written through.
    pub fn as_mut(&mut self) -> Maps<&mut T> {
        let Self { base_color, normal, orm, roughness, height } = self;
        Maps { base_color, normal, orm, roughness, height: height.as_mut() }
    }

    /// Makes one thing of another.
    ///
    /// # Errors
    /// The first that `make` gives.
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
