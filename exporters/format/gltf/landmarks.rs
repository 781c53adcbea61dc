//! Surveyed stations, as empty nodes.

use gltf_json::Node;
use serde_json::json;

use super::layout::{Layout, extras};
use crate::frame;
use crate::scene::Landmark;

impl Layout {
    /// Adds an empty node for each station, named like its frame; what the survey calls it is in the extras.
    pub fn add_landmarks(&mut self, landmarks: &[Landmark]) {
        for Landmark { frame, label, position, .. } in landmarks {
            let position = frame::gltf_from_scene::<f64>((*position).into());
            self.add_node(Node {
                name: Some(frame.clone()),
                translation: Some(position.map(|metres| metres as f32)),
                extras: extras(&json!({ "station": label })),
                ..Node::default()
            });
        }
    }
}
