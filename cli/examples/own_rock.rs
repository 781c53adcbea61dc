//! The `plume` command with a rock of its own: gypsum, whose thin beds dissolve at different rates.
//!
//! Two formulas suffice, for the whole and for the wall; floor, fine detail and colour have defaults. They are compiled once
//! for each width of vector that processors have.
//!
//! ```text
//! cargo run --release --example own_rock -- preview --set rock.kind=gypsum --view inside --output gypsum.png
//! cargo run --release --example own_rock -- export --set rock.kind=gypsum --target glb --output gypsum
//! ```

use std::error::Error;
use std::process::ExitCode;

use plume::material::{DomainWarp, MATERIALS, MaterialRow, Rock, Site, Wall};
use plume::noise::{Real, Simd};
use plume::registry::RegisterError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the rock.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Gypsum {
    /// Thickness of two beds together, in metres.
    #[schemars(range(min = 1.0, max = 5.0))]
    bed_m: f32,
    /// How much further soft beds recede than hard ones, in metres.
    #[schemars(range(min = 0.0, max = 0.3))]
    relief_m: f32,
}

impl Default for Gypsum {
    fn default() -> Self {
        Self { bed_m: 1.6, relief_m: 0.2 }
    }
}

impl Rock for Gypsum {
    fn domain_warp(&self) -> DomainWarp {
        DomainWarp { length_m: [7.0, 2.5], reach_m: [0.5, 0.1] }
    }

    #[inline(always)]
    fn wall<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> Wall<T> {
        let folds = site.source.noise(1, site.point.scaled(0.3)) * 0.4;
        let (_, phase) = (site.point.z * (1.0 / self.bed_m) + folds).split();
        // Rises from 0 to 1 and falls again within two beds: continuous where one pair ends and the next begins.
        let softness = phase.step(0.1, 0.4) * phase.step(0.9, 0.6);
        let recess = softness * self.relief_m + site.source.noise(2, site.point.scaled(0.5)) * 0.15;
        let zero = T::zero(site.simd());
        Wall { recess, cavity: recess, state: zero, band: softness }
    }
}

/// Before any recipe is read. Raise the revision whenever the formulas change: cave folders are then remade.
pub fn register() -> Result<(), RegisterError> {
    MATERIALS.register(MaterialRow::new::<Gypsum>("gypsum", "gypsum: thin folded beds, hard and soft").revised(1))
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    register()?;
    Ok(plume_cli::run(std::env::args_os(), &plume_cli::Host::Binary).into())
}
