//! Contrast of every rock in a preview of the default cave, from one place with a headlamp.

use std::sync::atomic::AtomicBool;

use crate::texture_support::bands::{Band, Image};
use plume::Recipe;
use plume::graph::NoOutside;
use plume::material::MATERIALS;
use plume::pipeline;
use plume::preview::{Drawn, Format, Order, Pace, Size, Theme, view};

/// Width and height of the picture.
const SIZE_PX: [u32; 2] = [960, 540];
/// Side of the tiles of which the median counts.
const TILE_PX: usize = 60;
/// Luminance of pixels that are neither in the dark nor overexposed.
const LIT: std::ops::Range<f64> = 0.012..0.8;
/// What no lamp reaches has no contrast.
const DARKEST: f64 = 0.004;
/// Octaves of wavelengths in pixels.
const OCTAVES: [Band; 3] = [Band(3.2), Band(6.4), Band(12.8)];

/// What each rock must have: root mean square of the binary logarithm of the luminance in each octave, and the 95th percentile
/// of its slope. A few percent less than it has.
const LEAST: [(&str, [f64; 4]); 4] = [
    ("limestone", [0.16, 0.17, 0.19, 0.83]),
    ("basalt", [0.15, 0.155, 0.17, 0.78]),
    ("drilled", [0.17, 0.18, 0.175, 0.88]),
    ("salt", [0.145, 0.145, 0.14, 0.73]),
];

#[test]
fn rocks_have_contrast_from_a_few_metres() {
    assert!(LEAST.map(|(rock, _)| rock).into_iter().eq(MATERIALS.iter().map(|row| row.name)));
    let mut flat = vec![];
    for (rock, least) in LEAST {
        let found = contrast(&preview(rock));
        if found.iter().zip(least).any(|(found, least)| *found < least) {
            flat.push(format!("{rock}: {found:.3?} instead of {least:.3?}"));
        }
    }
    assert!(flat.is_empty(), "{flat:#?}");
}

/// The luminance of a preview, row by row.
fn preview(rock: &str) -> Vec<f64> {
    let recipe = Recipe::from_overrides(&["seed=7".to_owned(), format!("rock.kind={rock}")]).unwrap();
    let graph = recipe.graph().generate(recipe.seed(), &NoOutside).unwrap();
    let field = pipeline::field(&recipe, &graph);
    let order = Order {
        format: Format::Png,
        theme: Theme::Light,
        size: Some(Size::new(SIZE_PX[0], SIZE_PX[1]).unwrap()),
        at: Some([-12.886, -3.932, -1.092]),
        look_rad: Some([47.0, -8.0].map(f32::to_radians)),
        pace: Pace::new(2, 1.0).unwrap(),
        stop: &AtomicBool::new(false),
    };
    let Drawn::File(png) = view("inside").unwrap().draw(&pipeline::subject(&recipe, &graph, &field), &order).unwrap()
    else {
        panic!("not a file");
    };
    let picture = image::load_from_memory(&png).unwrap().to_rgb8();
    picture.pixels().map(|pixel| luminance(pixel.0)).collect()
}

/// Of a colour in sRGB.
fn luminance(color: [u8; 3]) -> f64 {
    let linear = color.map(|byte| {
        let encoded = f64::from(byte) / 255.0;
        if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
    });
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

/// Deviation in each octave, and the 95th percentile of the slope: the medians of tiles that are lit.
fn contrast(luminance: &[f64]) -> [f64; 4] {
    let mut tiles: [Vec<f64>; 4] = [const { vec![] }; 4];
    let [width, height] = SIZE_PX.map(|side| side as usize);
    // The octaves of a tile need pixels around it.
    let margin = OCTAVES.map(|octave| octave.reach_m().ceil() as usize).into_iter().fold(0, usize::max);
    let side = TILE_PX + 2 * margin;
    for top in (0..=height - side).step_by(TILE_PX) {
        for left in (0..=width - side).step_by(TILE_PX) {
            let pixels = || (0..side * side).map(|at| luminance[(top + at / side) * width + left + at % side]);
            if !LIT.contains(&mean(pixels())) {
                continue;
            }
            let stops = Image { side, values: pixels().map(|luminance| libm::log2(luminance + DARKEST)).collect() };
            for (octave, tiles) in OCTAVES.iter().zip(&mut tiles) {
                tiles.push(deviation(&octave.of(&stops, 1.0, margin)));
            }
            tiles[3].push(percentile(slopes(&stops), 0.95));
        }
    }
    tiles.map(|tiles| percentile(tiles, 0.5))
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    sum / count
}

fn deviation(values: &[f64]) -> f64 {
    let mean_value = mean(values.iter().copied());
    mean(values.iter().map(|value| (value - mean_value) * (value - mean_value))).sqrt()
}

/// Magnitudes of the gradient, without the rim.
fn slopes(image: &Image) -> Vec<f64> {
    let inner = 1..image.side - 1;
    let pixels = inner.clone().flat_map(|y| inner.clone().map(move |x| y * image.side + x));
    let along = |at: usize, step: usize| 0.5 * (image.values[at + step] - image.values[at - step]);
    pixels.map(|at| libm::hypot(along(at, 1), along(at, image.side))).collect()
}

fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(share * (values.len() - 1) as f64) as usize]
}
