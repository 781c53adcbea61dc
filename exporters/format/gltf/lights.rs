//! Lights by KHR_lights_punctual, in candela.

use gltf_json::extensions::root::KhrLightsPunctual;
use gltf_json::extensions::scene::khr_lights_punctual;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Node};

use super::layout::Layout;
use crate::frame;
use crate::scene::Light;

impl Layout {
    /// Adds a node for each light.
    pub fn add_lights(&mut self, lights: &[Light]) {
        if lights.is_empty() {
            return;
        }
        self.use_extension("KHR_lights_punctual");
        let table = KhrLightsPunctual { lights: lights.iter().map(punctual).collect() };
        self.document.root.extensions.get_or_insert_default().khr_lights_punctual = Some(table);
        for (index, light) in (0..).zip(lights) {
            let reference = khr_lights_punctual::KhrLightsPunctual { light: Index::new(index) };
            let position = frame::gltf_from_scene::<f64>(light.position.into());
            let mut node = Node {
                name: Some(light.name.clone()),
                translation: Some(position.map(|metres| metres as f32)),
                ..Node::default()
            };
            node.extensions.get_or_insert_default().khr_lights_punctual = Some(reference);
            self.add_node(node);
        }
    }
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
