//! Laws of every view of every cave: it is drawn, is not blank, and is the same for any number of threads.

use std::sync::atomic::AtomicBool;

use crate::common::world;
use plume::Recipe;
use plume::field::{CaveField, PassageSettings};
use plume::generators::GENERATORS;
use plume::graph::{Graph, StationId};
use plume::material::{Look, MATERIALS, MaterialRow};
use plume::pipeline::{self, Unobserved};
use plume::preview::{Drawn, Format, Order, Pace, PreviewError, Size, Subject, Theme, VIEWS, view};
use rayon::prelude::*;
use serde_json::{Value, json};

/// Stations of these caves, for generators with such a setting.
const NODES: u32 = 8;
/// Picture size: small, because every view of every generator in every rock is drawn in every format, twice.
const WIDTH: u32 = 80;
const HEIGHT: u32 = 60;

fn order(format: Format, stop: &AtomicBool) -> Order<'_> {
    Order {
        format,
        theme: Theme::Light,
        size: Some(Size::new(WIDTH, HEIGHT).unwrap()),
        at: None,
        look_rad: None,
        pace: Pace::new(2, 1.0).unwrap(),
        stop,
    }
}

/// Draws a view of a graph in a rock.
fn draw(graph: &Graph, rock: &MaterialRow, name: &str, order: &Order) -> Result<Drawn, PreviewError> {
    let passage = PassageSettings::default();
    let material = (rock.read)(json!({})).unwrap();
    let field = CaveField::new(graph, &passage, material, Look::default(), 5);
    let subject =
        Subject { name: "cave", graph, passage: &passage, field: &field, lamp_spacing_m: Some(9.0), furnishing: None };
    view(name).unwrap().draw(&subject, order)
}

fn with_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap().install(work)
}

/// Checks that a file is valid in its format and not blank.
fn judge(format: Format, drawn: &Drawn, what: &str) {
    match (format, drawn) {
        (Format::Svg, Drawn::File(bytes)) => judge_svg(std::str::from_utf8(bytes).unwrap(), what),
        (Format::Png, Drawn::File(bytes)) => judge_png(bytes, what),
        (Format::Gif, Drawn::File(bytes)) => judge_gif(bytes, what),
        (Format::Html, Drawn::File(bytes)) => judge_page(std::str::from_utf8(bytes).unwrap(), what),
        (Format::Frames, Drawn::Frames(frames)) => {
            assert_eq!(frames.len(), 2, "{what}");
            frames.iter().for_each(|frame| judge_png(frame, what));
        }
        _ => panic!("{what}: not what was asked for"),
    }
}

fn judge_png(bytes: &[u8], what: &str) {
    let image = image::load_from_memory(bytes).unwrap().to_rgb8();
    assert_eq!(image.dimensions(), (WIDTH, HEIGHT), "{what}");
    judge_pixels(image.as_raw(), what);
}

fn judge_gif(bytes: &[u8], what: &str) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).unwrap();
    let mut count = 0;
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!((u32::from(frame.width), u32::from(frame.height)), (WIDTH, HEIGHT), "{what}");
        judge_pixels(&frame.buffer, what);
        count += 1;
    }
    assert_eq!(count, 2, "{what}");
}

fn judge_pixels(bytes: &[u8], what: &str) {
    let values: Vec<f64> = bytes.iter().map(|&byte| f64::from(byte)).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / values.len() as f64;
    assert!(mean > 12.0 && variance > 60.0, "{what}: mean {mean:.1}, variance {variance:.1}");
}

fn judge_svg(text: &str, what: &str) {
    let document = roxmltree::Document::parse(text).unwrap();
    let count = |name: &str| document.descendants().filter(|node| node.has_tag_name(name)).count();
    let paths = document.descendants().filter(|node| node.tag_name().name() == "path").count();
    assert!(paths > 10, "{what}: {paths} paths");
    assert_eq!(count("text") + count("image") + count("style"), 0, "{what}: a viewer may show this otherwise");
    for path in document.descendants().filter_map(|node| node.attribute("d")) {
        assert!(!path.contains("NaN") && !path.contains("inf"), "{what}: {path}");
    }
}

fn judge_page(text: &str, what: &str) {
    let data = text.split_once("id=\"cave\">").unwrap().1.split_once("</script>").unwrap().0;
    let cave: Value = serde_json::from_str(data).unwrap();
    assert!(!cave["solid"]["triangles"].as_str().unwrap().is_empty(), "{what}");
    assert!(!text.contains("http://") && !text.contains("https://"), "{what}: a page needs no network");
}

#[test]
fn every_view_of_every_cave_is_drawn_alike_by_any_number_of_threads() {
    let stop = AtomicBool::new(false);
    world::kinds().into_par_iter().for_each(|(generator, material)| {
        let graph = world::small(generator, NODES, 4);
        for (row, format) in VIEWS.iter().flat_map(|row| row.formats.iter().map(move |&format| (row, format))) {
            let what = format!("{} in {}: {} as {format:?}", generator.name, material.name, row.name);
            let order = order(format, &stop);
            let [one, four] = [1, 4].map(|threads| {
                with_threads(threads, || draw(&graph, material, row.name, &order))
                    .unwrap_or_else(|e| panic!("{what}: {e}"))
            });
            assert!(one == four, "{what}");
            judge(format, &one, &what);
        }
    });
}

#[test]
fn a_map_is_drawn_as_it_was() {
    let stop = AtomicBool::new(false);
    let file = GENERATORS.iter().find(|row| row.name == "file").unwrap();
    let graph = world::small(file, NODES, 0);
    for name in ["plan", "profile"] {
        let order = Order { size: Some(Size::new(160, 120).unwrap()), ..order(Format::Svg, &stop) };
        let Drawn::File(svg) = draw(&graph, MATERIALS.default_row(), name, &order).unwrap() else {
            panic!("a map is a file");
        };
        insta::assert_snapshot!(name, String::from_utf8(svg).unwrap());
    }
}

#[test]
fn a_theme_changes_a_map() {
    let stop = AtomicBool::new(false);
    let graph = world::small(GENERATORS.default_row(), NODES, 0);
    let light = order(Format::Svg, &stop);
    let dark = Order { theme: Theme::Dark, ..order(Format::Svg, &stop) };
    assert_ne!(
        draw(&graph, MATERIALS.default_row(), "plan", &light),
        draw(&graph, MATERIALS.default_row(), "plan", &dark)
    );
}

#[test]
fn a_large_graph_makes_no_larger_map() {
    let stop = AtomicBool::new(false);
    let mut graph = world::small(GENERATORS.default_row(), NODES, 0);
    let (template, side) = (graph.nodes[0].clone(), 300);
    graph.nodes = (0..side * side)
        .map(|i| {
            let mut node = template.clone();
            (node.id, node.parent) = (i as u64, (i > 0).then_some(StationId::new(0)));
            node.position = [(i % side) as f64 * 3.0, (i / side) as f64 * 3.0, (i % 7) as f64].into();
            node
        })
        .collect();
    let across = (0..side * side).filter(|i| i % side > 0).map(|i| [i - 1, i]);
    let edges = across.chain((side..side * side).map(|i| [i - side, i]));
    let graph = Graph::new(graph.nodes, StationId::pairs(edges));
    for name in ["plan", "profile"] {
        let Ok(Drawn::File(svg)) = draw(&graph, MATERIALS.default_row(), name, &order(Format::Svg, &stop)) else {
            panic!("a map is a file");
        };
        assert!(svg.len() < 8_000_000, "{name}: {} bytes", svg.len());
    }
}

#[test]
fn a_flight_takes_the_time_that_was_asked_for() {
    let stop = AtomicBool::new(false);
    let graph = world::small(GENERATORS.default_row(), NODES, 0);
    let size = Some(Size::new(16, 16).unwrap());
    let order = Order { size, pace: Pace::new(30, 1.0).unwrap(), ..order(Format::Gif, &stop) };
    let Drawn::File(bytes) = draw(&graph, MATERIALS.default_row(), "flight", &order).unwrap() else {
        panic!("a GIF is a file");
    };
    let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
    let mut hundredths = 0;
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        hundredths += frame.delay;
    }
    assert_eq!(hundredths, 100);
}

#[test]
fn what_cannot_be_seen_is_told() {
    let stop = AtomicBool::new(false);
    let graph = world::small(GENERATORS.default_row(), NODES, 0);
    let png = order(Format::Png, &stop);
    assert_eq!(draw(&Graph::default(), MATERIALS.default_row(), "plan", &png), Err(PreviewError::NoPassages));
    let above = Order { at: Some([0.0, 0.0, 500.0]), ..order(Format::Png, &stop) };
    assert_eq!(draw(&graph, MATERIALS.default_row(), "inside", &above), Err(PreviewError::InRock([0.0, 0.0, 500.0])));
    for size in ["", "10", "10x10", "640x", "x480", "640x9000", "-640x480", "640x480x3"] {
        assert_eq!(size.parse::<Size>(), Err(PreviewError::Size), "{size}");
    }
    for (fps, seconds) in [(0, 1.0), (51, 1.0), (10, 0.0), (10, 601.0), (10, f64::NAN)] {
        assert_eq!(Pace::new(fps, seconds), Err(PreviewError::Pace));
    }
    let size = Some(Size::new(8192, 8192).unwrap());
    let endless = Order { size, pace: Pace::new(50, 600.0).unwrap(), ..order(Format::Gif, &stop) };
    assert_eq!(draw(&graph, MATERIALS.default_row(), "flight", &endless), Err(PreviewError::Long));
    let stopped = AtomicBool::new(true);
    for (name, format) in [("inside", Format::Png), ("flight", Format::Gif), ("page", Format::Html)] {
        assert_eq!(
            draw(&graph, MATERIALS.default_row(), name, &order(format, &stopped)),
            Err(PreviewError::Stopped),
            "{name}"
        );
    }
}

#[test]
fn views_show_things_on_any_number_of_threads() {
    let stop = AtomicBool::new(false);
    let graph = world::small(GENERATORS.default_row(), NODES, 3);
    let recipe = Recipe::from_overrides(&[]).unwrap();
    let field = pipeline::field(&recipe, &graph);
    let files = pipeline::user_files(&recipe, &Unobserved::default()).unwrap();
    let stock = pipeline::stock(&recipe, &files).unwrap();
    for row in VIEWS.iter().filter(|row| row.shows_things) {
        let order = Order { size: Some(Size::new(640, 360).unwrap()), ..order(row.formats[0], &stop) };
        let bare = row.draw(&pipeline::subject(&recipe, &graph, &field), &order).unwrap();
        let furnished = |threads| {
            let subject = pipeline::furnished(&recipe, &graph, &field, Some(&stock));
            with_threads(threads, || row.draw(&subject, &order).unwrap())
        };
        let one = furnished(1);
        assert!(one != bare, "{} shows no things", row.name);
        assert!(one == furnished(3), "{} depends on the number of threads", row.name);
    }
}
