//! Things: a model for each prototype, a prefab for each way in which things show it, and instances of the prefabs.
//!
//! ```text
//! Runtime/Meshes/<prototype>.fbx
//! Runtime/Things/<prototype>_level<n>[_movable].prefab
//! ```

use std::collections::BTreeMap;
use std::io::Write;

use super::asset::Importer;
use super::prefab::{Collider, Model, Prefab, Source};
use super::{Writer, maps, material, texture};
use crate::error::ExportError;
use crate::format::fbx;
use crate::names;
use crate::scene::{Chunk, Instance, Prototype, Scene};

/// The things of a scene, and what has been written of them.
pub struct Things {
    prototypes: Vec<Prototype>,
    /// Models by prototype.
    models: BTreeMap<String, Model>,
    /// Prefabs by name.
    sources: BTreeMap<String, Source>,
    /// Game objects of things, and the chunks that these are in.
    groups: Vec<(usize, usize)>,
}

impl Things {
    /// Those of a scene.
    ///
    /// # Errors
    /// As [`Scene::prototypes`].
    pub fn of(scene: &Scene) -> Result<Self, ExportError> {
        let prototypes = scene.prototypes()?;
        Ok(Self { prototypes, models: BTreeMap::new(), sources: BTreeMap::new(), groups: Vec::new() })
    }

    /// Whether a package has any.
    pub fn are_there(&self) -> bool {
        !self.sources.is_empty()
    }

    /// Writes them below their game objects in the prefab of the scene. They are loaded again, so that one chunk of them is in
    /// memory.
    ///
    /// # Errors
    /// If they cannot be loaded or are others than before, and those of `file`.
    pub fn write(&self, scene: &Scene, prefab: &Prefab, file: &mut dyn Write) -> Result<(), ExportError> {
        for &(group, index) in &self.groups {
            let things = scene.instances(index)?;
            let with_source = |thing| Some((thing, *self.sources.get(&prefab_name(thing))?));
            let things: Option<Vec<_>> = things.iter().map(with_source).collect();
            let fault = || format!("the things of chunk {index} have changed meanwhile");
            let things = things.ok_or_else(|| ExportError::BadScene { scene: scene.name.clone(), fault: fault() })?;
            prefab.write_things(group, &things, file)?;
        }
        Ok(())
    }
}

impl Writer<'_> {
    /// Adds instances for the things of a chunk, and writes what they share. Returns the number of their collision triangles.
    pub(super) fn add_things(&mut self, chunk: &Chunk, index: usize) -> Result<u64, ExportError> {
        let (group, things) = (self.prefab.add_group(&chunk.name), self.scene.instances(index)?);
        self.things.groups.push((group, index));
        let mut triangles = 0;
        for thing in &things {
            triangles += thing.prototype_in(&self.things.prototypes)?.hull.triangles();
            let source = self.source(thing)?;
            self.prefab.add_thing(group, thing, &source);
        }
        Ok(triangles)
    }

    /// The prefab of which a thing is an instance, written on first use.
    fn source(&mut self, thing: &Instance) -> Result<Source, ExportError> {
        let name = prefab_name(thing);
        if let Some(source) = self.things.sources.get(&name) {
            return Ok(*source);
        }
        let prototype = thing.prototype_in(&self.things.prototypes)?.clone();
        let model = self.model(&prototype)?;
        let friction = self.friction(prototype.zone)?;
        let collider = collider_name(&prototype);
        let collider = Collider { mesh: &collider, convex: true, friction };
        let prefab = Prefab::of_thing(&name, &prototype, thing, &collider, model);
        let path = format!("Runtime/Things/{name}.prefab");
        let source = prefab.source(self.assets.write(&path, Importer::Prefab, |file| Ok(prefab.write(file)?))?);
        self.things.sources.insert(name, source);
        Ok(source)
    }

    /// The model of a prototype, written on first use.
    fn model(&mut self, prototype: &Prototype) -> Result<Model, ExportError> {
        if let Some(model) = self.things.models.get(&prototype.name) {
            return Ok(*model);
        }
        // Prototypes may share images, so these are clamped or not for all of them.
        let alike = self.things.prototypes.iter().filter(|other| other.material == prototype.material);
        let meshes: Vec<_> = alike.flat_map(|other| other.levels.iter().map(|level| &level.mesh)).collect();
        let textures = texture::write(&prototype.material, &meshes, &mut self.assets)?;
        let name = &prototype.material.name;
        let material = material::write(name, self.settings.pipeline, &textures, &mut self.assets)?;
        let levels = prototype.levels.iter().enumerate().map(|(number, level)| fbx::Level {
            name: names::level(&prototype.name, number),
            mesh: &level.mesh,
            error_m: level.error_m,
        });
        let part = fbx::Part {
            name: &prototype.name,
            levels: levels.collect(),
            colliders: vec![fbx::Collider { name: collider_name(prototype), mesh: &prototype.hull }],
            material: name,
            maps: &maps(&textures),
        };
        let model = Model { guid: self.write_model(&part, material)?, material };
        self.things.models.insert(prototype.name.clone(), model);
        Ok(model)
    }
}

/// The prefab of which a thing is an instance.
fn prefab_name(thing: &Instance) -> String {
    let movable = if thing.movable { "_movable" } else { "" };
    format!("{}_level{}{movable}", thing.prototype, thing.level)
}

fn collider_name(prototype: &Prototype) -> String {
    format!("{}_collision", prototype.name)
}
