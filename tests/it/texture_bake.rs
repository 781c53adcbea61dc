//! Laws of baked maps, read back as a renderer reads them.

use std::io;

use crate::texture_support::{Gradient, bubble, cross, dot, rough_passage, spiral, unit};
use image::RgbImage;
use plume::exporters::ImageFormat;
use plume::mesh::Mesh;
use plume::texture::encode::{Channels, MapWriter};
use plume::texture::settings::{MapFormats, TextureSettings};
use plume::texture::{HEIGHT_AMPLITUDE_M, Maps, TextureError, Textured, texture};

const UPRIGHT: Gradient = Gradient { tilt: [0.0; 3] };
const LEANING: Gradient = Gradient { tilt: [0.3, -0.2, 0.35] };

fn bake(mesh: &Mesh, surface: &Gradient, settings: &TextureSettings) -> (Textured, Maps<Vec<u8>>) {
    let mut maps = Maps { height: settings.height.then(Vec::new), ..Maps::default() };
    let textured = texture(mesh, surface, settings, maps.as_mut()).expect("vectors take all bytes");
    (textured, maps)
}

/// Maps without loss.
fn of_size(size_px: u32) -> TextureSettings {
    TextureSettings { size_px: Some(size_px), format: MapFormats::Png, ..TextureSettings::default() }
}

fn picture(bytes: &[u8]) -> RgbImage {
    image::load_from_memory(bytes).expect("a map is a picture").to_rgb8()
}

fn meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("passage", rough_passage(120, 60, 15.0, 3)),
        ("spiral", spiral(3.0, 240, 30)),
        ("bubble", bubble(40, 60, 4.0)),
    ]
}

fn to_srgb(linear: f32) -> f64 {
    let c = f64::from(linear);
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * libm::pow(c, 1.0 / 2.4) - 0.055 };
    encoded * 255.0
}

/// A texel centre inside a triangle, with its pixel and the weights of the corners there.
struct Sample {
    triangle: [usize; 3],
    pixel: [u32; 2],
    weights: [f64; 3],
}

impl Sample {
    fn mix<const N: usize>(&self, of: &[[f32; N]]) -> [f64; N] {
        std::array::from_fn(|k| (0..3).map(|c| self.weights[c] * f64::from(of[self.triangle[c]][k])).sum())
    }
}

/// The texel nearest to the centre of each triangle, if the texel's centre is well inside.
fn samples(textured: &Textured) -> Vec<Sample> {
    let size = f64::from(textured.size_px);
    let sample = |triangle: &[u32; 3]| {
        let triangle = triangle.map(|v| v as usize);
        let [a, b, c] = triangle.map(|v| textured.uvs[v].map(|x| f64::from(x) * size));
        let at = [0, 1].map(|k| ((a[k] + b[k] + c[k]) / 3.0).floor() + 0.5);
        let area =
            |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let whole = area(a, b, c);
        let weights = [area(at, b, c), area(a, at, c), area(a, b, at)].map(|w| w / whole);
        let pixel = [at[0] as u32, textured.size_px - 1 - at[1] as u32];
        weights.iter().all(|&w| w > 0.01).then_some(Sample { triangle, pixel, weights })
    };
    textured.triangles.iter().filter_map(sample).collect()
}

#[test]
fn colours_are_those_of_the_point_on_the_wall() {
    for (name, mesh) in meshes() {
        let (textured, maps) = bake(&mesh, &UPRIGHT, &of_size(1024));
        let colors = picture(&maps.base_color);
        let samples = samples(&textured);
        assert!(samples.len() > textured.triangles.len() / 4, "{name}: too few samples");
        for sample in samples {
            let point = sample.mix(&textured.positions).map(|c| c as f32);
            let expected = Gradient::color_at(point).map(to_srgb);
            let found = colors.get_pixel(sample.pixel[0], sample.pixel[1]).0;
            for k in 0..3 {
                assert!((f64::from(found[k]) - expected[k]).abs() < 1.0, "{name}: {found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn a_surface_without_detail_has_a_blank_normal_map() {
    for (name, mesh) in meshes() {
        let (_, maps) = bake(&mesh, &UPRIGHT, &of_size(512));
        for pixel in picture(&maps.normal).pixels() {
            let [x, y, z] = pixel.0;
            assert!(x.abs_diff(128) <= 1 && y.abs_diff(128) <= 1 && z >= 254, "{name}: {pixel:?}");
        }
    }
}

#[test]
fn a_shader_finds_the_normal_that_was_baked() {
    for (name, mesh) in meshes() {
        let (textured, maps) = bake(&mesh, &LEANING, &of_size(1024));
        let normals = picture(&maps.normal);
        for sample in samples(&textured) {
            let found = shaded(&textured, &sample, normals.get_pixel(sample.pixel[0], sample.pixel[1]).0);
            let upright = unit(sample.mix(&textured.normals)).map(|c| c as f32);
            let expected = unit(LEANING.leaning(upright).map(f64::from));
            // 1/127 of quantisation in each of three components.
            assert!(dot(found, expected) > 0.9999, "{name}: {found:?} {expected:?}");
        }
    }
}

/// As in the fragment shader of the MikkTSpace paper.
fn shaded(textured: &Textured, sample: &Sample, pixel: [u8; 3]) -> [f64; 3] {
    let n = sample.mix(&textured.normals);
    let [tx, ty, tz, w] = sample.mix(&textured.tangents);
    assert!((w.abs() - 1.0).abs() < 1e-6, "corners of a triangle agree in handedness");
    let t = [tx, ty, tz];
    let b = cross(n, t).map(|c| c * w.signum());
    let [x, y, z] = pixel.map(|c| f64::from(c) / 255.0 * 2.0 - 1.0);
    unit(std::array::from_fn(|k| x * t[k] + y * b[k] + z * n[k]))
}

#[test]
fn tangents_are_unit_and_lie_across_the_normal_along_u() {
    for (name, mesh) in meshes() {
        let (textured, _) = bake(&mesh, &UPRIGHT, &of_size(256));
        assert_eq!(textured.tangents.len(), textured.positions.len());
        for (normal, tangent) in textured.normals.iter().zip(&textured.tangents) {
            let [x, y, z, w] = tangent.map(f64::from);
            assert!((dot([x, y, z], [x, y, z]) - 1.0).abs() < 1e-5, "{name}: {tangent:?}");
            assert!(dot([x, y, z], normal.map(f64::from)).abs() < 1e-3, "{name}: {tangent:?}");
            assert_eq!(w.abs(), 1.0);
        }
    }
}

#[test]
fn orm_holds_occlusion_roughness_and_no_metal() {
    let mesh = rough_passage(60, 30, 8.0, 3);
    let (textured, maps) = bake(&mesh, &UPRIGHT, &of_size(512));
    let (orm, roughness) = (picture(&maps.orm), picture(&maps.roughness));
    assert!(orm.pixels().zip(roughness.pixels()).all(|(o, r)| o.0[1] == r.0[0] && o.0[2] == 0));
    for sample in samples(&textured) {
        let point = sample.mix(&textured.positions).map(|c| c as f32);
        let color = Gradient::color_at(point);
        let found = orm.get_pixel(sample.pixel[0], sample.pixel[1]).0;
        assert!((f32::from(found[0]) - 255.0 * color[1]).abs() < 1.0);
        assert!((f32::from(found[1]) - 255.0 * color[0]).abs() < 1.0);
    }
}

/// As a sampler filters: `u`, `v` from the lower left, in a picture with its top row first.
fn bilinear(picture: &RgbImage, [u, v]: [f32; 2]) -> [f64; 3] {
    let size = f64::from(picture.width());
    let (x, y) = (f64::from(u) * size - 0.5, (1.0 - f64::from(v)) * size - 0.5);
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let at = |dx: f64, dy: f64| {
        let clamp = |c: f64| c.floor().clamp(0.0, size - 1.0) as u32;
        picture.get_pixel(clamp(x + dx), clamp(y + dy)).0.map(f64::from)
    };
    let (a, b, c, d) = (at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0));
    std::array::from_fn(|k| (a[k] * (1.0 - fx) + b[k] * fx) * (1.0 - fy) + (c[k] * (1.0 - fx) + d[k] * fx) * fy)
}

fn halved(picture: &RgbImage) -> RgbImage {
    RgbImage::from_fn(picture.width() / 2, picture.height() / 2, |x, y| {
        let at = |dx, dy| picture.get_pixel(2 * x + dx, 2 * y + dy).0.map(u16::from);
        let (a, b, c, d) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
        image::Rgb(std::array::from_fn(|k| ((a[k] + b[k] + c[k] + d[k] + 2) / 4) as u8))
    })
}

/// Largest difference between the sampled image at the vertices and the colour of the wall there, in 8-bit steps.
fn worst_at_vertices(textured: &Textured, colors: &RgbImage) -> f64 {
    (0..textured.positions.len()).map(|vertex| off_at(textured, colors, vertex)).fold(0.0, f64::max)
}

#[test]
fn charts_and_chunks_agree_at_their_seams() {
    // Two chunks with a common ring; both sides of each seam must agree with the wall.
    for mesh in halves(&rough_passage(120, 60, 10.0, 3)) {
        let (textured, maps) = bake(&mesh, &UPRIGHT, &of_size(1024));
        let colors = picture(&maps.base_color);
        let worst = worst_at_vertices(&textured, &colors);
        assert!(worst < 3.0, "{worst} codes off");
        let worst = worst_at_vertices(&textured, &halved(&colors));
        assert!(worst < 12.0, "{worst} codes off in the first mip level");
    }
}

/// At the default density, where gutters are widest. Seen along its axis, a chart ends where the next one begins somewhere else
/// in the atlas.
#[test]
fn mip_levels_mix_hardly_any_of_another_chart() {
    let mesh = rough_passage(60, 60, 4.0, 3);
    let settings = TextureSettings { format: MapFormats::Png, ..TextureSettings::default() };
    let (textured, maps) = bake(&mesh, &UPRIGHT, &settings);
    let mut colors = picture(&maps.base_color);
    for most in [[0.6, 1.2], [0.9, 2.0], [1.3, 10.0], [2.5, 60.0]] {
        colors = halved(&colors);
        let mut codes = off_at_seams(&textured, &colors);
        codes.sort_by(f64::total_cmp);
        let found = [0.5, 0.99].map(|share| codes[(share * (codes.len() - 1) as f64) as usize]);
        assert!(
            codes.len() > 1000 && found[0] < most[0] && found[1] < most[1],
            "{found:?} codes off, {most:?} allowed"
        );
    }
}

/// Differences between the sampled image at the seams of charts and the colour of the wall there, in 8-bit steps.
fn off_at_seams(textured: &Textured, colors: &RgbImage) -> Vec<f64> {
    let mut copies = vec![0; textured.positions.len()];
    textured.source.iter().for_each(|&vertex| copies[vertex as usize] += 1);
    let at_seams = textured.source.iter().enumerate().filter(|(_, vertex)| copies[**vertex as usize] > 1);
    at_seams.map(|(copy, _)| off_at(textured, colors, copy)).collect()
}

/// Largest difference of a channel between the sampled image at a vertex and the colour of the wall there, in 8-bit steps.
fn off_at(textured: &Textured, colors: &RgbImage, vertex: usize) -> f64 {
    let found = bilinear(colors, textured.uvs[vertex]);
    let wall = Gradient::color_at(textured.positions[vertex]).map(to_srgb);
    (0..3).map(|k| (found[k] - wall[k]).abs()).fold(0.0, f64::max)
}

fn halves(mesh: &Mesh) -> [Mesh; 2] {
    let half = mesh.triangles.len() / 2;
    [&mesh.triangles[..half], &mesh.triangles[half..]]
        .map(|triangles| Mesh { triangles: triangles.to_vec(), ..mesh.clone() })
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let mesh = rough_passage(60, 30, 8.0, 3);
    for format in MapFormats::ALL {
        let settings = TextureSettings { format, height: true, ..of_size(700) };
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| bake(&mesh, &LEANING, &settings))
        };
        let one = with(1);
        assert!(one == with(1), "{format:?}: twice on one thread");
        assert!(one == with(5), "{format:?}: on five threads");
    }
}

#[test]
fn jpg_shows_the_same_picture() {
    let mesh = rough_passage(60, 30, 8.0, 3);
    let (_, png) = bake(&mesh, &LEANING, &of_size(512));
    let (_, jpg) = bake(&mesh, &LEANING, &TextureSettings { format: MapFormats::Jpeg, ..of_size(512) });
    assert!(jpg.normal.starts_with(&[0xFF, 0xD8]));
    for (png, jpg) in [(png.base_color, jpg.base_color), (png.normal, jpg.normal), (png.orm, jpg.orm)] {
        let (png, jpg) = (picture(&png), picture(&jpg));
        let sum: u64 = png.iter().zip(jpg.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        let mean = sum as f64 / png.len() as f64;
        assert!(mean < 3.0, "{mean} codes off");
    }
}

#[test]
fn by_default_only_the_colour_is_lossy() {
    let mesh = rough_passage(60, 30, 8.0, 3);
    let (_, png) = bake(&mesh, &LEANING, &of_size(512));
    let (_, mixed) = bake(&mesh, &LEANING, &TextureSettings { format: MapFormats::default(), ..of_size(512) });
    assert!(mixed.base_color.starts_with(&[0xFF, 0xD8]));
    assert!([mixed.normal, mixed.orm, mixed.roughness] == [png.normal, png.orm, png.roughness]);
    let (png, jpg) = (picture(&png.base_color), picture(&mixed.base_color));
    let worst = png.iter().zip(jpg.iter()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst < Some(32), "{worst:?} codes off");
}

/// A side that is no multiple of a block, passed in pieces that are no multiple of a row.
#[test]
fn a_jpg_written_in_pieces_is_that_of_the_whole() {
    for (channels, color) in
        [(Channels::Srgb, jpeg_encoder::ColorType::Rgb), (Channels::Grey, jpeg_encoder::ColorType::Luma)]
    {
        let pixels: Vec<u8> = (0..300 * 300 * channels.bytes()).map(|byte| (byte * byte / 977) as u8).collect();
        let (mut whole, mut pieces) = (Vec::new(), Vec::new());
        let mut encoder = jpeg_encoder::Encoder::new(&mut whole, 95);
        encoder.set_sampling_factor(jpeg_encoder::SamplingFactor::F_1_1);
        encoder.encode(&pixels, 300, 300, color).unwrap();
        let mut writer = MapWriter::new(&mut pieces, channels, 300, ImageFormat::Jpeg).unwrap();
        pixels.chunks(1234).for_each(|piece| writer.write(piece).unwrap());
        writer.finish().unwrap();
        assert!(pieces == whole, "{channels:?}");
    }
}

#[test]
fn a_map_without_all_its_pixels_is_an_error() {
    for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP] {
        let mut writer = MapWriter::new(Vec::new(), Channels::Srgb, 300, format).unwrap();
        writer.write(&[7; 300 * 3 * 299]).unwrap();
        assert!(writer.finish().is_err(), "{format:?}");
    }
}

#[test]
fn webp_shows_every_pixel() {
    let mesh = rough_passage(60, 30, 8.0, 3);
    let (_, png) = bake(&mesh, &LEANING, &of_size(512));
    let (_, webp) = bake(&mesh, &LEANING, &TextureSettings { format: MapFormats::WebP, ..of_size(512) });
    assert!(webp.base_color.starts_with(b"RIFF"));
    assert!(png.into_iter().map(|map| picture(&map)).eq(webp.into_iter().map(|map| picture(&map))));
}

#[test]
fn heights_are_those_of_the_surface() {
    let mesh = rough_passage(60, 30, 8.0, 3);
    let (textured, maps) = bake(&mesh, &LEANING, &TextureSettings { height: true, ..of_size(1024) });
    let heights = image::load_from_memory(&maps.height.expect("it was asked for")).unwrap();
    let heights = heights.as_luma16().expect("16 bits of grey");
    let step_m = 2.0 * f64::from(HEIGHT_AMPLITUDE_M) / 65_535.0;
    let samples = samples(&textured);
    assert!(samples.len() > 1000);
    for sample in samples {
        let [x, y] = sample.pixel;
        let stored_m = f64::from(heights.get_pixel(x, y).0[0]) * step_m - f64::from(HEIGHT_AMPLITUDE_M);
        let expected_m = Gradient::height_at(sample.mix(&textured.positions).map(|c| c as f32));
        assert!((stored_m - f64::from(expected_m)).abs() < step_m, "{stored_m} m where {expected_m} m are");
    }
}

#[test]
fn base_colour_says_that_it_is_srgb_and_the_others_do_not() {
    let settings = TextureSettings { height: true, ..of_size(256) };
    let (_, maps) = bake(&bubble(20, 20, 2.0), &UPRIGHT, &settings);
    let says_srgb = |bytes: &[u8]| bytes.windows(4).take(100).any(|name| name == b"sRGB");
    assert!(maps.into_iter().map(|map| says_srgb(&map)).eq([true, false, false, false, false]));
}

#[test]
fn an_empty_chunk_has_blank_maps() {
    let (textured, maps) = bake(&Mesh::default(), &UPRIGHT, &of_size(256));
    assert!(textured.triangles.is_empty());
    assert_eq!(picture(&maps.base_color).dimensions(), (256, 256));
}

struct Full;

impl io::Write for Full {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::Error::other("disk full"))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_failing_sink_is_an_error() {
    let sinks = Maps { base_color: Full, normal: Full, orm: Full, roughness: Full, height: None };
    let error = texture(&bubble(20, 20, 2.0), &UPRIGHT, &of_size(256), sinks).unwrap_err();
    assert!(matches!(error, TextureError::Write(_)));
    assert_eq!(error.to_string(), "cannot write a texture map: disk full");
}
