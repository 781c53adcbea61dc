//! XML of all kinds: SDF, URDF, MJCF, ROS and Gazebo manifests, COLLADA, X3D.

use roxmltree::{Document, Node, ParsingOptions};

use super::{Content, Found, Unfit};

/// The longest text that is parsed, which takes up to ten times its size. A convex piece takes about a kilobyte.
const MOST_BYTES: u64 = 1 << 26;
/// Most elements and texts of a file: a cave of 100,000 convex pieces has a fifth of that.
const MOST_NODES: u32 = 2_000_000;
/// Most attributes of an element. Their names are compared with each other.
const MOST_ATTRIBUTES: usize = 1000;
/// Prefixes of attributes that name files.
const FILE_ATTRIBUTES: [&str; 1] = ["file"];
/// Elements whose text is a file name.
const FILE_ELEMENTS: [&str; 10] = [
    "uri",
    "sdf",
    "init_from",
    "albedo_map",
    "normal_map",
    "roughness_map",
    "metalness_map",
    "emissive_map",
    "light_map",
    "ambient_occlusion_map",
];

/// Reads any XML.
pub fn read(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let text = String::from_utf8(content.rest_up_to(MOST_BYTES)?).map_err(|_| Unfit::from("is not UTF-8"))?;
    if text.split('<').any(|tag| tag.bytes().filter(|&byte| byte == b'=').count() > MOST_ATTRIBUTES) {
        return Err(Unfit(format!("has an element with more than {MOST_ATTRIBUTES} attributes")));
    }
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document =
        Document::parse_with_options(&text, options).map_err(|error| Unfit(format!("is not valid XML: {error}")))?;
    for node in document.descendants().filter(Node::is_element) {
        read_element(node, &document, content.path(), found);
    }
    Ok(())
}

fn read_element(node: Node<'_, '_>, document: &Document<'_>, path: &str, found: &mut Found) {
    let name = node.tag_name().name();
    // A plugin is a library of the simulator, and the root of an SDF does not name a file.
    if name == "plugin" || (name == "sdf" && node.parent_element().is_none()) {
        return;
    }
    let folder = format!("{}{}", including_folder(document, path), asset_folder(name, document));
    for attribute in node.attributes().filter(|attribute| is_file(attribute.name())) {
        found.reference(path, format!("{folder}{}", attribute.value()));
    }
    if is_file_element(node)
        && let Some(to) = node.text().map(str::trim).filter(|to| !to.is_empty())
    {
        found.reference(path, to);
    }
}

/// In COLLADA, `init_from` of an image names a file, but that of a surface names an image.
fn is_file_element(node: Node<'_, '_>) -> bool {
    let is_of_surface = || node.parent_element().is_some_and(|parent| parent.tag_name().name() == "surface");
    let name = node.tag_name().name();
    FILE_ELEMENTS.contains(&name) && !(name == "init_from" && is_of_surface())
}

fn is_file(attribute: &str) -> bool {
    FILE_ATTRIBUTES.iter().any(|start| attribute.starts_with(start))
}

/// From the folder of a part of MJCF to that of the model that includes it, which is above all of its parts: MuJoCo looks for files there.
fn including_folder(document: &Document<'_>, path: &str) -> String {
    let depth = if document.root_element().has_tag_name("mujocoinclude") { path.matches('/').count() } else { 0 };
    "../".repeat(depth)
}

/// The folder in which MJCF looks for the files of an element, with a trailing slash.
fn asset_folder(element: &str, document: &Document<'_>) -> String {
    let key = match element {
        "mesh" | "hfield" | "skin" => "meshdir",
        "texture" => "texturedir",
        _ => return String::new(),
    };
    let compilers = document.root_element().children().filter(|node| node.has_tag_name("compiler"));
    // The last one wins.
    let folder = compilers.rev().find_map(|node| node.attribute(key).or(node.attribute("assetdir")));
    folder.map_or_else(String::new, |folder| format!("{}/", folder.trim_end_matches('/')))
}
