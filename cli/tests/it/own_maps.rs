//! Maps of the user's own on the rock: what they change, errors word by word, and folders that keep them.

use std::fs;

use crate::command;
use command::{Desk, SMALL, files};
use image::{DynamicImage, GrayImage, Luma, Rgb, RgbImage, RgbaImage};
use insta::assert_snapshot;

const RED: Rgb<u8> = Rgb([255, 0, 0]);

/// A desk with a recipe and a folder of maps beside it.
fn desk() -> Desk {
    let desk = Desk::new();
    fs::create_dir(desk.path("tiles")).unwrap();
    desk.file("cave.toml", "[texture]\nown = \"tiles\"\nformat = \"png\"\n");
    put(&desk, "tiles/base_color.png", RgbImage::from_pixel(4, 4, RED));
    desk
}

fn put(desk: &Desk, path: &str, image: impl Into<DynamicImage>) {
    image.into().save(desk.path(path)).unwrap();
}

/// The pixels of the images of chunks, or of things, whose names end so, without the colour of rows that show nothing.
fn pixels(desk: &Desk, [start, ending]: [&str; 2], blank: Rgb<u8>) -> Vec<Rgb<u8>> {
    let is_meant = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.starts_with(start) && name.ends_with(ending)
    };
    let images = files(&desk.path("cave/textures")).into_iter().filter(is_meant);
    images
        .flat_map(|path| image::open(path).unwrap().into_rgb8().pixels().copied().collect::<Vec<_>>())
        .filter(|pixel| *pixel != blank)
        .collect()
}

#[test]
fn the_rock_and_its_stones_look_like_the_maps() {
    let desk = desk();
    put(&desk, "tiles/roughness.png", GrayImage::from_pixel(2, 2, Luma([64])));
    desk.make(&["generate", "cave.toml", "--output", "cave"]);
    desk.make(&["mesh", "--output", "plain"]);
    let colors = pixels(&desk, ["chunk", "_base_color.png"], Rgb([128; 3]));
    assert!(!colors.is_empty() && colors.iter().all(|color| *color == RED));
    let orm = pixels(&desk, ["chunk", "_orm.png"], Rgb([255, 255, 0]));
    assert!(!orm.is_empty() && orm.iter().all(|pixel| pixel[1] == 64));
    // Beside stones there are things that are not of this rock.
    let things = pixels(&desk, ["things", "_base_color.png"], Rgb([128; 3]));
    assert!(2 * things.iter().filter(|color| **color == RED).count() > things.len());
    for name in ["chunks", "collision"] {
        assert_eq!(desk.hashes(&format!("cave/{name}")), desk.hashes(&format!("plain/{name}")), "{name}");
    }
}

#[test]
fn maps_make_the_same_bytes_on_any_number_of_threads() {
    let desk = desk();
    let code = |x: u32, y: u32| (31 * x + 17 * y * y) as u8;
    put(&desk, "tiles/base_color.png", RgbImage::from_fn(64, 64, |x, y| Rgb([code(x, y), code(y, x), 90])));
    put(&desk, "tiles/normal.png", RgbImage::from_fn(48, 48, |x, y| Rgb([code(x, y), code(y, x), 200])));
    desk.make(&["generate", "cave.toml", "--output", "one", "--threads", "1"]);
    desk.make(&["generate", "cave.toml", "--output", "many", "--threads", "4"]);
    assert_eq!(desk.hashes("one"), desk.hashes("many"));
}

#[test]
fn unfit_maps_are_reported() {
    let desk = desk();
    let mut told = String::new();
    let mut fault = |desk: &Desk| told += &desk.fault(&["generate", "cave.toml", "--output", "cave"]);
    fs::remove_file(desk.path("tiles/base_color.png")).unwrap();
    fault(&desk);
    desk.file("tiles/base_color.png", "a text");
    fault(&desk);
    put(&desk, "tiles/base_color.png", RgbImage::new(4, 2));
    fault(&desk);
    put(&desk, "tiles/base_color.png", RgbImage::new(4, 4));
    put(&desk, "tiles/normal.png", GrayImage::new(4, 4));
    fault(&desk);
    put(&desk, "tiles/normal.png", RgbImage::new(4, 4));
    put(&desk, "tiles/roughness.png", RgbaImage::new(4, 4));
    fault(&desk);
    put(&desk, "tiles/roughness.png", GrayImage::new(8193, 1));
    fault(&desk);
    assert_snapshot!("own_maps_unfit", told);
    assert!(!desk.path("cave").exists());
}

/// The folder has all that it needs, and follows a changed map: images alone are made again.
#[test]
fn folders_keep_maps_and_follow_their_changes() {
    let desk = desk();
    let green = || RgbImage::from_pixel(4, 4, Rgb([0, 255, 0]));
    desk.make(&["generate", "cave.toml", "--output", "cave"]);
    let whole = desk.hashes("cave");
    put(&desk, "tiles/base_color.png", green());
    let other = [&["generate", "cave.toml", "--output", "cave"][..], &SMALL].concat();
    assert!(desk.fault(&other).contains("holds another cave"));
    fs::remove_dir_all(desk.path("tiles")).unwrap();
    assert!(desk.run(&["generate", "cave"]).status.success());
    assert_eq!(whole, desk.hashes("cave"));
    put(&desk, "cave/maps/base_color.png", green());
    let status = String::from_utf8(desk.run(&["status", "cave"]).stdout).unwrap();
    for line in ["graph     outdated", "mesh      done", "texture   outdated"] {
        assert!(status.contains(line), "{status}");
    }
    assert!(desk.run(&["generate", "cave"]).status.success());
    let now = desk.hashes("cave");
    let remade: Vec<&str> = whole.iter().filter(|file| !now.contains(file)).map(|(path, _)| path.as_str()).collect();
    assert!(remade.iter().all(|path| *path == "manifest.json" || path.ends_with("base_color.png")), "{remade:?}");
    assert!(
        remade.contains(&"maps/base_color.png") && remade.contains(&"textures/things_base_color.png"),
        "{remade:?}"
    );
}
