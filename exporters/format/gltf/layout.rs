//! The JSON of a GLB: which bytes of the payload are what.

use std::collections::BTreeMap;
use std::fs;

use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::extensions::root::KhrLightsPunctual;
use gltf_json::extensions::scene::khr_lights_punctual;
use gltf_json::extras::RawValue;
use gltf_json::image::MimeType;
use gltf_json::material::{NormalTexture, OcclusionTexture, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::texture::{Info, MagFilter, MinFilter, Sampler, Texture};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Asset, Buffer, Index, Material, Mesh, Node, Root, Scene as GltfScene};
use serde_json::{Value, json};

use crate::error::{ExportError, at};
use crate::frame;
use crate::scene::{self, Chunk, Image, Light, Piece, Scene};

/// A plan that grows by chunks; the payload follows in the same order.
pub struct Layout {
    root: Root,
    bytes: u64,
}

impl Layout {
    /// A scene without nodes.
    pub fn new(scene: &Scene) -> Self {
        let mut root = Root {
            asset: Asset { generator: Some(scene.generator.clone()), ..Asset::default() },
            scene: Some(Index::new(0)),
            extras: extras(&json!({ "recipe": scene.recipe })),
            ..Root::default()
        };
        root.scenes.push(GltfScene {
            extensions: None,
            extras: None,
            name: Some(scene.name.clone()),
            nodes: Vec::new(),
        });
        root.samplers.push(Sampler {
            mag_filter: Some(Valid(MagFilter::Linear)),
            min_filter: Some(Valid(MinFilter::LinearMipmapLinear)),
            ..Sampler::default()
        });
        Self { root, bytes: 0 }
    }

    /// Adds a node with the visual mesh, its material and its images, and below it a node for each piece.
    ///
    /// # Errors
    /// When the size of an image cannot be read.
    pub fn add_chunk(&mut self, chunk: &Chunk, pieces: &[Piece]) -> Result<(), ExportError> {
        let primitive = self.primitive(&chunk.visual, &vertex_attributes());
        let material = self.material(chunk)?;
        let mut node = self.node(chunk.name.clone(), Primitive { material: Some(material), ..primitive });
        let children: Vec<Index<Node>> = pieces
            .iter()
            .enumerate()
            .map(|(number, piece)| {
                let primitive = self.primitive(&piece.mesh, &vertex_attributes()[..1]);
                let child = self.node(format!("UCX_{}_{number:02}", chunk.name), primitive);
                self.root.push(child)
            })
            .collect();
        node.children = (!children.is_empty()).then_some(children);
        self.add_node(node);
        Ok(())
    }

    /// Adds a node for each light (KHR_lights_punctual, candela).
    pub fn add_lights(&mut self, lights: &[Light]) {
        if lights.is_empty() {
            return;
        }
        self.root.extensions_used.push("KHR_lights_punctual".to_owned());
        let table = KhrLightsPunctual { lights: lights.iter().map(punctual).collect() };
        self.root.extensions.get_or_insert_default().khr_lights_punctual = Some(table);
        for (index, light) in (0..).zip(lights) {
            let reference = khr_lights_punctual::KhrLightsPunctual { light: Index::new(index) };
            let extensions = gltf_json::extensions::scene::Node { khr_lights_punctual: Some(reference) };
            let position = frame::gltf_from_scene::<f64>(light.position.into());
            self.add_node(Node {
                extensions: Some(extensions),
                name: Some(light.name.clone()),
                translation: Some(position.map(|metres| metres as f32)),
                ..Node::default()
            });
        }
    }

    /// The JSON and the size of the payload.
    pub fn finish(mut self) -> (Root, u64) {
        self.root.buffers.push(Buffer {
            byte_length: self.bytes.into(),
            extensions: None,
            extras: None,
            name: None,
            uri: None,
        });
        (self.root, self.bytes)
    }

    fn add_node(&mut self, node: Node) {
        let node = self.root.push(node);
        self.root.scenes[0].nodes.push(node);
    }

    /// A node of a mesh of the same name.
    fn node(&mut self, name: String, primitive: Primitive) -> Node {
        let mesh = self.root.push(Mesh {
            extensions: None,
            extras: None,
            name: Some(name.clone()),
            primitives: vec![primitive],
            weights: None,
        });
        Node { mesh: Some(mesh), name: Some(name), ..Node::default() }
    }

    fn primitive(&mut self, mesh: &scene::Mesh, wanted: &[(Semantic, Type)]) -> Primitive {
        let mut attributes = BTreeMap::new();
        for (semantic, shape) in wanted.iter().cloned() {
            let is_position = semantic == Semantic::Positions;
            let view = self.view(mesh.positions.len() as u64 * 4 * shape.multiplicity() as u64);
            self.root.buffer_views[view.value()].target = Some(Valid(Target::ArrayBuffer));
            let [min, max] = match is_position {
                true => bounds(&mesh.positions).map(|corner| Some(json!(corner))),
                false => [None, None],
            };
            let count = mesh.positions.len();
            let accessor = Accessor { min, max, ..accessor(view, count, ComponentType::F32, shape) };
            attributes.insert(Valid(semantic), self.root.push(accessor));
        }
        Primitive {
            attributes,
            extensions: None,
            extras: None,
            indices: Some(self.indices(mesh)),
            material: None,
            mode: Valid(Mode::Triangles),
            targets: None,
        }
    }

    fn indices(&mut self, mesh: &scene::Mesh) -> Index<Accessor> {
        let view = self.view(mesh.indices.len() as u64 * index_bytes(mesh));
        self.root.buffer_views[view.value()].target = Some(Valid(Target::ElementArrayBuffer));
        let component = match index_bytes(mesh) {
            2 => ComponentType::U16,
            _ => ComponentType::U32,
        };
        self.root.push(accessor(view, mesh.indices.len(), component, Type::Scalar))
    }

    fn material(&mut self, chunk: &Chunk) -> Result<Index<Material>, ExportError> {
        let mut textures = Vec::new();
        for (role, image) in images(&chunk.material) {
            textures.push(self.texture(format!("{}_{role}", chunk.name), image)?);
        }
        let [base_color, normal, orm] = textures[..] else { unreachable!("there are three images") };
        Ok(self.root.push(Material {
            name: Some(chunk.name.clone()),
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
        }))
    }

    fn texture(&mut self, name: String, image: &Image) -> Result<Index<Texture>, ExportError> {
        let bytes = fs::metadata(&image.path).map_err(|error| at(image.path.display(), &error))?.len();
        let view = self.view(bytes);
        let source = self.root.push(gltf_json::Image {
            buffer_view: Some(view),
            mime_type: Some(MimeType(image.format.media_type().to_owned())),
            name: Some(name.clone()),
            uri: None,
            extensions: None,
            extras: None,
        });
        Ok(self.root.push(Texture {
            name: Some(name),
            sampler: Some(Index::new(0)),
            source,
            extensions: None,
            extras: None,
        }))
    }

    /// The next `bytes` of the payload; what follows starts at a multiple of four.
    fn view(&mut self, bytes: u64) -> Index<View> {
        let view = View {
            buffer: Index::new(0),
            byte_length: bytes.into(),
            byte_offset: Some(self.bytes.into()),
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: None,
        };
        self.bytes += bytes + padding(bytes);
        self.root.push(view)
    }
}

/// The vertex attributes of a visual mesh in the order of the payload; a piece has the first.
fn vertex_attributes() -> [(Semantic, Type); 4] {
    [
        (Semantic::Positions, Type::Vec3),
        (Semantic::Normals, Type::Vec3),
        (Semantic::Tangents, Type::Vec4),
        (Semantic::TexCoords(0), Type::Vec2),
    ]
}

/// The images in the order of the payload, each with its role.
pub fn images(material: &scene::Material) -> [(&'static str, &Image); 3] {
    [("base_color", &material.base_color), ("normal", &material.normal), ("orm", &material.orm)]
}

/// Bytes of a vertex index. The largest number of a type is not an index: it restarts primitives.
pub fn index_bytes(mesh: &scene::Mesh) -> u64 {
    if mesh.positions.len() <= usize::from(u16::MAX) { 2 } else { 4 }
}

/// Bytes from `bytes` to the next multiple of four.
pub fn padding(bytes: u64) -> u64 {
    bytes.next_multiple_of(4) - bytes
}

/// Lowest and highest corner of scene points, in the frame of glTF.
pub fn bounds(points: &[[f32; 3]]) -> [[f32; 3]; 2] {
    scene::bounds(points.iter().copied().map(frame::gltf_from_scene))
}

fn accessor(view: Index<View>, count: usize, component: ComponentType, shape: Type) -> Accessor {
    Accessor {
        buffer_view: Some(view),
        byte_offset: None,
        count: count.into(),
        component_type: Valid(GenericComponentType(component)),
        extensions: None,
        extras: None,
        type_: Valid(shape),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    }
}

fn info(index: Index<Texture>) -> Info {
    Info { index, tex_coord: 0, extensions: None, extras: None }
}

fn punctual(light: &Light) -> khr_lights_punctual::Light {
    khr_lights_punctual::Light {
        color: light.color.map(|channel| channel as f32),
        extensions: None,
        extras: None,
        intensity: light.intensity_cd as f32,
        name: Some(light.name.clone()),
        range: Some(light.range_m as f32),
        spot: None,
        type_: Valid(khr_lights_punctual::Type::Point),
    }
}

fn extras(value: &Value) -> Option<Box<RawValue>> {
    Some(RawValue::from_string(value.to_string()).expect("a JSON value prints as JSON"))
}
