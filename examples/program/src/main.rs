//! Makes a small cave and exports it, in a Rust program of your own: `cargo run -- FOLDER`.

use std::error::Error;
use std::path::PathBuf;

use plume::cave::{self, Order};
use plume::exporters::place::{Existing, Place};
use plume::{Cave, CaveFolder, Input, Observer, Recipe, Unobserved};

fn main() -> Result<(), Box<dyn Error>> {
    let home = PathBuf::from(std::env::args_os().nth(1).ok_or("name a folder")?);
    let settings = ["graph.nodes=3", "mesh.voxel_m=0.5", "texture.density_px_per_m=8"].map(str::to_owned);
    let input = Input::of(Recipe::from_overrides(&settings)?);
    let watch = Unobserved::default();
    let cave = Cave::make(input, CaveFolder::open_or_new(&home.join("cave"))?, false, &watch, &mut |_, _| ())?;

    let wanted = cave::build(vec![cave::target("gltf")?], &[], &[], None)?;
    let place = |path| Place { path, bundle: None, existing: Existing::Keep };
    let orders: Vec<Order> =
        wanted.into_iter().map(|wanted| Order { wanted, place: place(home.join("package")) }).collect();
    let chunks = cave.chunks(watch.stop());
    cave::export(&cave.scene(&chunks), &orders)?;
    println!("{} stations, {} chunks", cave.graph().stations().count(), cave.chunk_names().count());
    Ok(())
}
