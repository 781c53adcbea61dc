//! Materials and images.

use std::fs;

use gltf_json::image::MimeType;
use gltf_json::material::{NormalTexture, OcclusionTexture, PbrMetallicRoughness, StrengthFactor};
use gltf_json::texture::{Info, Texture};
use gltf_json::{Index, Material};
use serde_json::json;

use super::Place;
use super::layout::Layout;
use super::payload::Payload;
use crate::error::{ExportError, at};
use crate::image_format::ImageFormat;
use crate::scene::{self, Chunk, Image};

/// Placeholder for the image of a texture without a fallback, omitted from the JSON.
const NO_SOURCE: u32 = u32::MAX;

impl Layout {
    pub(super) fn material<'a>(
        &mut self,
        material: &'a scene::Material,
        payload: &mut Payload<'a>,
    ) -> Result<Index<Material>, ExportError> {
        if let Some(made) = self.materials.get(&material.name) {
            return Ok(*made);
        }
        let mut textures = Vec::new();
        for (role, image) in images(material) {
            textures.push(self.texture(&material.name, role, image, payload)?);
        }
        let [base_color, normal, orm] = textures[..] else { unreachable!("there are three images") };
        let made = self.document.root.push(Material {
            name: Some(material.name.clone()),
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_texture: Some(info(base_color)),
                metallic_roughness_texture: Some(info(orm)),
                ..PbrMetallicRoughness::default()
            },
            normal_texture: Some(NormalTexture {
                index: normal,
                scale: 1.0,
                tex_coord: 0,
                extensions: None,
                extras: None,
            }),
            occlusion_texture: Some(OcclusionTexture {
                index: orm,
                strength: StrengthFactor(1.0),
                tex_coord: 0,
                extensions: None,
                extras: None,
            }),
            ..Material::default()
        });
        self.materials.insert(material.name.clone(), made);
        Ok(made)
    }

    fn texture<'a>(
        &mut self,
        material: &str,
        role: &str,
        image: &'a Image,
        payload: &mut Payload<'a>,
    ) -> Result<Index<Texture>, ExportError> {
        let name = format!("{material}_{role}");
        if let Some(texture) = self.textures.get(&name) {
            return Ok(*texture);
        }
        let source = self.image(&name, material, role, image, payload)?;
        let mut texture =
            Texture { name: Some(name.clone()), sampler: Some(Index::new(0)), source, extensions: None, extras: None };
        if image.format == ImageFormat::WebP {
            self.require_extension("EXT_texture_webp");
            texture.source = Index::new(NO_SOURCE);
            let others = &mut texture.extensions.get_or_insert_default().others;
            others.insert("EXT_texture_webp".to_owned(), json!({ "source": source }));
        }
        let texture = self.document.root.push(texture);
        self.textures.insert(name, texture);
        Ok(texture)
    }

    fn image<'a>(
        &mut self,
        name: &str,
        material: &str,
        role: &str,
        image: &'a Image,
        payload: &mut Payload<'a>,
    ) -> Result<Index<gltf_json::Image>, ExportError> {
        let (buffer_view, uri) = match self.style.images {
            Place::Embedded => {
                let bytes = fs::metadata(&image.path).map_err(|error| at(image.path.display(), &error))?.len();
                payload.push_image(image, bytes);
                (Some(self.view(bytes)), None)
            }
            Place::Beside => (None, Some(image_file(material, role, image))),
        };
        let mime_type = Some(MimeType(image.format.media_type().to_owned()));
        Ok(self.document.root.push(gltf_json::Image {
            buffer_view,
            mime_type,
            name: Some(name.to_owned()),
            uri,
            extensions: None,
            extras: None,
        }))
    }
}

/// The images of a material that glTF has, with their roles.
pub fn images(material: &scene::Material) -> [(&'static str, &Image); 3] {
    [("base_color", &material.base_color), ("normal", &material.normal), ("orm", &material.orm)]
}

fn image_file(material: &str, role: &str, image: &Image) -> String {
    format!("textures/{material}_{role}.{}", image.format.extension())
}

/// The images of a chunk with the files in which [`Place::Beside`] looks for them.
pub fn image_files(chunk: &Chunk) -> [(String, &Image); 3] {
    images(&chunk.material).map(|(role, image)| (image_file(&chunk.material.name, role, image), image))
}

fn info(index: Index<Texture>) -> Info {
    Info { index, tex_coord: 0, extensions: None, extras: None }
}
