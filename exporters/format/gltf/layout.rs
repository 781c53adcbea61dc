//! The JSON: nodes, meshes and levels of detail.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gltf_json::extras::RawValue;
use gltf_json::mesh::Primitive;
use gltf_json::texture::{MagFilter, MinFilter, Sampler};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Asset, Buffer, Index, Material, Mesh, Node, Root, Scene as GltfScene, Texture};
use nalgebra::{Point3, distance};
use serde_json::{Value, json};

use super::Style;
use super::document::Document;
use super::geometry::VERTEX;
use super::payload::Payload;
use crate::error::ExportError;
use crate::names;
use crate::scene::{self, Chunk, Piece, Scene};

/// The screen of [`screen_coverage`], pixels.
const SCREEN_PX: [f32; 2] = [1920.0, 1080.0];

/// A document that is built chunk by chunk; the bytes of each are returned when it is added.
pub struct Layout {
    pub(super) document: Document,
    /// A folder for files that are removed when they are closed.
    pub(super) scratch: PathBuf,
    pub(super) style: Style,
    /// The buffer that is being filled.
    pub(super) open: Index<Buffer>,
    /// The textures by name, since chunks may share them.
    pub(super) textures: BTreeMap<String, Index<Texture>>,
    /// The materials by name, likewise.
    pub(super) materials: BTreeMap<String, Index<Material>>,
    /// The meshes of prototypes by name.
    pub(super) shared: BTreeMap<String, Index<Mesh>>,
}

/// Indices of a chunk in its document.
pub struct Placed {
    pub(super) node: Index<Node>,
    pub(super) material: Index<Material>,
}

impl Layout {
    /// A scene without nodes. What does not fit into memory waits in the folder `scratch`.
    pub fn new(scene: &Scene, style: Style, scratch: &Path) -> Self {
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
        Self {
            document: Document { root, ..Document::default() },
            scratch: scratch.to_owned(),
            style,
            open: Index::new(0),
            textures: BTreeMap::new(),
            materials: BTreeMap::new(),
            shared: BTreeMap::new(),
        }
    }

    /// Adds a node with the visual mesh, its material and its images, with a child node for each convex piece.
    ///
    /// # Errors
    /// If the size of an image cannot be read, and those of files in `scratch`.
    pub fn add_chunk<'a>(&mut self, chunk: &'a Chunk, pieces: &[Piece]) -> Result<(Placed, Payload<'a>), ExportError> {
        self.document.settle(&self.scratch)?;
        self.open_buffer(&chunk.name);
        let mut payload = Payload::default();
        let primitive = self.primitive(&chunk.visual, &VERTEX, &mut payload);
        let material = self.material(&chunk.material, &mut payload)?;
        let mut node = self.node(chunk.name.clone(), Primitive { material: Some(material), ..primitive });
        let children: Vec<Index<Node>> = pieces
            .iter()
            .enumerate()
            .map(|(number, piece)| {
                let primitive = self.primitive(&piece.mesh, &VERTEX[..1], &mut payload);
                let child = self.node(names::convex_piece(&chunk.name, number), primitive);
                self.document.nodes.push(child)
            })
            .collect();
        node.children = (!children.is_empty()).then_some(children);
        let node = self.add_node(node);
        Ok((Placed { node, material }, payload))
    }

    /// Adds the coarser levels of a chunk with MSFT_lod: nodes outside the scene, named `<chunk>_LOD1` and so on, to which
    /// the node of the chunk refers. Levels share its material. No chunk may be added between it and them.
    pub fn add_levels(&mut self, chunk: &Chunk, placed: &Placed) -> Payload<'static> {
        let mut payload = Payload::default();
        if chunk.lods.is_empty() {
            return payload;
        }
        self.open_buffer(&level_buffer(&chunk.name));
        let mut ids: Vec<Index<Node>> = Vec::new();
        for (number, lod) in (1..).zip(&chunk.lods) {
            let primitive = self.primitive(&lod.mesh, &VERTEX, &mut payload);
            let primitive = Primitive { material: Some(placed.material), ..primitive };
            let node = self.node(names::level(&chunk.name, number), primitive);
            ids.push(self.document.nodes.push(Node { extras: extras(&json!({ "error_m": lod.error_m })), ..node }));
        }
        self.use_extension("MSFT_lod");
        let node = self.document.nodes.recent(placed.node);
        let others = &mut node.extensions.get_or_insert_default().others;
        others.insert("MSFT_lod".to_owned(), json!({ "ids": ids }));
        node.extras = extras(&json!({ "error_m": 0.0, "MSFT_screencoverage": screen_coverage(chunk) }));
        payload
    }

    /// The JSON.
    ///
    /// # Errors
    /// Those of files in `scratch`.
    pub fn finish(mut self) -> Result<Document, ExportError> {
        self.document.settle(&self.scratch)?;
        Ok(self.document)
    }

    pub(super) fn add_node(&mut self, node: Node) -> Index<Node> {
        let node = self.document.nodes.push(node);
        self.document.root.scenes[0].nodes.push(node);
        node
    }

    /// A node of a mesh of the same name.
    fn node(&mut self, name: String, primitive: Primitive) -> Node {
        let mesh = self.mesh(name.clone(), primitive);
        Node { mesh: Some(mesh), name: Some(name), ..Node::default() }
    }

    pub(super) fn mesh(&mut self, name: String, primitive: Primitive) -> Index<Mesh> {
        self.document.meshes.push(Mesh {
            extensions: None,
            extras: None,
            name: Some(name),
            primitives: vec![primitive],
            weights: None,
        })
    }

    pub(super) fn use_extension(&mut self, name: &str) {
        add_once(&mut self.document.root.extensions_used, name);
    }

    pub(super) fn require_extension(&mut self, name: &str) {
        self.use_extension(name);
        add_once(&mut self.document.root.extensions_required, name);
    }
}

fn add_once(names: &mut Vec<String>, name: &str) {
    if !names.iter().any(|known| known == name) {
        names.push(name.to_owned());
    }
}

/// The name of the buffer of all coarser levels of a chunk.
pub fn level_buffer(chunk: &str) -> String {
    format!("{chunk}_lods")
}

/// For each level, the full one first, the share of the screen that the chunk covers when the next level takes over; 0 for
/// the last.
///
/// A level takes over when its error `e` appears one pixel long. There a metre is `1/e` pixels, so the bounding sphere of
/// the chunk, with radius `r`, covers `π (r/e)²` pixels of a screen of 1920 × 1080, at any field of view.
fn screen_coverage(chunk: &Chunk) -> Vec<f32> {
    let [min, max] = chunk.visual.bounds().map(Point3::from);
    let radius_m = distance(&min, &max) / 2.0;
    let pixels = |error_m: f32| std::f32::consts::PI * (radius_m / error_m) * (radius_m / error_m);
    let share = |lod: &scene::Lod| (pixels(lod.error_m) / (SCREEN_PX[0] * SCREEN_PX[1])).min(1.0);
    chunk.lods.iter().map(share).chain([0.0]).collect()
}

pub(super) fn extras(value: &Value) -> Option<Box<RawValue>> {
    Some(RawValue::from_string(value.to_string()).expect("a JSON value prints as JSON"))
}
