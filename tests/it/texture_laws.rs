//! Laws of the maps of every rock, as they are exported, against the field at the wall.

use std::sync::LazyLock;

use crate::texture_support::baked::{Appearance, Baked, Zone, passages};
use crate::texture_support::bands::{Band, Image, rms};
use crate::texture_support::{dot, unit};

/// Passages as most are.
static PASSAGES: LazyLock<Vec<Baked>> = LazyLock::new(|| passages(0.3, 1));

/// Passages full of water.
static WET: LazyLock<Vec<Baked>> = LazyLock::new(|| passages(1.0, 1));

/// Side of a window in texels: the longest waves and their margins.
const SIDE: usize = 48;
/// Windows per zone.
const WINDOWS: usize = 8;
/// Samples of the field per texel, along each side.
const FINER: usize = 3;

/// Each zone of each rock.
fn each_zone(mut law: impl FnMut(&Baked, Zone, String)) {
    for baked in PASSAGES.iter() {
        for zone in Zone::ALL {
            law(baked, zone, format!("{} {zone:?}", baked.rock));
        }
    }
}

/// What varies over a wall.
#[derive(Clone, Copy, Debug)]
enum Quantity {
    /// Binary logarithm of the luminance of the base colour.
    Albedo,
    /// Both components along the surface.
    Normal,
    Roughness,
}

impl Quantity {
    const ALL: [Self; 3] = [Self::Albedo, Self::Normal, Self::Roughness];

    fn of(self, appearance: &Appearance) -> Vec<&Image> {
        match self {
            Self::Albedo => vec![&appearance.albedo],
            Self::Normal => appearance.normal[..2].iter().collect(),
            Self::Roughness => vec![&appearance.roughness],
        }
    }

    /// Root mean square of an octave.
    fn rms(self, looks: &[Appearance], band: Band, per_m: f64) -> f64 {
        let margin = (band.reach_m() * per_m).ceil() as usize;
        let each = looks.iter().flat_map(|look| self.of(look)).map(|image| rms(&band.of(image, per_m, margin)));
        let squares: Vec<f64> = each.map(|one| one * one).collect();
        let components = self.of(&looks[0]).len() as f64;
        (components * squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    }
}

/// A zone of a rock as its files show it and as its field has it.
struct Sampled {
    shown: Vec<Appearance>,
    field: Vec<Appearance>,
    texels_per_m: f64,
}

impl Sampled {
    fn new(baked: &Baked, zone: Zone) -> Self {
        let windows = baked.windows(zone, SIDE, WINDOWS);
        assert!(windows.len() > 3, "{} {zone:?}: {} windows", baked.rock, windows.len());
        Self {
            shown: windows.iter().map(|&window| baked.shown(window, SIDE)).collect(),
            field: windows.iter().map(|&window| baked.in_field(window, SIDE, FINER)).collect(),
            texels_per_m: f64::from(baked.textured.texels_per_m),
        }
    }

    fn shown(&self, quantity: Quantity, band: Band) -> f64 {
        quantity.rms(&self.shown, band, self.texels_per_m)
    }

    fn in_field(&self, quantity: Quantity, band: Band) -> f64 {
        quantity.rms(&self.field, band, FINER as f64 * self.texels_per_m)
    }
}

/// A texel is 7.8 mm wide, so that its maps can show waves of 15.6 mm and more.
#[test]
fn maps_show_what_the_field_has() {
    each_zone(|baked, zone, name| {
        let sampled = Sampled::new(baked, zone);
        for band in [Band(0.016), Band(0.032), Band(0.064)] {
            for quantity in Quantity::ALL {
                let [shown, field] = [sampled.shown(quantity, band), sampled.in_field(quantity, band)];
                assert!(shown > 0.9 * field, "{name}: {shown:.4} of {field:.4} {quantity:?} in {band:?}");
            }
        }
    });
}

#[test]
fn rock_has_contrast_down_to_a_centimetre() {
    each_zone(|baked, zone, name| {
        let sampled = Sampled::new(baked, zone);
        for (quantity, shown_at_16_mm, field_at_8_mm) in
            [(Quantity::Albedo, 0.05, 0.03), (Quantity::Normal, 0.08, 0.06)]
        {
            let shown = sampled.shown(quantity, Band(0.016));
            assert!(shown > shown_at_16_mm, "{name}: {shown:.4} {quantity:?} at 16 mm");
            let field = sampled.in_field(quantity, Band(0.008));
            assert!(field > field_at_8_mm, "{name}: {field:.4} {quantity:?} at 8 mm");
        }
        for band in [Band(0.016), Band(0.032)] {
            let shown = sampled.shown(Quantity::Roughness, band);
            assert!(shown > 0.02, "{name}: {shown:.4} roughness in {band:?}");
        }
    });
}

/// Normals that lean far from the mesh are black smudges wherever the light is.
#[test]
fn few_normals_lean_far_from_the_mesh() {
    /// Degrees, of the normals of 8 bits that were limited to 60.
    const FAR_DEG: f64 = 59.0;
    let mut shares = vec![];
    each_zone(|baked, zone, name| {
        let leans_deg: Vec<f64> = baked.texels(zone).map(|texel| baked.lean_deg(texel)).collect();
        let far = leans_deg.iter().filter(|lean_deg| **lean_deg > FAR_DEG).count();
        shares.push((name, far as f64 / leans_deg.len() as f64));
    });
    assert!(shares.iter().all(|(_, share)| *share < 0.01), "lean over 60°: {shares:.4?}");
}

/// A renderer averages normals and roughness apart in the smaller levels of maps. There, wet walls glitter more than all that
/// a texel of the level averages, but not much more.
#[test]
fn smaller_levels_glitter_little_more_than_their_texels() {
    for (level, most) in [(1, 0.73), (2, 0.93)] {
        let off: Vec<f64> = WET.iter().map(|baked| off_in_highlights(baked, level)).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        assert!(mean < most, "level {level}: highlights are off by {off:.3?}");
    }
}

/// Sum of the differences between highlights of a level, relative to their sum.
fn off_in_highlights(baked: &Baked, level: u32) -> f64 {
    let (mut off, mut sum) = (0.0, 0.0);
    for window in baked.windows(Zone::Wall, SIDE, WINDOWS) {
        for (averaged, shaded) in highlights(&baked.shown(window, SIDE), level) {
            off += (averaged - shaded).abs();
            sum += shaded;
        }
    }
    off / sum
}

/// Normal and roughness of a texel.
type Shading = ([f64; 3], f64);

/// The highlight of each texel of a level, shaded after averaging and averaged after shading, for several directions of a
/// lamp beside the eye.
fn highlights(look: &Appearance, level: u32) -> Vec<(f64, f64)> {
    let side = 1_usize << level;
    let starts = || (0..look.roughness.side).step_by(side);
    let mut pairs = vec![];
    for [left, bottom] in starts().flat_map(|bottom| starts().map(move |left| [left, bottom])) {
        let texels: Vec<Shading> = (0..side * side)
            .map(|k| (bottom + k / side) * look.roughness.side + left + k % side)
            .map(|at| ([0, 1, 2].map(|axis| look.normal[axis].values[at]), look.roughness.values[at]))
            .collect();
        let mean = |of: &dyn Fn(&Shading) -> f64| texels.iter().map(of).sum::<f64>() / texels.len() as f64;
        let averaged = ([0, 1, 2].map(|axis| mean(&|texel| texel.0[axis])), mean(&|texel| texel.1));
        for toward in LAMPS {
            pairs.push((highlight(averaged, toward), mean(&|texel| highlight(*texel, toward))));
        }
    }
    pairs
}

/// Directions of a lamp in tangent space: above the wall, and 20 and 45 degrees beside.
const LAMPS: [[f64; 3]; 5] =
    [[0.0, 0.0, 1.0], [0.342, 0.0, 0.940], [-0.171, 0.296, 0.940], [0.354, 0.612, 0.707], [-0.707, 0.0, 0.707]];

/// Light that a texel reflects back to the eye beside the lamp, which is a disc a few degrees wide: the distribution of
/// Trowbridge and Reitz.
fn highlight((normal, roughness): Shading, toward: [f64; 3]) -> f64 {
    let normal = unit(normal);
    let cosine = dot(normal, toward).max(0.0);
    let lobe = roughness * roughness * roughness * roughness + 1e-3;
    let spread = cosine * cosine * (lobe - 1.0) + 1.0;
    cosine * lobe / (spread * spread)
}
