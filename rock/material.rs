//! What the rock looks like, in shape and colour.
//!
//! A rock is a file with a settings struct that implements [`Rock`] and a row in [`MATERIALS`]. The field evaluates it
//! through [`Material`], a block of points at a time: first the coarse surface (shape, part of the geometry; see
//! [`Coarse`]), then what is finer (detail, colour, roughness, occlusion).
//!
//! The rocks are layered regimes rather than one noise: two states of the wall with sharp borders between them, steps
//! independent of the axis of the passage, a separate floor, and colour that follows from form. All were tuned by eye under
//! a headlamp.
//!
//! ```
//! use plume_rock::material::MATERIALS;
//!
//! let basalt = MATERIALS.find("basalt").ok_or("no such rock")?;
//! let rock = (basalt.read)(serde_json::json!({"relief": 0.5}))?;
//! assert!(rock.domain_warp().reach_m[0] > 0.0);
//! assert!((basalt.read)(serde_json::json!({"relieff": 0.5})).is_err());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod basalt;
mod clad;
mod coarse;
mod color;
mod drilled;
mod floor;
mod limestone;
mod look;
mod rock;
mod roughness;
mod rubble;
mod salt;
mod site;
mod surface;

pub use basalt::{Basalt, BasaltColors};
pub use clad::{Clad, OwnMaps};
pub use coarse::{CHANNELS, Coarse, CoarseBlock, CoarseTone, JETS, MARKS, OVERSHOOT};
pub use color::{Rgb, Shades};
pub use drilled::{Drilled, DrilledColors, Lithology};
pub use floor::{Debris, Sediment};
pub use limestone::{Limestone, LimestoneColors};
pub use look::Look;
pub use rock::{Detail, Floor, Form, JUMP_M, PROTRUSION, Paint, RECESS_M, Rock, STEEPEST, Wall};
#[doc(hidden)]
pub use roughness::roughness;
pub use rubble::Rubble;
pub use salt::{Salt, SaltColors};
#[doc(hidden)]
pub use site::by_axis;
pub use site::{BLOCK, Channel, Footprint, Ground, Site, Sites, Stored, SurfaceSamples};

use std::sync::Arc;

use plume_registry::{Named, Registry, settings_schema};
use schemars::{JsonSchema, Schema};
use serde::de::DeserializeOwned;
use serde_json::Value;

/// How a rock bends passages: the domain warp applied before distances are evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DomainWarp {
    /// Wavelengths in metres, long and short.
    pub length_m: [f32; 2],
    /// Maximum displacement of a wall by each along one horizontal axis, in metres; 0.6 of it vertically.
    pub reach_m: [f32; 2],
}

/// A rock, evaluated a block at a time.
pub trait Material: std::fmt::Debug + Send + Sync {
    /// The domain warp.
    fn domain_warp(&self) -> DomainWarp;
    /// Whether its second state forms where water drips from the roof.
    fn is_crusted_by_drips(&self) -> bool {
        false
    }
    /// The field at the sites, negative in air, metres; one value per site.
    fn distances(&self, sites: &Sites, out: &mut [f32]);
    /// Gradients of [`Material::distances`].
    fn gradients(&self, sites: &Sites, out: &mut [[f32; 3]]);
    /// The coarse surface at the sites.
    fn coarse(&self, sites: &Sites, out: &mut CoarseBlock);
    /// The appearance of a coarse surface. `normals` are unit normals of the mesh there, into the air.
    fn surface_samples(
        &self,
        block: &CoarseBlock,
        look: &Look,
        footprint: Footprint,
        normals: &[[f32; BLOCK]; 3],
        out: &mut SurfaceSamples,
    );
}

/// A row of [`MATERIALS`].
#[derive(Debug)]
pub struct MaterialRow {
    /// Name in recipes.
    pub name: &'static str,
    /// One line for `plume list`.
    pub summary: &'static str,
    /// Which version of the rock's formulas this is: walls and images made by another one are remade.
    pub revision: u32,
    /// JSON Schema of the settings: descriptions, ranges, defaults. What is in a section `colors` must not change the shape:
    /// walls are kept when it changes.
    pub schema: fn() -> Schema,
    /// Reads settings (an object with a subset of the keys).
    pub read: fn(Value) -> Result<Arc<dyn Material>, serde_json::Error>,
}

/// All rocks, the default first. Programs may [register](Registry::register) their own.
pub static MATERIALS: Registry<MaterialRow> = Registry::new(&[
    MaterialRow::new::<Limestone>(
        "limestone",
        "karst: dipping beds, joints, solution pockets and scallops, flowstone; mud and cobbles",
    )
    .revised(2),
    MaterialRow::new::<Basalt>(
        "basalt",
        "lava tube: glazed lining with flow ledges, spalled to blocky basalt; ash, ropes and slabs",
    )
    .revised(1),
    MaterialRow::new::<Drilled>(
        "drilled",
        "mine: granite, ore or coal, blasted along joints and drill holes; half barrels, muck",
    )
    .revised(1),
    MaterialRow::new::<Salt>(
        "salt",
        "mine: folded bands of rock salt, cut by machine; arcs of picks, crystals, crushed salt",
    ),
]);

impl MaterialRow {
    /// The row of a rock whose settings are its fields, each with a doc comment, a range and a default.
    pub const fn new<M>(name: &'static str, summary: &'static str) -> Self
    where
        M: Material + JsonSchema + DeserializeOwned + 'static,
    {
        Self {
            name,
            summary,
            revision: 0,
            schema: settings_schema::<M>,
            read: |settings| Ok(Arc::new(serde_json::from_value::<M>(settings)?)),
        }
    }

    /// The row with another [`revision`](Self::revision): raise it whenever a change moves a wall or alters a colour.
    pub const fn revised(self, revision: u32) -> Self {
        Self { revision, ..self }
    }
}

impl Named for MaterialRow {
    fn name(&self) -> &'static str {
        self.name
    }
}
