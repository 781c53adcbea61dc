//! The images of materials, for averages over the footprint of a pixel.
//!
//! A texel holds all maps together in eight bytes, so that a look-up touches memory once: base colour as roots of linear light,
//! normal, occlusion, roughness. Smaller levels are means of four texels, of colours in linear light; the mean of normals becomes
//! shorter where they differ, from which the shader takes the roughness that is lost.

use image::{ImageReader, RgbImage};
use plume_exporters::ExportError;
use plume_exporters::scene::{Image, Material};
use rayon::prelude::*;

/// The maps of a material, from the full level to a single texel.
pub struct Maps(Vec<Level>);

struct Level {
    size: [usize; 2],
    texels: Vec<[u8; 8]>,
}

/// What a surface is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Base colour, linear.
    pub color: [f32; 3],
    /// Mean normal in the frame of tangent, bitangent and normal; not of length 1.
    pub normal: [f32; 3],
    /// Share of light from all sides that arrives.
    pub occlusion: f32,
    /// Roughness, which is the root of GGX's α.
    pub roughness: f32,
}

/// The footprint of a pixel in texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Its width across the direction of view.
    pub width: f32,
    /// Its length along the direction of view.
    pub length: [f32; 2],
}

/// Most look-ups along a footprint.
const MOST_TAPS: f32 = 6.0;

impl Maps {
    /// Reads the images of a material.
    ///
    /// # Errors
    /// If one cannot be read.
    pub fn read(material: &Material) -> Result<Self, ExportError> {
        let images = [&material.base_color, &material.normal, &material.orm];
        let read: Vec<RgbImage> = images.into_par_iter().map(decoded).collect::<Result<_, _>>()?;
        let [color, normal, orm] = [&read[0], &read[1], &read[2]];
        let roots = roots_of_linear();
        let (width, height) = color.dimensions();
        // From any size to that of the colours.
        let near = |image: &RgbImage, x: u32, y: u32| {
            let scaled = |at: u32, from: u32, to: u32| (u64::from(at) * u64::from(to) / u64::from(from)) as u32;
            image.get_pixel(scaled(x, width, image.width()), scaled(y, height, image.height())).0
        };
        let row = |y: u32| {
            (0..width).map(move |x| {
                let [r, g, b] = color.get_pixel(x, y).0.map(|value| roots[usize::from(value)]);
                let ([nx, ny, nz], [occlusion, roughness, _]) = (near(normal, x, y), near(orm, x, y));
                [r, g, b, nx, ny, nz, occlusion, roughness]
            })
        };
        let texels = (0..height).into_par_iter().flat_map_iter(row).collect();
        Ok(Self::of(Level { size: [width as usize, height as usize], texels }))
    }

    /// The maps whose full level is this.
    fn of(full: Level) -> Self {
        let mut levels = vec![full];
        while let Some(smaller) = levels.last().and_then(Level::halved) {
            levels.push(smaller);
        }
        Self(levels)
    }

    /// The mean over a footprint around `uv` from the lower left; images repeat.
    #[inline(always)]
    pub fn mean(&self, uv: [f32; 2], footprint: Footprint) -> Look {
        let [width, height] = self.0[0].size.map(|side| side as f32);
        let length = libm::sqrtf(square(footprint.length[0] * width) + square(footprint.length[1] * height));
        let across = footprint.width * libm::sqrtf(width * height);
        let taps = (length / across.max(1.0)).clamp(1.0, MOST_TAPS).ceil();
        let level = about_log2(across.max(length / taps).max(1.0)).min((self.0.len() - 1) as f32);
        let fine = level as usize;
        // Only where they are equally good are two levels mixed, over half of the way: half as many look-ups.
        let share = (2.0 * (level - fine as f32) - 0.5).clamp(0.0, 1.0);
        let mut sum = [0.0; 8];
        for (level, share) in [(fine, 1.0 - share), (fine + 1, share)] {
            if share > 0.0 {
                self.0[level].add_along(uv, footprint.length, taps, share, &mut sum);
            }
        }
        let mean = sum.map(|sum| sum / taps);
        Look {
            color: [mean[0], mean[1], mean[2]].map(|color| color / (255.0 * 255.0)),
            normal: [mean[3], mean[4], mean[5]].map(|part| part / 127.5 - 1.0),
            occlusion: mean[6] / 255.0,
            roughness: mean[7] / 255.0,
        }
    }

    /// Number of bytes in memory.
    pub fn bytes(&self) -> usize {
        self.0.iter().map(|level| level.texels.len() * 8).sum()
    }
}

impl Level {
    fn halved(&self) -> Option<Self> {
        if self.size == [1, 1] {
            return None;
        }
        let size = self.size.map(|side| side.div_ceil(2));
        let four = |x: usize, y: usize| [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| self.texel(2 * x + i, 2 * y + j));
        let row = |y: usize| (0..size[0]).map(move |x| mean_of_four(four(x, y)));
        Some(Self { size, texels: (0..size[1]).into_par_iter().flat_map_iter(row).collect() })
    }

    /// The texel at a place, or the last one before the edge.
    fn texel(&self, x: usize, y: usize) -> [u8; 8] {
        self.texels[y.min(self.size[1] - 1) * self.size[0] + x.min(self.size[0] - 1)]
    }

    /// Adds the bilinear mean of four texels at each of some points on a line around a middle, colours in linear light.
    #[inline(always)]
    fn add_along(&self, middle: [f32; 2], length: [f32; 2], points: f32, weight: f32, sum: &mut [f32; 8]) {
        let [width, height] = self.size;
        for point in 0..points as usize {
            let along = (point as f32 + 0.5) / points - 0.5;
            let ((x0, x1), right) = between(middle[0] + along * length[0], width);
            let ((y0, y1), below) = between(1.0 - (middle[1] + along * length[1]), height);
            let [above, below] = [weight * (1.0 - below), weight * below];
            for (place, share) in [
                (y0 * width + x0, above * (1.0 - right)),
                (y0 * width + x1, above * right),
                (y1 * width + x0, below * (1.0 - right)),
                (y1 * width + x1, below * right),
            ] {
                add(&self.texels[place], share, sum);
            }
        }
    }
}

/// Adds a texel, colours in linear light: written such that all channels are added at once.
#[inline(always)]
fn add(texel: &[u8; 8], weight: f32, sum: &mut [f32; 8]) {
    const SQUARED: [f32; 8] = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    const PLAIN: [f32; 8] = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0];
    for channel in 0..8 {
        let value = f32::from(texel[channel]);
        sum[channel] += weight * (value * (SQUARED[channel] * value + PLAIN[channel]));
    }
}

/// The two texels around a coordinate, of as many as `size`, and the share of the second.
#[inline(always)]
fn between(coordinate: f32, size: usize) -> ((usize, usize), f32) {
    // Half a texel more than from the middle of the first texel, so it is never negative.
    let place = (coordinate - rounded_down(coordinate) as f32) * size as f32 + 0.5;
    let second = (place as usize).min(size);
    let first = if second == 0 { size } else { second } - 1;
    ((first, if second == size { 0 } else { second }), place - second as f32)
}

/// The largest whole number that is not larger. `f32::floor` is a call where it has to run on every processor.
#[inline(always)]
fn rounded_down(value: f32) -> i32 {
    let towards_zero = value as i32;
    towards_zero - i32::from(value < towards_zero as f32)
}

fn mean_of_four(texels: [[u8; 8]; 4]) -> [u8; 8] {
    let mean = |channel: usize| {
        let values = texels.map(|texel| f32::from(texel[channel]));
        let mean = if channel < 3 {
            (values.map(square).iter().sum::<f32>() / 4.0).sqrt()
        } else {
            values.iter().sum::<f32>() / 4.0
        };
        (mean + 0.5) as u8
    };
    [0, 1, 2, 3, 4, 5, 6, 7].map(mean)
}

/// The logarithm of a number from 1 on, too small by at most 0.09: between powers of two it is a straight line.
#[inline(always)]
fn about_log2(value: f32) -> f32 {
    let steps = 1 << (f32::MANTISSA_DIGITS - 1);
    (value.to_bits() - 1_f32.to_bits()) as f32 / steps as f32
}

fn square(x: f32) -> f32 {
    x * x
}

/// From sRGB to the root of linear light.
fn roots_of_linear() -> [u8; 256] {
    std::array::from_fn(|value| {
        let encoded = value as f64 / 255.0;
        let linear = if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) };
        (255.0 * linear.sqrt() + 0.5) as u8
    })
}

fn decoded(image: &Image) -> Result<RgbImage, ExportError> {
    let named = |error: &dyn std::fmt::Display| std::io::Error::other(format!("{}: {error}", image.path.display()));
    let open = || {
        let mut reader = ImageReader::open(&image.path)?.with_guessed_format()?;
        reader.no_limits();
        reader.decode()
    };
    Ok(open().map_err(|error: image::ImageError| named(&error))?.into_rgb8())
}

#[cfg(test)]
mod tests {
    use plume_graph::rng::Rng;
    use plume_graph::seed::stream;

    use super::*;

    /// Two columns, dark and light.
    fn stripes() -> Maps {
        let texels = (0..64).map(|n| {
            if n % 2 == 0 { [0, 0, 0, 128, 128, 255, 255, 10] } else { [200, 100, 255, 128, 128, 255, 255, 250] }
        });
        Maps::of(Level { size: [8, 8], texels: texels.collect() })
    }

    #[test]
    fn a_wide_footprint_has_the_mean_in_linear_light() {
        let maps = stripes();
        let wide = maps.mean([0.4, 0.6], Footprint { width: 1.0, length: [1.0, 0.0] });
        for (color, root) in wide.color.into_iter().zip([200.0_f32, 100.0, 255.0]) {
            let mean = square(root / 255.0) / 2.0;
            assert!((color - mean).abs() < 0.01, "{color} {mean}");
        }
        assert!((wide.roughness - 130.0 / 255.0).abs() < 0.01);
    }

    #[test]
    fn means_are_the_same_in_wide_vectors() {
        let texels = (0..60_u8).map(|n| std::array::from_fn(|channel| n.wrapping_mul(37 + channel as u8)));
        let maps = Maps::of(Level { size: [10, 6], texels: texels.collect() });
        let mut rng = Rng::new(stream(1, "means", 0));
        let widest = fearless_simd::Level::new();
        for _ in 0..10_000 {
            let [u, v, x, y] = [2.0, 2.0, 0.4, 0.4].map(|most| rng.between(-most, most) as f32);
            let footprint = Footprint { width: rng.unit() as f32 * 0.3, length: [x, y] };
            let found = std::hint::black_box(&maps).mean([u, v], footprint);
            let wide = fearless_simd::dispatch!(widest, _simd => std::hint::black_box(&maps).mean([u, v], footprint));
            assert_eq!(found, wide);
        }
    }

    #[test]
    fn a_small_footprint_has_a_single_texel() {
        let maps = stripes();
        let one = maps.mean([3.5 / 8.0, 0.5], Footprint { width: 0.0, length: [0.0, 0.0] });
        assert!((one.color[0] - square(200.0 / 255.0)).abs() < 1e-6);
        assert!((one.normal[2] - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_long_footprint_is_not_blurred_across() {
        let maps = stripes();
        let along = maps.mean([3.5 / 8.0, 0.5], Footprint { width: 1.0 / 8.0, length: [0.0, 4.0 / 8.0] });
        assert!((along.color[0] - square(200.0 / 255.0)).abs() < 1e-3);
    }
}
