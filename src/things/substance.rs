//! What solids are made of: colour, roughness and relief, over the length of a part.
//!
//! Colours are albedos in linear RGB within the range of dielectrics and oxides (0.02-0.8); they were chosen by eye, and
//! metal is shown as its oxide or its paint, since maps have no metalness.

use nalgebra::{Isometry3, Point3, Vector3};

use crate::material::roughness;
use crate::noise::Source;

/// A substance.
#[derive(Debug)]
pub struct Substance {
    /// Colour where the noise is low and where it is high, linear RGB.
    colors: [[f32; 3]; 2],
    /// Perceptual roughness there.
    roughness: [f32; 2],
    /// Wavelength of the noise across and along the part, in metres.
    grain_m: [f32; 2],
    /// Height of the relief in metres.
    relief_m: f32,
    /// Colour below the surface, and the share of it that shows.
    worn: ([f32; 3], f32),
    /// Share of the colours of its ends that is left: the fibres there are open.
    ends: f32,
}

/// Timber: grey-brown with dust, a little darker between fibres.
pub static WOOD: Substance = Substance {
    colors: [[0.110, 0.079, 0.052], [0.225, 0.168, 0.112]],
    roughness: [0.9, 0.75],
    grain_m: [0.014, 0.22],
    relief_m: 0.0012,
    worn: ([0.04, 0.03, 0.022], 0.03),
    ends: 0.55,
};
/// Steel that has rusted for years.
pub static RUST: Substance = Substance {
    colors: [[0.045, 0.022, 0.014], [0.20, 0.075, 0.03]],
    roughness: [0.95, 0.7],
    grain_m: [0.02, 0.03],
    relief_m: 0.0006,
    worn: ([0.26, 0.12, 0.05], 0.15),
    ends: 1.0,
};
/// Galvanised steel, dull, with spots of rust.
pub static ZINC: Substance = Substance {
    colors: [[0.24, 0.25, 0.26], [0.40, 0.41, 0.41]],
    roughness: [0.62, 0.42],
    grain_m: [0.018, 0.018],
    relief_m: 0.0001,
    worn: ([0.14, 0.065, 0.035], 0.08),
    ends: 1.0,
};
/// Steel painted blue, chipped down to rust.
pub static BLUE_PAINT: Substance = Substance {
    colors: [[0.02, 0.055, 0.14], [0.03, 0.08, 0.19]],
    roughness: [0.5, 0.35],
    grain_m: [0.06, 0.06],
    relief_m: 0.0002,
    worn: ([0.11, 0.045, 0.022], 0.16),
    ends: 1.0,
};
/// Black rubber.
pub static RUBBER: Substance = Substance {
    colors: [[0.018, 0.018, 0.019], [0.035, 0.034, 0.034]],
    roughness: [0.8, 0.6],
    grain_m: [0.02, 0.2],
    relief_m: 0.0002,
    worn: ([0.07, 0.065, 0.06], 0.1),
    ends: 1.0,
};
/// Coated fabric of ventilation ducts, yellow and dirty.
pub static FABRIC: Substance = Substance {
    colors: [[0.30, 0.185, 0.02], [0.50, 0.33, 0.045]],
    roughness: [0.85, 0.65],
    grain_m: [0.09, 0.09],
    relief_m: 0.003,
    worn: ([0.12, 0.09, 0.045], 0.2),
    ends: 1.0,
};

/// Calcite of straws: wet and nearly white.
pub static CALCITE: Substance = Substance {
    colors: [[0.42, 0.35, 0.26], [0.62, 0.56, 0.46]],
    roughness: [0.45, 0.28],
    grain_m: [0.05, 0.05],
    relief_m: 0.0,
    worn: ([0.34, 0.24, 0.14], 0.1),
    ends: 1.0,
};

/// Calcite of draperies: bands of brown iron oxides and of pale calcite along the sheet, as in bacon.
pub static DRAPERY: Substance = Substance {
    colors: [[0.34, 0.21, 0.105], [0.50, 0.41, 0.29]],
    roughness: [0.45, 0.28],
    grain_m: [0.035, 0.6],
    relief_m: 0.0,
    worn: ([0.34, 0.24, 0.14], 0.1),
    ends: 1.0,
};

/// Steel painted red, with few scratches.
pub static RED_PAINT: Substance = Substance {
    colors: [[0.26, 0.012, 0.010], [0.38, 0.02, 0.015]],
    roughness: [0.5, 0.3],
    grain_m: [0.05, 0.05],
    relief_m: 0.0002,
    worn: ([0.12, 0.05, 0.03], 0.05),
    ends: 1.0,
};
/// Red woven nylon, dusty.
pub static NYLON_RED: Substance = Substance {
    colors: [[0.20, 0.014, 0.014], [0.32, 0.03, 0.026]],
    roughness: [0.9, 0.75],
    grain_m: [0.01, 0.01],
    relief_m: 0.0004,
    worn: ([0.2, 0.15, 0.11], 0.12),
    ends: 1.0,
};
/// Orange plastic, scratched.
pub static ORANGE_PLASTIC: Substance = Substance {
    colors: [[0.48, 0.11, 0.008], [0.60, 0.16, 0.012]],
    roughness: [0.5, 0.32],
    grain_m: [0.05, 0.05],
    relief_m: 0.0002,
    worn: ([0.4, 0.2, 0.1], 0.05),
    ends: 1.0,
};
/// Yellow plastic, grimy.
pub static YELLOW_PLASTIC: Substance = Substance {
    colors: [[0.42, 0.27, 0.01], [0.56, 0.38, 0.015]],
    roughness: [0.6, 0.42],
    grain_m: [0.05, 0.05],
    relief_m: 0.0002,
    worn: ([0.1, 0.08, 0.05], 0.1),
    ends: 1.0,
};
/// Braided rope, blue and worn.
pub static ROPE: Substance = Substance {
    colors: [[0.02, 0.07, 0.22], [0.06, 0.16, 0.40]],
    roughness: [0.95, 0.8],
    grain_m: [0.006, 0.006],
    relief_m: 0.0008,
    worn: ([0.25, 0.24, 0.22], 0.15),
    ends: 1.0,
};
/// A screen that is lit green.
pub static SCREEN: Substance = Substance {
    colors: [[0.03, 0.16, 0.06], [0.05, 0.26, 0.10]],
    roughness: [0.3, 0.15],
    grain_m: [0.05, 0.05],
    relief_m: 0.0002,
    worn: ([0.1, 0.1, 0.1], 0.02),
    ends: 1.0,
};

/// The surface of a substance at a point.
pub(super) struct Sample {
    pub color: [f32; 3],
    pub roughness: f32,
    pub normal: [f32; 3],
}

impl Substance {
    /// The surface at points of a part in this frame, with their normals.
    pub(super) fn samples(&self, frame: &Isometry3<f64>, source: Source, at: [&[[f32; 3]]; 2]) -> Vec<Sample> {
        /// Step of the differences that give normals, relative to the wavelength.
        const STEP: f32 = 0.05;
        let [points, normals] = at;
        let [across_m, along_m] = self.grain_m;
        let own = |point: &[f32; 3]| -> [f32; 3] {
            frame.inverse_transform_point(&Point3::from(point.map(f64::from))).map(|c| c as f32).into()
        };
        let stretched = |step: [f32; 3]| -> Vec<[f32; 3]> {
            let moved = points.iter().map(own).map(|[x, y, z]| [x / across_m, y / across_m, z / along_m]);
            moved.map(|p| std::array::from_fn(|axis| p[axis] + step[axis])).collect()
        };
        let noise = |step: [f32; 3]| roughness(source, &stretched(step), 1.0);
        let here = noise([0.0; 3]);
        let beside = [0, 1, 2].map(|axis| noise(std::array::from_fn(|other| if other == axis { STEP } else { 0.0 })));
        let wide: Vec<[f32; 3]> = points.iter().map(|point| point.map(|c| c + 3.7)).collect();
        let wear = roughness(source, &wide, 0.11);
        let [low, high] = self.colors;
        (0..points.len())
            .map(|n| {
                let share = (0.5 + 0.9 * here[n]).clamp(0.0, 1.0);
                let slope = Vector3::from_fn(|axis, _| {
                    let length_m = if axis == 2 { along_m } else { across_m };
                    f64::from(self.relief_m * (beside[axis][n] - here[n]) / (STEP * length_m))
                });
                let normal = Vector3::from(normals[n].map(f64::from));
                let end = f64::abs((frame.inverse() * normal).z) as f32;
                let shade = 1.0 + (self.ends - 1.0) * ((end - 0.7) / 0.2).clamp(0.0, 1.0);
                // Noise exceeds 0.9 hardly anywhere.
                let worn = ((wear[n] + 0.35 * here[n] - 0.75 + 2.5 * self.worn.1) / 0.12).clamp(0.0, 1.0);
                let mixed = |a: f32, b: f32, t: f32| a + (b - a) * t;
                let color = |c: usize| mixed(shade * mixed(low[c], high[c], share), self.worn.0[c], 0.8 * worn);
                Sample {
                    color: std::array::from_fn(color),
                    roughness: mixed(mixed(self.roughness[0], self.roughness[1], share), 0.9, worn),
                    normal: (normal - frame * slope).normalize().map(|c| c as f32).into(),
                }
            })
            .collect()
    }
}
