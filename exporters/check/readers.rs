//! Readers of files by extension, which also find the references in them.
//!
//! A reader parses enough to tell an intact file from a broken one, and notes every reference to another file. A new format
//! is a row of [`READERS`]; files with other extensions are only hashed.

use super::content::{Content, Unfit};
use super::found::Found;

mod fbx;
mod gltf;
mod gzip;
mod image;
mod json;
mod las;
mod map;
mod mcap;
mod msh;
mod npz;
mod obj;
mod octomap;
mod pcd;
mod ply;
mod stl;
mod tiff;
mod unity;
mod usd;
mod usdz;
mod xml;

type Reader = fn(&mut Content<'_>, &mut Found) -> Result<(), Unfit>;

/// Extensions, and what reads such files.
static READERS: &[(&[&str], Reader)] = &[
    (&["bt"], octomap::read),
    (&["fbx"], fbx::read),
    (&["glb"], gltf::read_binary),
    (&["gltf"], gltf::read_text),
    (&["gz"], gzip::read),
    (&["jpg", "jpeg"], image::read_jpeg),
    (&["json", "asmdef", "asmref", "uplugin"], json::read),
    (&["ktx2"], image::read_ktx2),
    (&["las"], las::read),
    (&["mcap"], mcap::read),
    (&["md", "txt", "py", "cs", "csv", "svx"], read_plain),
    (&["meta", "prefab", "mat", "physicmaterial", "asset", "unity"], unity::read),
    (&["msh"], msh::read),
    (&["mtl"], obj::read_materials),
    (&["npz"], npz::read),
    (&["obj"], obj::read),
    (&["pcd"], pcd::read),
    (&["ply"], ply::read),
    (&["png"], image::read_png),
    (&["stl"], stl::read),
    (&["tif"], tiff::read),
    (&["usda"], usd::read_text),
    (&["usdc"], usd::read_crate),
    (&["usdz"], usdz::read),
    (&["webp"], image::read_webp),
    (&["yaml"], map::read),
    (&["xml", "sdf", "urdf", "xacro", "world", "config", "mjcf", "dae", "x3d", "graphml"], xml::read),
];

/// Reads a file by its extension.
pub fn read(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    match reader(content.path()) {
        Some(read) => read(content, found),
        None => Ok(()),
    }
}

/// Whether a text ends with an extension that has a reader.
pub fn is_file_name(text: &str) -> bool {
    reader(text).is_some()
}

fn reader(path: &str) -> Option<Reader> {
    let extension = path.rsplit('/').next()?.rsplit_once('.')?.1.to_ascii_lowercase();
    READERS.iter().find(|(extensions, _)| extensions.contains(&&*extension)).map(|(_, read)| *read)
}

fn read_plain(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    content.text().map(drop)
}
