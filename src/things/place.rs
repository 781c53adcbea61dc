//! Finds the things of a chunk.
//!
//! Every cell of a grid over the map has one candidate of each kind: where it is, how large, and a number by which it is
//! there or not, all hashed from the cell. What depends on the place thins them out, and of two of a kind that would overlap
//! the larger remains, whether or not something larger still takes its place (Matérn's second process). Kinds follow each
//! other from large to small, and a stone lies on the wall or on larger kinds: so it depends on what is within [`MARGIN_M`]
//! only, and no chunk on what another one decided.

use nalgebra::{Isometry3, Point3, Translation3, Vector3};

use super::along::{ASIDE_M, Way};
use super::corridor::Corridor;
use super::facets::Facets;
use super::kind::{KindRow, Kinds};
use super::library::{Library, Prototype};
use super::lost::FURTHEST_TRIED_M;
use super::lots::Lots;
use super::rest::about_z;
use super::{Thing, ThingSettings};
use crate::field::CaveField;
use crate::mesh::Mesh;
use plume_graph::seed::salt;
use plume_graph::{Aabb, Graph};

/// How far around a chunk its things depend on, in metres.
pub(super) const MARGIN_M: f64 = 4.0;
/// Ratio of successive sizes, so that few meshes serve a cave in targets that do not scale them.
const SIZE_STEP: f64 = 1.189_207_115_002_721;

/// What the things of a cave follow from, beside its walls.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// The prototypes.
    pub library: &'a Library<'a>,
    /// The settings.
    pub settings: &'a ThingSettings,
    /// The kinds that occur.
    pub kinds: Kinds<'a>,
    /// The field.
    pub field: &'a CaveField,
    /// The graph.
    pub graph: &'a Graph,
    /// The seed of the cave.
    pub seed: u64,
}

/// The things whose origins are in `chunk`, given its wall and those of its neighbours; sorted by identity.
pub fn place<'a>(setting: &Setting, chunk: Aabb<f64>, walls: impl Iterator<Item = &'a Mesh>) -> Vec<Thing> {
    let around = chunk.padded(MARGIN_M);
    let Some(site) = Site::new(setting, around, walls, ASIDE_M + FURTHEST_TRIED_M) else { return Vec::new() };
    let (standing, hanging): (Vec<Candidate>, Vec<Candidate>) =
        site.dripstone(around).into_iter().partition(|candidate| candidate.stands);
    let kept = without_overlaps(&standing);
    let standing: Vec<Candidate> = standing.into_iter().zip(kept).filter(|(_, kept)| *kept).map(|(c, _)| c).collect();
    let ways = Way::near(setting.graph, around);
    let mut built = site.built(&ways);
    built.extend(site.left(&ways));
    let mut in_the_way: Vec<Candidate> = standing.clone();
    in_the_way.extend(built.iter().map(|built| &built.candidate).filter(|candidate| candidate.stands).cloned());
    let mut things = site.stones(chunk, &in_the_way);
    things.extend(built.iter().map(|built| built.candidate.thing(built.pose)));
    things.extend(standing.iter().chain(&hanging).map(Candidate::as_it_is));
    things.retain(|thing| owns(&chunk, thing.pose.translation.vector));
    things.sort_by_key(|thing| thing.id);
    things
}

/// Half open, so that a thing on a border has one chunk.
pub(super) fn owns(chunk: &Aabb<f64>, at: Vector3<f64>) -> bool {
    (0..3).all(|axis| chunk.min[axis] <= at[axis] && at[axis] < chunk.max[axis])
}

/// A thing that may be there.
#[derive(Clone)]
pub(super) struct Candidate<'a> {
    pub id: u64,
    pub row: KindRow<'a>,
    pub prototype: &'a Prototype<'a>,
    pub scale: f64,
    pub yaw_rad: f64,
    /// Where it touches the wall.
    pub at: Point3<f64>,
    /// How far it is moved into the wall.
    pub embedding_m: f64,
    /// Whether it is on the floor.
    pub stands: bool,
    /// Of two that overlap the one with the larger rank remains.
    pub rank: f64,
}

impl Candidate<'_> {
    /// How far it is from its axis at most, in metres.
    pub fn reach_m(&self) -> f64 {
        self.prototype.reach_m * self.scale
    }

    /// Distance from another one in metres: beside what stands upright, along the map.
    fn apart_m(&self, other: &Self) -> f64 {
        /// Height difference up to which they are beside each other.
        const BESIDE_M: f64 = 1.0;
        let between = self.at - other.at;
        let is_upright = self.rank.is_infinite() || other.rank.is_infinite();
        if is_upright && between.z.abs() < BESIDE_M { between.xy().norm() } else { between.norm() }
    }

    /// Upright, where it is.
    pub fn as_it_is(&self) -> Thing {
        let into = if self.stands { -self.embedding_m } else { self.embedding_m };
        let position = Translation3::new(self.at.x, self.at.y, self.at.z + into);
        self.thing(Isometry3::from_parts(position, about_z(self.yaw_rad)))
    }

    pub fn thing(&self, pose: Isometry3<f64>) -> Thing {
        Thing {
            id: self.id,
            kind: self.row.name.to_owned(),
            prototype: self.prototype.name.clone(),
            scale: self.scale,
            pose,
            embedding_m: self.embedding_m,
        }
    }
}

/// Which candidates are overlapped by none that has a larger rank.
pub(super) fn without_overlaps(candidates: &[Candidate]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|&a, &b| candidates[a].at.x.total_cmp(&candidates[b].at.x));
    let furthest_m = candidates.iter().map(Candidate::reach_m).fold(0.0, f64::max);
    let mut kept = vec![true; candidates.len()];
    for (n, &one) in order.iter().enumerate() {
        let a = &candidates[one];
        let near =
            order[n + 1..].iter().take_while(|&&other| candidates[other].at.x - a.at.x < a.reach_m() + furthest_m);
        for &other in near {
            let b = &candidates[other];
            if a.apart_m(b) < a.reach_m() + b.reach_m() {
                let loser = if (a.rank, a.id) < (b.rank, b.id) { one } else { other };
                kept[loser] = false;
            }
        }
    }
    kept
}

/// Where things are placed.
pub(super) struct Site<'a> {
    pub setting: &'a Setting<'a>,
    /// With the difficulty in the others.
    pub settings: ThingSettings,
    pub corridor: Corridor,
    pub walls: Facets,
}

impl<'a> Site<'a> {
    /// These bounds, with the walls within so many metres of them; `None` if there are to be no things.
    pub fn new<'b>(
        setting: &'a Setting<'a>,
        around: Aabb<f64>,
        walls: impl Iterator<Item = &'b Mesh>,
        beyond_m: f64,
    ) -> Option<Self> {
        let settings = setting.settings.hardened();
        let corridor = Corridor::new(setting.graph, settings.corridor_m, around);
        let is_bare = settings.cover <= 0.0;
        (!is_bare).then(|| Self {
            setting,
            settings,
            corridor,
            walls: Facets::of_walls(walls, around.padded(beyond_m)),
        })
    }

    pub fn rows(&self) -> impl Iterator<Item = KindRow<'a>> + use<'a> {
        self.setting.kinds.rows()
    }

    /// The depth in the rock of each point of each group, in metres.
    pub fn depths(&self, groups: Vec<Vec<[f32; 3]>>) -> Vec<Vec<f32>> {
        let mut depths = self.setting.field.scattered(&groups.concat()).into_iter();
        groups.into_iter().map(|group| depths.by_ref().take(group.len()).collect()).collect()
    }

    /// The place of the candidate of each cell of a grid of this kind.
    pub fn cells(
        &self,
        row: &KindRow,
        side_m: f64,
        around: Aabb<f64>,
    ) -> impl Iterator<Item = (Lots, f64, f64)> + use<> {
        let [low, high] =
            [around.min, around.max].map(|corner| [0, 1].map(|axis| (corner[axis] / side_m).floor() as i32));
        let salt = u64::from(salt(self.setting.seed, row.name));
        let cells = (low[1]..=high[1]).flat_map(move |y| (low[0]..=high[0]).map(move |x| [x, y]));
        cells.map(move |[x, y]| {
            let mut lots = Lots::new(salt, [x, y]);
            let place = [x, y].map(|cell| (f64::from(cell) + lots.unit()) * side_m);
            (lots, place[0], place[1])
        })
    }
}

/// A size in steps, so that few meshes serve a cave.
pub(super) fn quantised(size: f64) -> f64 {
    let steps = (libm::log(size) / libm::log(SIZE_STEP)).round();
    libm::pow(SIZE_STEP, steps)
}
