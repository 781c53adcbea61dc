//! Instances of prefabs within a prefab.

use serde::Serialize;

use super::identity;
use super::prefab::Source;
use crate::frame::{micro, unity_from_scene, unity_rotation_from_scene};
use crate::names;
use crate::scene::Instance;

/// Number of the class `PrefabInstance`.
const PREFAB_INSTANCE: u32 = 1001;

/// The ids of an instance of the prefab of a thing.
#[derive(Clone, Copy, Serialize)]
pub struct Nesting {
    instance: i64,
    /// The transform of its root in this prefab.
    pub transform: i64,
}

/// An instance of the prefab of a thing, for the template.
#[derive(Serialize)]
pub struct Nested {
    #[serde(flatten)]
    ids: Nesting,
    father: i64,
    source: Source,
    changes: Vec<Change>,
}

/// What an instance has otherwise than its prefab.
#[derive(Serialize)]
struct Change {
    target: i64,
    path: String,
    value: String,
}

impl Nesting {
    /// The ids of a thing below the game object at `path`.
    pub fn new(path: &str, thing: &Instance, source: &Source) -> Self {
        let instance = identity::object(&format!("{path}/{}", names::thing(thing)), PREFAB_INSTANCE);
        Self { instance, transform: identity::nested(instance, source.transform) }
    }
}

impl Nested {
    /// An instance at the place of a thing, below the game object at `path`, whose transform is `father`; the `order`th there.
    pub fn new(path: &str, father: i64, order: usize, thing: &Instance, source: Source) -> Self {
        let ids = Nesting::new(path, thing, &source);
        let position = unity_from_scene::<f64>(thing.pose.translation.vector.into());
        let rotation = unity_rotation_from_scene(&thing.pose.rotation);
        let mut changes = vec![Change { target: source.object, path: "m_Name".to_owned(), value: names::thing(thing) }];
        let mut change = |target, path: String, value| changes.push(Change { target, path, value });
        change(source.transform, "m_RootOrder".to_owned(), order.to_string());
        for (property, numbers) in
            [("m_LocalPosition", &position[..]), ("m_LocalRotation", &rotation), ("m_LocalScale", &[thing.scale; 3])]
        {
            for (axis, number) in "xyzw".chars().zip(numbers) {
                change(source.transform, format!("{property}.{axis}"), micro(*number));
            }
        }
        if let Some(body) = source.body {
            change(body, "m_Mass".to_owned(), micro(thing.mass_kg));
        }
        Self { ids, father, source, changes }
    }
}
