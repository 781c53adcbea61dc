//! Things on a plan, as their outlines from above.

use std::sync::atomic::AtomicBool;

use super::frame::{Frame, hull};
use super::sheet::Panel;
use crate::mesh::MeshSettings;
use crate::preview::svg::{PaperPoint, Svg};
use crate::preview::theme::Palette;
use crate::preview::{Furnishing, PreviewError, Subject};
use crate::things::Thing;
use plume_graph::{Aabb, Graph, Node};

/// Scale in pixels per metre from which on things are drawn: on smaller maps a boulder is a dot.
const LEAST_PX_PER_M: f64 = 5.0;
/// Narrowest outline in pixels.
const LEAST_PX: f64 = 2.0;
/// Voxels of the wall on which they are placed, in metres: it moves things by less than a pixel. Tuned for speed.
const VOXEL_M: f32 = 0.25;

/// Outlines of things, with the storey they are in.
#[derive(Default)]
pub struct Stones(Vec<(u32, Vec<[f64; 2]>)>);

impl Stones {
    /// Those of a cave on a map of this scale.
    pub fn of(subject: &Subject, px_per_m: f64, stop: &AtomicBool) -> Result<Self, PreviewError> {
        let Some(furnishing) = subject.furnishing.as_ref().filter(|_| px_per_m >= LEAST_PX_PER_M) else {
            return Ok(Self::default());
        };
        let mesh = MeshSettings { voxel_m: VOXEL_M, ..furnishing.mesh.clone() };
        let coarse = Furnishing { mesh: &mesh, ..*furnishing };
        let Aabb { min, max } = subject.field.bounds();
        let everywhere = Aabb { min: min.map(f64::from), max: max.map(f64::from) };
        let things = coarse.things_in(everywhere, stop)?;
        let outline = |thing: &Thing| {
            let prototype = furnishing.setting.library.named(&thing.prototype)?;
            if prototype.width_m() * thing.scale * px_per_m < LEAST_PX {
                return None;
            }
            let corners = prototype.hull.corners.iter().map(|corner| thing.pose * (corner * thing.scale));
            Some((storey(subject.graph, thing), hull(corners.map(|at| [at.x, at.y]).collect())))
        };
        Ok(Self(things.iter().filter_map(outline).collect()))
    }

    /// Draws those of a panel.
    pub fn draw(&self, svg: &mut Svg, palette: &Palette, panel: &Panel, frame: &Frame) {
        let here = self.0.iter().filter(|(storey, _)| panel.level.is_none_or(|level| level == *storey));
        let shapes: Vec<Vec<PaperPoint>> =
            here.map(|(_, outline)| outline.iter().map(|at| frame.paper_point(*at)).collect()).collect();
        if !shapes.is_empty() {
            svg.fill(&shapes, palette.wall);
        }
    }
}

/// The storey of the station that is nearest to a thing.
fn storey(graph: &Graph, thing: &Thing) -> u32 {
    let away = |station: &&Node| (station.position.coords - thing.pose.translation.vector).norm_squared();
    graph.nodes.iter().min_by(|a, b| away(a).total_cmp(&away(b))).map_or(0, |station| station.level)
}
