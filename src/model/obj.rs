//! Models in Wavefront OBJ, with the colours and textures of their MTL files.
//!
//! The format says neither unit nor axes: metres and y up are taken, as most programs write. Colours are linear RGB. Not read:
//! curves, surfaces and lines that continue on the next one.

use std::str::{FromStr, SplitWhitespace};
use std::sync::Arc;

use nalgebra::{Point3, Vector3};
use plume_graph::echo::shown;

use super::{Beside, Corner, MOST_TEXTURES, Material, Model, ModelError, Texture, Triangle, texture, z_up};
use crate::picture::Wrap;

/// What has no material, and what one that says nothing has.
const GREY: [f32; 3] = [0.8; 3];
const ROUGHNESS: f32 = 0.8;
const EXPORT: &str = "export it again as OBJ, or as GLB";

/// Reads a file.
pub fn read(bytes: &[u8], beside: &mut Beside) -> Result<Model, ModelError> {
    let mut reader = Reader::default();
    for (line, text) in (1..).zip(String::from_utf8_lossy(bytes).lines()) {
        let (word, rest) = split(text);
        let is_read = match word {
            "mtllib" => {
                reader.materials(&beside(rest)?, rest, beside)?;
                Some(())
            }
            "f" => reader.face(rest)?,
            _ => reader.statement(word, rest),
        };
        is_read.ok_or_else(|| fault(line, text))?;
    }
    Ok(reader.model)
}

fn fault(line: usize, text: &str) -> ModelError {
    ModelError::new(format!("line {line} cannot be read: {}", shown(text)), EXPORT)
}

/// The first word of a line, and the rest.
fn split(line: &str) -> (&str, &str) {
    let line = line.trim();
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    (word, rest.trim())
}

/// What has been read so far.
#[derive(Default)]
struct Reader {
    model: Model,
    /// Places and, where they have one, colours.
    vertices: Vec<([f64; 3], Option<[f32; 3]>)>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f64; 3]>,
    /// The names of the materials of the model, in their order; that of what has none is empty.
    names: Vec<String>,
    /// The name of the material in use.
    used: String,
}

impl Reader {
    /// Reads a line that is no face; `None` if it is faulty.
    fn statement(&mut self, word: &str, rest: &str) -> Option<()> {
        let mut words = rest.split_whitespace();
        match word {
            "v" => {
                let at = numbers(&mut words)?;
                let color = if words.clone().count() >= 3 { Some(numbers(&mut words)?) } else { None };
                self.vertices.push((at, color));
            }
            "vt" => {
                let [u, v] = numbers(&mut words)?;
                self.uvs.push([u, 1.0 - v]);
            }
            "vn" => self.normals.push(numbers(&mut words)?),
            "usemtl" => rest.clone_into(&mut self.used),
            _ => {}
        }
        Some(())
    }

    /// Reads a face as a fan of triangles; `None` if it is faulty.
    fn face(&mut self, rest: &str) -> Result<Option<()>, ModelError> {
        let corners: Option<Vec<Corner>> = rest.split_whitespace().map(|word| self.corner(word)).collect();
        let Some(corners) = corners.filter(|corners| corners.len() >= 3) else { return Ok(None) };
        let material = self.material();
        for pair in corners[1..].windows(2) {
            self.model.push(Triangle { corners: [corners[0], pair[0], pair[1]], material })?;
        }
        Ok(Some(()))
    }

    fn corner(&self, word: &str) -> Option<Corner> {
        let mut indices = word.split('/');
        let (at, color) = *nth(&self.vertices, indices.next()?)?;
        let mut other = || indices.next().filter(|index| !index.is_empty());
        let uv = match other() {
            Some(index) => *nth(&self.uvs, index)?,
            None => [0.0; 2],
        };
        let normal = match other() {
            Some(index) => Vector3::from(z_up(*nth(&self.normals, index)?)).try_normalize(0.0),
            None => None,
        };
        Some(Corner { at: Point3::from(z_up(at)), normal, uv, color: color.unwrap_or([1.0; 3]) })
    }

    /// The index of the material in use, which is grey if it is not known.
    fn material(&mut self) -> usize {
        if let Some(known) = self.names.iter().rposition(|name| *name == self.used) {
            return known;
        }
        // Vertices have colours of their own, or none has.
        let color = if self.vertices.iter().any(|(_, color)| color.is_some()) { [1.0; 3] } else { GREY };
        self.add(self.used.clone(), Material { color, roughness: ROUGHNESS, texture: None });
        self.names.len() - 1
    }

    fn add(&mut self, name: String, material: Material) {
        self.names.push(name);
        self.model.materials.push(material);
    }

    /// Reads a file of materials.
    fn materials(&mut self, bytes: &[u8], file: &str, beside: &mut Beside) -> Result<(), ModelError> {
        for (line, text) in (1..).zip(String::from_utf8_lossy(bytes).lines()) {
            let (word, rest) = split(text);
            let fault = || {
                let ModelError { message, hint } = fault(line, text);
                ModelError::new(format!("{}: {message}", shown(file)), hint)
            };
            if word == "newmtl" {
                self.add(rest.to_owned(), Material { color: GREY, roughness: ROUGHNESS, texture: None });
                continue;
            }
            let textures = self.model.materials.iter().filter(|material| material.texture.is_some()).count();
            let Some(material) = self.model.materials.last_mut() else { continue };
            let mut words = rest.split_whitespace();
            match word {
                "Kd" if material.texture.is_none() => material.color = numbers(&mut words).ok_or_else(fault)?,
                "Pr" => [material.roughness] = numbers(&mut words).ok_or_else(fault)?,
                "map_Kd" if textures == MOST_TEXTURES => {
                    let message = format!("has more than {MOST_TEXTURES} textures");
                    return Err(ModelError::new(message, "bake them into one"));
                }
                "map_Kd" => {
                    // Options come before the name, which may have spaces if there are none.
                    let name = if rest.starts_with('-') { words.last().unwrap_or_default() } else { rest };
                    let image = Arc::new(texture(&beside(name)?)?);
                    // The texture is the colour: many programs write black beside it.
                    material.color = [1.0; 3];
                    material.texture = Some(Texture { image, wrap: [Wrap::Repeat; 2] });
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// The next numbers of a line, all finite.
fn numbers<T: FromStr + Into<f64> + Copy, const N: usize>(words: &mut SplitWhitespace) -> Option<[T; N]> {
    let read: Vec<T> = words.by_ref().take(N).map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let numbers: [T; N] = read.try_into().ok()?;
    numbers.iter().all(|number| (*number).into().is_finite()).then_some(numbers)
}

/// The row with a number, counted from 1, or backwards from -1.
fn nth<'a, T>(rows: &'a [T], number: &str) -> Option<&'a T> {
    let number: i64 = number.parse().ok()?;
    let from_end = || usize::try_from(number.unsigned_abs()).ok().and_then(|back| rows.len().checked_sub(back));
    let place = if number < 0 { from_end() } else { usize::try_from(number).ok()?.checked_sub(1) };
    rows.get(place?)
}
