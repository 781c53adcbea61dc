//! Materials of the three render pipelines, which all use the same images.

use std::f64::consts::FRAC_1_PI;

use minijinja::context;
use minijinja::value::Serde;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::asset::{Assets, Importer};
use super::identity::Guid;
use super::texture::{Texture, Textures};
use crate::error::ExportError;
use crate::template;

/// A render pipeline of Unity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Pipeline {
    /// The built-in pipeline, shader Standard.
    BuiltIn,
    /// The Universal Render Pipeline, shader Lit.
    #[default]
    Urp,
    /// The High Definition Render Pipeline, shader Lit.
    Hdrp,
}

impl Pipeline {
    /// Common name.
    pub fn title(self) -> &'static str {
        match self {
            Self::BuiltIn => "the built-in pipeline",
            Self::Urp => "the Universal Render Pipeline (URP)",
            Self::Hdrp => "the High Definition Render Pipeline (HDRP)",
        }
    }

    /// Light intensity per candela in this pipeline. HDRP has the unit; the others omit the 1/π of a Lambertian surface.
    pub fn per_candela(self) -> f64 {
        match self {
            Self::BuiltIn | Self::Urp => FRAC_1_PI,
            Self::Hdrp => 1.0,
        }
    }

    fn shader(self) -> &'static Shader {
        match self {
            Self::BuiltIn => &STANDARD,
            Self::Urp => &URP_LIT,
            Self::Hdrp => &HDRP_LIT,
        }
    }
}

/// The image for a slot of a shader.
#[derive(Clone, Copy)]
enum Role {
    BaseColor,
    Normal,
    Mask,
}

impl Role {
    fn of(self, textures: &Textures) -> &Texture {
        match self {
            Self::BaseColor => &textures.base_color,
            Self::Normal => &textures.normal,
            Self::Mask => &textures.mask,
        }
    }
}

/// A shader and how it reads our images. Other parameters keep the shader's defaults.
#[derive(Serialize)]
struct Shader {
    file_id: u32,
    guid: &'static str,
    kind: u8,
    keywords: &'static [&'static str],
    #[serde(skip)]
    slots: &'static [(&'static str, Role)],
    numbers: &'static [(&'static str, u8)],
    tint: &'static str,
}

const STANDARD: Shader = Shader {
    file_id: 46,
    guid: "0000000000000000f000000000000000",
    kind: 0,
    keywords: &["_METALLICGLOSSMAP", "_NORMALMAP"],
    slots: &[
        ("_BumpMap", Role::Normal),
        ("_MainTex", Role::BaseColor),
        ("_MetallicGlossMap", Role::Mask),
        ("_OcclusionMap", Role::Mask),
    ],
    numbers: &[
        ("_BumpScale", 1),
        ("_GlossMapScale", 1),
        ("_Mode", 0),
        ("_OcclusionStrength", 1),
        ("_SmoothnessTextureChannel", 0),
    ],
    tint: "_Color",
};

const URP_LIT: Shader = Shader {
    file_id: 4_800_000,
    guid: "933532a4fcc9baf4fa0491de14d08ed7",
    kind: 3,
    keywords: &["_METALLICSPECGLOSSMAP", "_NORMALMAP", "_OCCLUSIONMAP"],
    slots: &[
        ("_BaseMap", Role::BaseColor),
        ("_BumpMap", Role::Normal),
        ("_MainTex", Role::BaseColor),
        ("_MetallicGlossMap", Role::Mask),
        ("_OcclusionMap", Role::Mask),
    ],
    numbers: &[
        ("_BumpScale", 1),
        ("_Cull", 2),
        ("_OcclusionStrength", 1),
        // With a map, the factor for its alpha.
        ("_Smoothness", 1),
        ("_SmoothnessTextureChannel", 0),
        ("_Surface", 0),
        ("_WorkflowMode", 1),
    ],
    tint: "_BaseColor",
};

const HDRP_LIT: Shader = Shader {
    file_id: 4_800_000,
    guid: "6e4ae4064600d784cac1e41a9e6f2e59",
    kind: 3,
    keywords: &["_MASKMAP", "_NORMALMAP", "_NORMALMAP_TANGENT_SPACE"],
    slots: &[("_BaseColorMap", Role::BaseColor), ("_MaskMap", Role::Mask), ("_NormalMap", Role::Normal)],
    numbers: &[
        ("_AORemapMax", 1),
        ("_AORemapMin", 0),
        ("_MaterialID", 1),
        ("_MetallicRemapMax", 1),
        ("_MetallicRemapMin", 0),
        ("_NormalMapSpace", 0),
        ("_NormalScale", 1),
        ("_SmoothnessRemapMax", 1),
        ("_SmoothnessRemapMin", 0),
        ("_SurfaceType", 0),
    ],
    tint: "_BaseColor",
};

/// The main object of a material file.
const OBJECT: u32 = 2_100_000;

/// A slot of a shader for the template.
#[derive(Serialize)]
struct Slot {
    name: &'static str,
    guid: Guid,
}

/// Writes a material, unless it is there.
///
/// # Errors
/// If a file cannot be written.
pub fn write(name: &str, pipeline: Pipeline, textures: &Textures, assets: &mut Assets) -> Result<Guid, ExportError> {
    let path = format!("Runtime/Materials/{name}.mat");
    if assets.out.has(&path) {
        return Ok(assets.guid(&path));
    }
    let shader = pipeline.shader();
    let slots = shader.slots.iter().map(|&(name, role)| Slot { name, guid: role.of(textures).guid });
    let values = context! { name, shader => Serde(shader), slots => Serde(slots.collect::<Vec<_>>()) };
    let text = template::fill(&path, include_str!("../../templates/unity/material.jinja"), &values);
    assets.text(&path, &text, Importer::Native(OBJECT))
}
